"""Cycles of the carrier that the comparator misses."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.trace import Likelihood, Trace, group_medians
from echocal.diagnose.preprocess.density import log_density, weight
from echocal.diagnose.preprocess.row_mixture import PERIOD
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["NOISE"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]
Orders = tuple[int, ...]

_MISSED = (0, 1, 2, 3)  # cycles, where zero is known
_EITHER = (-2, -1, 0, 1, 2)  # around the level of a segment, which may itself have slipped
_KERNELS = (np.inf, 4.0)
_PER_CELL = 60  # rows from which on a distance has probabilities of its own
_CELLS = 8
_ROUNDS, _GAIN = 40, 1e-3  # of the EM algorithm, at most, and the log likelihood that a round must add
_LEAST, _FINEST = 1e-12, 1e-5  # probability that a group keeps, and scatter of a group [m]
_TRACE = 5e-3  # part of the rows below which a component costs nothing and says nothing


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this noise."""

    fewest: float = threshold(
        0.01, "1", "part of the rows outside of the largest group, for a mixture to be one; judgement"
    )
    intact: float = threshold(
        0.1, "1", "part of the rows without a slip: if all slipped, that is a delay; judgement"
    )
    apart: float = threshold(
        0.6, "1", "scatter of a group in periods, beyond which groups run together; judgement"
    )
    level: float = threshold(
        5e-3, "m", "standard deviation of a segment's level around what the effects say; judgement"
    )
    segment: float = threshold(4, "1", "rows of a segment on average, for segments to have levels; judgement")
    sharp: float = threshold(
        0.35, "1", "deviation from a segment's median in periods, of a row that belongs to a group; judgement"
    )
    known: float = threshold(
        0.3,
        "1",
        "scatter of a group in periods, up to which the missed cycles of each row are subtracted; judgement: "
        "beyond it a row in ten may belong to the next group",
    )
    split: float = threshold(
        0.02, "1", "part of the rows one period off, from which on segments are tried; judgement"
    )


FACTS = CauseFacts(
    id="cycle_slip",
    kind="noise",
    sentence="The comparator misses one or more cycles of the echo: the reading jumps by whole periods.",
    signature="readings fall into groups one period of 40 kHz apart: 25 us, 4.3 mm",
    source="arduino.stackexchange 49904: a static target jumps by about 4 mm",
    parameters=(
        Quantity(
            "probability",
            "1",
            "part of the rows that missed a cycle",
            (0.0, 1.0),
            "one for each order and part of the distances; costs half a log of its rows",
        ),
        Quantity("period", "s", "distance of the groups in time", (PERIOD, PERIOD), "fixed: 40 kHz"),
    ),
    check="draw a histogram of repeated readings; raise the gain, or bring the target nearer",
    prior=0.04,
    formula="e = k c period / 2 + noise; k = 1 to 3 with the probability, or -2 to 2 around a segment",
)


@dataclass(frozen=True)
class _Mixture:
    """Groups one period apart, fitted.

    With their log evidence, probabilities by cell and order, kernel, and level of each row.
    """

    log: float
    weights: Column
    orders: Orders
    scale: float
    cells: Labels
    freedom: float
    level: Column

    @property
    def by_order(self) -> Column:
        """Probability of each order over all rows."""
        return np.asarray(np.bincount(self.cells) / len(self.cells) @ self.weights)

    @property
    def intact(self) -> float:
        """Rows that missed no cycle: if all did, that is a delay."""
        return float(self.by_order[self.orders.index(0)])

    @property
    def distinct(self) -> float:
        """Rows that are not in the largest group of their cell."""
        part = np.bincount(self.cells) / len(self.cells)
        return float(part @ (1 - self.weights.max(axis=1)))


def fit(trace: Trace, settings: NoiseSettings) -> Likelihood | None:
    """Mix groups one period apart, with probabilities for each part of the distances."""
    step = 0.5 * trace.speed * PERIOD
    fits = _mixtures(trace, step, settings)
    if not fits:
        return None
    best = max(fits, key=lambda f: f.log)
    slipped = 1 - best.intact
    because = (
        f"{100 * slipped:.0f} % of the rows read one or more steps of {1e3 * float(np.median(step)):.2f} mm "
        f"(25 us) {_where(best)}; the groups scatter by {1e3 * best.scale:.2f} mm"
    )
    log = float(np.logaddexp.reduce([f.log for f in fits]) - np.log(2 * len(_KERNELS)))
    uncertainty = float(np.sqrt(max(slipped * (1 - slipped), 1e-6) / len(trace)))
    return Likelihood(log, {"probability": (slipped, uncertainty), "period": (PERIOD, 0.0)}, because)


def missed(trace: Trace, settings: NoiseSettings) -> Column | None:
    """Expected error of each row from its missed cycles [m]: docs/method/noises.md, Eq. 18c.

    None if the groups are so wide that a row's cycles are not known.
    """
    own, step = settings.of(FACTS, Thresholds), 0.5 * trace.speed * PERIOD
    fits = _mixtures(trace, step, settings)
    if not fits:
        return None
    best = max(fits, key=lambda f: f.log)
    if best.scale > own.known * float(np.median(step)):
        return None
    orders = np.array(best.orders, dtype=np.float64)
    beside = (trace.left - best.level)[:, None] - step[:, None] * orders
    with np.errstate(divide="ignore"):
        log = np.log(best.weights)[best.cells] + log_density(beside, best.scale, best.freedom)
    part = np.exp(log - log.max(axis=1, keepdims=True))
    return np.asarray(step * (part @ orders) / part.sum(axis=1))


