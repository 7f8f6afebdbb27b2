"""Cycles of the carrier that are missed in every row of a placement."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.noises.common.kinds import OffsetNoise, Offsets
from echocal.diagnose.noises.common.lattice import (
    ORDERS,
    Placements,
    log_lattice,
    log_prior,
    log_prior_along,
    propose,
)
from echocal.diagnose.noises.common.placements import as_one_segment, labelings, some_of_each, whole_steps
from echocal.diagnose.noises.common.trace import group_medians
from echocal.diagnose.noises.common.without import log_evidence, without
from echocal.diagnose.preprocess.row_mixture import PERIOD
from echocal.diagnose.settings.threshold import threshold

__all__ = ["NOISE"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


_TRIED = 2  # proposals for the integers whose evidence is computed, at a time
_EACH = 64  # rows of a placement from which its level is computed
_LONGEST = 20_000  # rows of a table that is divided into stretches: a longer one takes too much time


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this noise."""

    fewest: int = threshold(8, "1", "placements from which on integers are tried; judgement")
    rows: float = threshold(
        3.0, "1", "rows of a placement on average, for placements to have levels; judgement"
    )
    range: float = threshold(
        0.6, "1", "range of the placements' errors in periods below which none is off by one; argument"
    )
    intact: float = threshold(
        0.1, "1", "part of the placements without an offset: if all have one, that is a delay; judgement"
    )
    sets: int = threshold(3, "1", "most probable sets of effects beside which integers are tried; judgement")
    window: int = threshold(9, "1", "rows of the running median that divides a placement; judgement")
    whole_steps: int = threshold(
        4, "1", "steps of an unknown level from which on they may be whole periods; judgement"
    )
    alike: float = threshold(
        0.6, "1", "mean resultant length of their phases from which on they are tried as such; judgement"
    )


FACTS = CauseFacts(
    id="cycle_offset",
    kind="noise",
    sentence="All rows of a placement, a burst or a stretch of time miss the same number of cycles.",
    signature="errors of placements lie on a lattice of one period of 40 kHz: 25 us, 4.3 mm",
    source="CATALOGUE, cycle_slip",
    parameters=(
        Quantity("share", "1", "part of the placements that are off", (0.0, 1.0), "k periods: weight 1/2^k"),
        Quantity(
            "period", "s", "distance of the levels in time", (15e-6, 35e-6), "fixed in the search: 40 kHz"
        ),
        Quantity("placements", "1", "placements, bursts or stretches with one level", (1.0, None), "counted"),
    ),
    check="place the target again at one distance: the error changes by 0 or 4.3 mm, by nothing between; "
    "raise the gain",
    prior=0.04,
    formula="e_i = k_j c period / 2 in every row i of placement j, k_j a whole number",
)


@dataclass(frozen=True, eq=False)
class _Tried:
    """Integers of placements, and the hypotheses beside them.

    Attributes
    ----------
    labels : ndarray of int, shape (n,)
        Placement of each row.
    orders : ndarray of int, shape (k,)
        Missed cycles of each placement.
    log : float
        Log evidence, the prior of the integers included, less that without integers.
    """

    labels: Labels
    orders: Labels
    log: float
    case: Case
    inference: Inference


def find(case: Case, inference: Inference) -> Offsets | None:
    """Compare the hypotheses with the same hypotheses beside whole periods of each placement.

    docs/method/noises.md, Eq. 18a.
    """
    settings = case.settings.noises
    own = settings.of(FACTS, Thresholds)
    step = _step(case)
    if case.sums.flat_level and whole_steps(case.table, step, own.whole_steps, own.alike):
        case = examine(as_one_segment(case.table), case.base, case.folds, case.seed, case.settings)
        inference = infer(case)
    none = log_evidence(inference)
    best: _Tried | None = None
    beside = case, inference
    for _ in range(2):  # once more beside the causes that are probable then
        for labels, orders, places in _proposals(case.residual, *beside, step, own):
            if best is not None and np.array_equal(orders[labels], best.orders[best.labels]):
                continue
            found = without(case, orders[labels] * step)
            log = log_evidence(found[1]) - none + places + _log_prior(case, labels, orders)
            if best is None or log > best.log:
                best = _Tried(labels, orders, log, *found)
        if best is None or best.log < -np.log(settings.prior(FACTS)):
            return None
        beside = best.case, best.inference
    assert best is not None
    return _judged(best, step, settings.prior(FACTS))


