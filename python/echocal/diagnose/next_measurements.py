"""What to measure next: where causes that these data cannot separate would differ."""

from collections.abc import Mapping, Sequence
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim
from echocal.diagnose.judge import Judgment
from echocal.diagnose.result import NextMeasurement
from echocal.registry import find_effect

__all__ = ["propose"]

_DISTANCES = (0.3, 1.0, 3.0)  # m: where any sensor of this kind reads
_TEMPERATURES = (5.0, 20.0, 35.0)  # degC: a fridge, a room, a warm box
_ROWS = 10  # rows proposed
_WORTH = 0.75  # probability below which a proposal is not worth the work


def propose(
    case: Case, judgment: Judgment, others: Sequence[Claim], variance: float
) -> tuple[NextMeasurement, ...]:
    """Propose rows, or a side measurement, for every pair that cannot be separated.

    Ten rows, shared by two conditions within the reach of a workshop; the probability is what
    the right cause of the pair would then have, if the found size is right and both started
    equal.
    """
    proposals = []
    for claim in judgment.kept:
        for rival in (*claim.rivals, *(other.cause for other in others)):
            pair = (claim.cause, rival)
            conditions, probability = _best(case, judgment, pair, variance)
            if probability >= _WORTH:
                proposals.append(NextMeasurement(conditions, pair, probability))
            else:
                side = {"side_measurement": _check(rival)}
                proposals.append(NextMeasurement(side, pair, None))
    return tuple(proposals)


def _check(cause: str) -> str:
    return find_effect(cause).check


def _best(
    case: Case, judgment: Judgment, pair: tuple[str, str], variance: float
) -> tuple[dict[str, list[float]], float]:
    distance, temperature = (np.array(x) for x in zip(*product(_DISTANCES, _TEMPERATURES), strict=True))
    found = judgment.model.effects
    signals = [_at(case, cause, found.get(cause, {}), distance, temperature) for cause in pair]
    size = found[pair[0]]
    true = _scaled(signals[0], size, pair[0])
    if true is None or signals[1] is None:
        return {}, 0.0
    best: tuple[dict[str, list[float]], float] = ({}, 0.0)
    for chosen in combinations(range(len(distance)), 2):
        rows = list(chosen)
        mimic = np.array([next(iter(signals[1].values()))[rows]]).T
        rest = true[rows] - mimic @ np.linalg.lstsq(mimic, true[rows], rcond=None)[0]
        odds = 0.25 * _ROWS * float(rest @ rest) / variance
        probability = 1.0 / (1.0 + np.exp(-odds))
        if probability > best[1] + 1e-3:
            where = {
                "distance": distance[rows].tolist(),
                "temperature": temperature[rows].tolist(),
                "rows": [_ROWS // 2] * 2,
            }
            best = (where, float(probability))
    return best


def _at(
    case: Case,
    cause: str,
    found: Mapping[str, float],
    distance: NDArray[np.float64],
    temperature: NDArray[np.float64],
) -> dict[str, NDArray[np.float64]] | None:
    """Tangent of a cause's size under proposed conditions; None where it needs more than these."""
    effect = find_effect(cause)
    sizes = [p.name for p in effect.parameters if p.role == "size"]
    if not set(effect.requires) <= {"temperature"} or len(sizes) != 1:
        return None
    shape = {name: value for name, value in found.items() if name not in sizes}
    model = case.base.model({cause: shape})
    jacobian = model.jacobian(distance, temperature=temperature)
    name = sizes[0]
    return {name: jacobian[:, 1 + model.parameter_names.index(f"{cause}.{name}")]}


def _scaled(
    tangents: dict[str, NDArray[np.float64]] | None, size: dict[str, float], cause: str
) -> NDArray[np.float64] | None:
    if tangents is None:
        return None
    ((name, tangent),) = tangents.items()
    return tangent * size[name]