def _mixtures(trace: Trace, step: Column, settings: NoiseSettings) -> list[_Mixture]:
    """Mixtures of groups that the residuals are like, if any."""
    own = settings.of(FACTS, Thresholds)
    cells = _cells(group_medians(trace.distance, trace.segment)[trace.segment])  # no row's own noise sorts it
    one = np.zeros(len(trace), dtype=np.int64)
    fits = []
    if trace.skewed(settings.worth):
        fits += [_mixture(trace, step, _Groups(cells, _MISSED, one), freedom, own) for freedom in _KERNELS]
    if _split(trace, step, own):
        fits += [
            _mixture(trace, step, _Groups(one, _EITHER, trace.segment), freedom, own) for freedom in _KERNELS
        ]
    least, widest = max(own.fewest, 3 / len(trace)), own.apart * float(np.median(step))
    return [f for f in fits if f.distinct > least and f.scale < widest and f.intact > own.intact]


def _where(found: _Mixture) -> str:
    if found.orders == _EITHER:
        return "off the level of their segment, to either side"
    near, far = found.weights[0], found.weights[-1]
    if abs(near[0] - far[0]) > 0.1:
        ends = [100 * (1 - float(end[0])) for end in (near, far)]
        return f"too far ({ends[0]:.0f} % of the nearest, {ends[1]:.0f} % of the farthest)"
    return "too far"


def _split(trace: Trace, step: Column, own: Thresholds) -> bool:
    """Whether segments of one target are long, sharp, and have rows one period off."""
    count = np.bincount(trace.segment)
    if len(trace) < own.segment * len(count):
        return False
    off = np.abs(trace.left - trace.segment_median) / step
    one_off = np.abs(off - 1) < own.sharp
    return bool(np.median(off) < own.sharp and np.mean(one_off) > own.split)


def _cells(distance: Column) -> Labels:
    """Parts of the distances with probabilities of their own."""
    values, which, counts = np.unique(distance, return_inverse=True, return_counts=True)
    if len(values) <= 2 * _CELLS and counts.min() >= 20:
        return np.asarray(which.reshape(-1))
    cells = int(np.clip(len(distance) // _PER_CELL, 1, _CELLS))
    edges = np.quantile(distance, np.linspace(0, 1, cells + 1)[1:-1])
    found: Labels = np.unique(np.searchsorted(edges, distance), return_inverse=True)[1].reshape(-1)
    return found


@dataclass(frozen=True)
class _Groups:
    """Groups to fit: parts of the distances, missed cycles, and segments with levels of their own."""

    cells: Labels
    orders: Orders
    segment: Labels


def _mixture(trace: Trace, step: Column, groups: _Groups, freedom: float, own: Thresholds) -> _Mixture:
    """Fit the groups; the level is zero, one, or one per segment."""
    cells, orders, segment = groups.cells, groups.orders, groups.segment
    left = np.ascontiguousarray(trace.left)
    leveled = bool(segment.any()) or trace.free_mean
    level: Column = (
        trace.segment_median if segment.any() else np.full(len(left), np.quantile(left, 0.1) * leveled)
    )
    first = max(0.25 * float(np.median(step)), 1e-4)
    spread = own.level if leveled else 0.0
    log, weights, scale, level = _fitted(left, step, groups, freedom, (level, first, spread))
    rows, members = np.bincount(cells), np.bincount(segment)
    used = (weights > _TRACE).sum(axis=1) - 1
    cost = 0.5 * float((used * np.log(rows)).sum()) + 0.5 * np.log(len(left))
    if leveled:  # a level of its own costs what its prior spreads it over
        levels = np.bincount(segment, level) / members
        cost += 0.5 * float(np.log1p(members * (own.level / scale) ** 2).sum())
        cost += 0.5 * float(np.sum((levels / own.level) ** 2))
    return _Mixture(log - cost, weights, orders, scale, cells, freedom, level)


def _fitted(
    left: Column, step: Column, groups: _Groups, freedom: float, start: tuple[Column, float, float]
) -> tuple[float, Column, float, Column]:
    """Log likelihood, probabilities by cell and order, scale, and level of each row [m], by EM.

    From a level and a scale on; the last number of `start` is the prior standard deviation of a level, zero
    where the levels are known.
    """
    (level, scale, spread), cells, segment = start, groups.cells, groups.segment
    away, rows = left - step * np.array(groups.orders)[:, None], np.bincount(cells)
    weights, log = np.full((len(rows), len(away)), 1.0 / len(away)), -np.inf
    for _ in range(_ROUNDS):
        off = away - level
        part = log_density(off, scale, freedom) + np.log(weights + _LEAST).T[:, cells]
        top = part.max(axis=0)
        share = np.exp(part - top)
        total = share.sum(axis=0)
        before, log = log, float((np.log(total) + top).sum())
        if log < before + _GAIN:
            break
        share /= total
        pull = share * weight(off, scale, freedom)
        if spread > 0.0:
            toward, mass = (np.bincount(segment, each.sum(axis=0)) for each in (pull * away, pull))
            level = (toward / (mass + (scale / spread) ** 2))[segment]
        scale = max(float(np.sqrt((pull * off**2).sum() / len(left))), _FINEST)
        weights = np.stack([np.bincount(cells, each) / rows for each in share], axis=1)
    return log, weights, scale, level


def draw(table: Columns, random: np.random.Generator) -> None:
    """Miss one cycle more often the farther the target is."""
    missed = random.random(len(table["reading_m"])) < 0.15 + 0.1 * table["distance_m"]
    table["reading_m"] += missed * 0.5 * (331.4 + 0.6 * table["temperature_C"]) * PERIOD


NOISE = FittedNoise(
    facts=FACTS,
    draw=draw,
    fit=fit,
    offsets=missed,
    in_steps=("amplitude_walk",),
    thresholds=Thresholds(),
)
