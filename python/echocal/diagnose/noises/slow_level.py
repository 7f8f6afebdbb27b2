"""A level that moves by itself while its distance is taken for constant."""

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.noises.common.kinds import OffsetNoise, Offsets
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["NOISE"]

_DRIFT = "drift"
"""Id of the effect that moves every distance with time: where it is unknown, nothing tells them apart."""

_HOUR = 3600.0  # s


FACTS = CauseFacts(
    id="slow_level",
    kind="noise",
    sentence="The level itself moves: water, snow, grass, a post that sinks. The distance is not constant.",
    signature="readings move slowly with time, whatever the air does",
    source="argument: a distance that is only assumed to be constant may change",
    parameters=(
        Quantity("movement", "m", "last level less the first", (-10.0, 10.0), "that of drift"),
        Quantity("rate", "m/s", "mean rate of the movement", (-1e-3, 1e-3), "that of drift"),
    ),
    check="measure the distance again, at two times, with a tape",
    prior=0.05,
    formula="distance' = distance + rate s + settling (1 - exp(-s / time constant)), with s the time",
    needs=("elapsed_time",),
)


def find(case: Case, inference: Inference) -> Offsets | None:
    """Take a drift under a constant, unknown distance for a movement of the level."""
    time = case.table.conditions.get("elapsed_time")
    if not case.sums.flat_level or time is None:
        return None
    log = np.array([one.log_posterior for one in inference.fits])
    share = np.exp(log - log.max()) / np.exp(log - log.max()).sum()
    moves = np.array([_DRIFT in one.hypothesis.causes for one in inference.fits])
    probability = float(share @ moves)
    if probability < PROBABLE:
        return None
    best = inference.fits[int(np.where(moves, log, -np.inf).argmax())]
    level = _movement(case, best)
    offsets = level if case.offsets is None else level + case.offsets
    other = examine(case.table, case.base, case.folds, case.seed, case.settings, offsets)
    other.found.variants[:] = [one for one in other.found.variants if one.cause != _DRIFT]
    other.found.skipped[_DRIFT] = "slow_level takes its place: the level itself may have moved"
    span = float(time[-1] - time[0])
    movement = float(level[-1] - level[0])
    because = (
        f"the level moves by {1e3 * movement:.1f} mm in {span / _HOUR:.1f} hours. The distance was only "
        "assumed to be constant: a level that moves and a mount that creeps look the same, so drift is not "
        "named and not corrected"
    )
    rate = movement / span if span > 0 else 0.0
    parameters = (Parameter("movement", movement, 0.0, "m"), Parameter("rate", rate, 0.0, "m/s"))
    prior = case.settings.noises.prior(FACTS)
    odds = np.log(probability) - np.log(max(1 - probability, 1e-13))
    evidence = float(odds - np.log(prior / (1 - prior)))
    finding = Finding(FACTS, evidence, because, parameters, rivals=(_DRIFT,))
    return Offsets(finding, other, infer(other))


def _movement(case: Case, fit: HypothesisFit) -> np.ndarray:
    """What the drift of a hypothesis adds to every reading [m]."""
    (placed,) = [(variant, at) for variant, at in fit.hypothesis.placed if variant.cause == _DRIFT]
    variant, at = placed
    return np.asarray(case.signal(variant, fit.mean[at]))


def draw(table: Columns, random: np.random.Generator) -> None:
    """Look at one level without a known distance, which rises by centimeters."""
    table["reading_m"] += 2.0 - table["distance_m"]
    del table["distance_m"]
    time = table["time_s"] - table["time_s"][0]
    table["reading_m"] -= random.uniform(0.01, 0.03) * time / time[-1]


NOISE = OffsetNoise(facts=FACTS, draw=draw, find=find)