def _step(case: Case) -> Column:
    """Length of one period in each row [m]."""
    two = case.base.indication(np.full(len(case.table), 2.0), case.table.conditions)
    return np.asarray(0.5 * two * PERIOD)


def _log_prior(case: Case, labels: Labels, orders: Labels) -> float:
    """Log probability of the integers: by chance, or in steps along a recorded column or in time."""
    count = np.bincount(labels)
    columns = [np.arange(len(labels), dtype=np.float64), *case.table.known.values()]
    steps = [log_prior_along(orders, np.bincount(labels, column) / count) for column in columns]
    return float(np.logaddexp(log_prior(orders), np.logaddexp.reduce(steps) - np.log(len(steps))) - np.log(2))


def _proposals(
    residual: Column, case: Case, beside: Inference, step: Column, own: Thresholds
) -> Iterator[tuple[Labels, Labels, float]]:
    """Placements and integers whose evidence is worth computing, and the log prior of their places."""
    fits: dict[tuple[str, ...], HypothesisFit] = {}
    for fit in sorted(beside.fits, key=lambda one: -one.log_posterior):
        if len(fits) < own.sets or not fit.hypothesis.variants:
            fits.setdefault(fit.hypothesis.ids, fit)
    lefts = []
    if len(residual) <= _LONGEST:  # a longer table is not divided into stretches
        left = case.left(beside.fits[0], np.arange(len(residual)))
        lefts = [residual - case.residual + left, residual]
    for labels, places, levels in labelings(case.table, lefts, step, own.window):
        count = int(labels.max()) + 1
        if count < own.fewest or len(case.table.rows) < own.rows * count:
            continue
        found = _beside(residual, case, fits.values(), labels, step, own)[:_TRIED]
        if levels is not None:
            found = found[:1] or [np.clip(levels, ORDERS[0], ORDERS[-1])]
        for orders in found:
            if np.mean(orders == 0) >= own.intact and orders.any():
                yield labels, orders, places


def _beside(
    residual: Column,
    case: Case,
    fits: Iterable[HypothesisFit],
    labels: Labels,
    step: Column,
    own: Thresholds,
) -> list[Labels]:
    """Integers of placements that are likelier than none beside one of some hypotheses, likeliest first."""
    rows = some_of_each(labels, _EACH)
    proposals: dict[bytes, tuple[float, Labels]] = {}
    for fit in fits:
        placements, mean = _placements(residual, case, fit, labels, step, rows)
        if np.ptp(placements.error) < own.range * float(np.median(step)):
            continue
        for log, orders in propose(placements, mean, case.seed):
            if log > 0 and np.mean(orders == 0) >= own.intact:
                proposals.setdefault(orders.tobytes(), (log, orders))
    return [orders for _, orders in sorted(proposals.values(), key=lambda one: -one[0])]


def _placements(
    residual: Column, case: Case, fit: HypothesisFit, labels: Labels, step: Column, rows: Labels
) -> tuple[Placements, Column]:
    """Levels of placements from some rows, with what a hypothesis would add to them, and its sizes."""
    labels, step, residual = labels[rows], step[rows], residual[rows]
    count = np.bincount(labels)
    variants = fit.hypothesis.variants
    fixed = [v.offset for v in variants if v.offset is not None]
    free = [column for v in variants for column in v.free]
    if fixed:
        residual = residual - case.found.columns.at(fixed, rows).sum(axis=0)
    columns = case.found.columns.at(free, rows) if free else np.empty((0, len(labels)))
    means = [np.bincount(labels, column) / count for column in columns]
    first = np.zeros(len(count), dtype=np.int64)
    first[labels] = case.table.groups[rows]
    placements = Placements(
        error=group_medians(residual, labels),
        columns=np.array(means).reshape(len(free), len(count)),
        period=np.bincount(labels, step) / count,
        station=np.unique(first, return_inverse=True)[1].reshape(-1),
    )
    return placements, np.asarray(fit.mean, dtype=np.float64)


