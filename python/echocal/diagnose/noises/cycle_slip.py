"""Cycles of the carrier that the comparator misses."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.noises.trace import Likelihood, Trace

__all__ = ["FACTS", "fit"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]
Orders = tuple[int, ...]

_PERIOD = 25e-6  # s, of 40 kHz (HC-SR04 data sheet)
_MISSED = (0, 1, 2, 3)  # cycles, where zero is known
_EITHER = (-2, -1, 0, 1, 2)  # around the level of a stretch, which may itself have slipped
_KERNELS = (np.inf, 4.0)
_PER_CELL = 60  # rows from which on a distance has probabilities of its own
_CELLS = 8
_TRACE = 5e-3  # part of the rows below which a component costs nothing and says nothing
_FEWEST = 0.01  # rows slipped, or not slipped, for a mixture to be one
_INTACT = 0.1  # rows without a slip
_APART = 0.6  # widths of the kernel that a period must be
_LEVEL = 5e-3  # m, prior of the level of a stretch around what the causes say
_STRETCH = 4  # rows that a stretch has at least on average

FACTS = CauseFacts(
    id="cycle_slip",
    kind="noise",
    sentence="The comparator misses one or more cycles of the echo: the reading jumps by whole periods.",
    signature="readings fall into groups one period of 40 kHz apart: 25 us, 4.3 mm",
    source="arduino.stackexchange 49904: a static target jumps by about 4 mm",
    parameters=(
        Quantity("probability", "1", "part of the rows that missed a cycle"),
        Quantity("period", "s", "distance of the groups in time"),
    ),
    check="draw a histogram of repeated readings; raise the gain, or bring the target nearer",
    prior=0.04,
)


@dataclass(frozen=True)
class _Mixture:
    """Groups one period apart, fitted: log evidence, probabilities by cell and order, kernel's scale."""

    log: float
    weights: Column
    orders: Orders
    scale: float
    cells: Labels

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


def fit(trace: Trace) -> Likelihood | None:
    """Mix groups one period apart, with probabilities for each part of the distances."""
    step = 0.5 * trace.speed * _PERIOD
    cells = _cells(trace.distance)
    one = np.zeros(len(trace), dtype=np.int64)
    fits = []
    if trace.skewed:
        fits += [_mixture(trace, step, cells, freedom, _MISSED, one) for freedom in _KERNELS]
    if _split(trace, step):
        fits += [_mixture(trace, step, one, freedom, _EITHER, trace.stretch) for freedom in _KERNELS]
    least, widest = max(_FEWEST, 3 / len(trace)), _APART * float(np.median(step))
    fits = [f for f in fits if f.distinct > least and f.scale < widest and f.intact > _INTACT]
    if not fits:
        return None
    best = max(fits, key=lambda f: f.log)
    slipped = 1 - best.intact
    told = (
        f"{100 * slipped:.0f} % of the rows read one or more steps of {1e3 * float(np.median(step)):.2f} mm "
        f"(25 us) {_where(best)}; the groups scatter by {1e3 * best.scale:.2f} mm"
    )
    log = float(np.logaddexp.reduce([f.log for f in fits]) - np.log(2 * len(_KERNELS)))
    uncertainty = float(np.sqrt(max(slipped * (1 - slipped), 1e-6) / len(trace)))
    return Likelihood(log, {"probability": (slipped, uncertainty), "period": (_PERIOD, 0.0)}, told)


def _where(found: _Mixture) -> str:
    if found.orders == _EITHER:
        return "off the level of their stretch, to either side"
    near, far = found.weights[0], found.weights[-1]
    if abs(near[0] - far[0]) > 0.1:
        ends = [100 * (1 - float(end[0])) for end in (near, far)]
        return f"too far ({ends[0]:.0f} % of the nearest, {ends[1]:.0f} % of the farthest)"
    return "too far"


def _split(trace: Trace, step: Column) -> bool:
    """Whether stretches of one target are long, sharp, and have rows one period off."""
    count = np.bincount(trace.stretch)
    if len(trace) < _STRETCH * len(count):
        return False
    off = np.abs(trace.left - trace.stretch_median) / step
    return bool(np.median(off) < 0.35 and np.mean(np.abs(off - 1) < 0.35) > 0.02)


def _cells(distance: Column) -> Labels:
    """Parts of the distances with probabilities of their own."""
    values, which, counts = np.unique(distance, return_inverse=True, return_counts=True)
    if len(values) <= 2 * _CELLS and counts.min() >= 20:
        return np.asarray(which.reshape(-1))
    cells = int(np.clip(len(distance) // _PER_CELL, 1, _CELLS))
    edges = np.quantile(distance, np.linspace(0, 1, cells + 1)[1:-1])
    found: Labels = np.unique(np.searchsorted(edges, distance), return_inverse=True)[1].reshape(-1)
    return found


def _mixture(
    trace: Trace, step: Column, cells: Labels, freedom: float, orders: Orders, stretch: Labels
) -> _Mixture:
    """Fit the groups; the level is zero, one, or one per stretch."""
    left = np.ascontiguousarray(trace.left)
    leveled = bool(stretch.any()) or trace.free_mean
    level: Column = (
        trace.stretch_median if stretch.any() else np.full(len(left), np.quantile(left, 0.1) * leveled)
    )
    first = max(0.25 * float(np.median(step)), 1e-4)
    spread = _LEVEL if leveled else 0.0
    log, level, scale, weights = _core.slips(
        left, step, cells, stretch, [float(order) for order in orders], freedom, spread, level, first
    )
    rows, members = np.bincount(cells), np.bincount(stretch)
    used = (weights > _TRACE).sum(axis=1) - 1
    cost = 0.5 * float((used * np.log(rows)).sum()) + 0.5 * np.log(len(left))
    if leveled:  # a level of its own costs what its prior spreads it over
        levels = np.bincount(stretch, level) / members
        cost += 0.5 * float(np.log1p(members * (_LEVEL / scale) ** 2).sum())
        cost += 0.5 * float(np.sum((levels / _LEVEL) ** 2))
    return _Mixture(log - cost, weights, orders, scale, cells)