def _judged(best: _Tried, step: Column, prior: float) -> Offsets:
    """Weigh the lattice against normal errors, jumps of any size, and slips of single rows."""
    rows = np.arange(len(best.labels))
    left = best.case.left(best.inference.fits[0], rows)
    period = np.bincount(best.labels, step) / np.bincount(best.labels)
    off = _off_the_lattice(best, left, period)
    any_size = log_lattice(off, best.orders, len(best.inference.fits[0].mean))
    single = _log_whole(best, left, step)
    against = np.logaddexp.reduce(
        [
            np.log1p(-prior) - np.log(prior) - best.log,
            *(-log for log in (*any_size, single)),  # rivals that are as probable before the data
        ]
    )
    log_bayes = -float(against) - float(np.log(prior / (1 - prior)))
    scatter = float(np.std(off.error + best.orders * period)), float(np.std(off.error))
    finding = Finding(FACTS, log_bayes, _because(best, period, scatter), _parameters(best, off))
    return Offsets(finding, best.case, best.inference)


def _off_the_lattice(best: _Tried, left: Column, period: Column) -> Placements:
    """What is left of each placement beside its integer; a station's own error counts up to whole periods."""
    off, station = group_medians(left, best.labels), np.zeros(len(best.orders), dtype=np.int64)
    station[best.labels] = best.case.table.groups
    station = np.unique(station, return_inverse=True)[1].reshape(-1)
    mean = np.bincount(station, off) / np.bincount(station)
    off = off - period * np.round(mean[station] / period)
    return Placements(off, np.empty((0, len(off))), period, station)


def _log_whole(best: _Tried, left: Column, step: Column) -> float:
    """Log Bayes factor of cycles missed by placements against cycles missed by single rows."""
    beside = np.clip(np.round(left / step), ORDERS[0], ORDERS[-1]).astype(np.int64)
    every = np.clip(best.orders[best.labels] + beside, ORDERS[0], ORDERS[-1])
    by_station = sum(log_prior(every[best.case.table.groups == s]) for s in np.unique(best.case.table.groups))
    return log_prior(best.orders) + log_prior(beside) - max(log_prior(every), by_station)


def _parameters(best: _Tried, off: Placements) -> tuple[Parameter, ...]:
    orders, count = best.orders, len(best.orders)
    share = float(np.mean(orders != 0))
    relative = off.error / off.period
    members = np.bincount(off.station)
    spread = orders - (np.bincount(off.station, orders) / members)[off.station]  # stations may have errors
    if not spread.any():
        spread = orders - orders.mean()
    else:
        relative = relative - (np.bincount(off.station, relative) / members)[off.station]
    square = float((spread**2).sum())
    slope = float(spread @ relative) / square
    freedom = max(count - len(members) - 1, 1)
    deviation = float(np.sqrt((relative**2).sum() / freedom / square))
    return (
        Parameter("share", share, float(np.sqrt(share * (1 - share) / count)), "1"),
        Parameter("period", PERIOD * (1 + slope), PERIOD * deviation, "s"),
        Parameter("placements", float(count), 0.0, "1"),
    )


def _because(best: _Tried, period: Column, scatter: tuple[float, float]) -> str:
    """Say where the integers are, so that a user finds them in the table."""
    orders, table = best.orders, best.case.table
    firsts = np.zeros(len(orders), dtype=np.int64)
    firsts[best.labels[::-1]] = np.arange(len(best.labels))[::-1]
    moved = np.flatnonzero(orders)
    shown = ", ".join(
        f"{int(orders[k]):+d} from row {int(table.row[firsts[k]]) + 1}"
        + ("" if table.reference is None else f" ({table.reference[firsts[k]]:.3g} m)")
        for k in moved[:6]
    )
    more = ", ..." if len(moved) > 6 else ""
    return (
        f"{len(moved)} of {len(orders)} placements are whole periods of {1e3 * float(np.median(period)):.2f} "
        f"mm (25 us) off: {shown}{more}. Their medians scatter by {1e3 * scatter[0]:.2f} mm, and by "
        f"{1e3 * scatter[1]:.2f} mm without the periods. An offset or a delay is known up to whole periods"
    )


def draw(table: Columns, random: np.random.Generator) -> None:
    """Put the target 24 times at six distances; in a part of the placements one or two cycles are missed."""
    rows = len(table["reading_m"])
    placement = np.arange(rows) * 24 // rows
    error = table["reading_m"] - table["distance_m"]
    table["distance_m"] = np.tile(np.sort(random.uniform(0.3, 3.8, 6)).round(3), 4)[placement]
    missed = random.choice([0, 1, 2], size=24, p=[0.6, 0.3, 0.1])[placement]
    speed = 331.4 + 0.6 * table["temperature_C"]
    table["reading_m"] = table["distance_m"] + error + 0.5 * missed * speed * PERIOD


NOISE = OffsetNoise(facts=FACTS, draw=draw, find=find, thresholds=Thresholds())
