"""Cycles of the carrier that the comparator misses."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.facts import CauseFacts, Quantity
from echocal.diagnose.noises.trace import Likelihood, Trace, log_density

__all__ = ["FACTS", "fit"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_PERIOD = 25e-6  # s, of 40 kHz (HC-SR04 data sheet)
_MISSED = 4  # components: no cycle to three
_KERNELS = (np.inf, 4.0)
_ROUNDS = 40
_PER_CELL = 60  # rows from which on a distance has probabilities of its own
_CELLS = 8
_TRACE = 5e-3  # part of the rows below which a component costs nothing and says nothing
_FEWEST = 0.01  # rows slipped, or not slipped, for a mixture to be one
_APART = 0.6  # widths of the kernel that a period must be

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


def fit(trace: Trace) -> Likelihood | None:
    """Mix groups one period apart, with probabilities for each part of the distances."""
    if not trace.skewed:
        return None
    cells = _cells(trace.distance)
    step = 0.5 * trace.speed * _PERIOD
    fits = [_mixture(trace, step, cells, freedom) for freedom in _KERNELS]
    best = max(fits, key=lambda f: f[0])
    cost = []
    for log, weights, _, _ in fits:
        counts = np.bincount(cells)
        used = (weights > _TRACE).sum(axis=1) - 1
        cost.append(log - 0.5 * float((used * np.log(counts)).sum()))
    _, weights, scale, _ = best
    part = np.bincount(cells) / len(cells)
    slipped = float(part @ (1 - weights[:, 0]))
    distinct = float(part @ np.minimum(1 - weights.max(axis=1), 0.5))
    if distinct < _FEWEST or scale > _APART * float(np.median(step)):
        return None
    near, far = weights[0], weights[-1]
    told = (
        f"{100 * slipped:.0f} % of the rows read one or more steps of {1e3 * float(np.median(step)):.2f} mm "
        f"(25 us) too far{_where(near, far)}; the groups scatter by {1e3 * scale:.2f} mm"
    )
    free = 0.5 * np.log(len(trace)) * (2 if trace.free_mean else 1)
    log = float(np.logaddexp.reduce(cost) - np.log(len(cost)) - free)
    uncertainty = float(np.sqrt(max(slipped * (1 - slipped), 1e-6) / len(trace)))
    return Likelihood(log, {"probability": (slipped, uncertainty), "period": (_PERIOD, 0.0)}, told)


def _where(near: Column, far: Column) -> str:
    if len(near) and abs(near[0] - far[0]) > 0.1:
        return f" ({100 * (1 - near[0]):.0f} % of the nearest, {100 * (1 - far[0]):.0f} % of the farthest)"
    return ""


def _cells(distance: Column) -> Labels:
    """Parts of the distances with probabilities of their own."""
    values, which, counts = np.unique(distance, return_inverse=True, return_counts=True)
    if len(values) <= 2 * _CELLS and counts.min() >= 20:
        return np.asarray(which.reshape(-1))
    cells = int(np.clip(len(distance) // _PER_CELL, 1, _CELLS))
    edges = np.quantile(distance, np.linspace(0, 1, cells + 1)[1:-1])
    found: Labels = np.unique(np.searchsorted(edges, distance), return_inverse=True)[1].reshape(-1)
    return found


def _mixture(trace: Trace, step: Column, cells: Labels, freedom: float) -> tuple[float, Column, float, float]:
    """Log likelihood, weights by cell, scale and level, by expectation and maximization."""
    left = trace.left
    shifts = step[:, None] * np.arange(_MISSED)
    level = float(np.quantile(left, 0.1)) if trace.free_mean else 0.0
    scale = max(0.25 * float(np.median(step)), 1e-4)
    count = int(cells.max()) + 1
    weights = np.full((count, _MISSED), 1.0 / _MISSED)
    log = -np.inf
    for _ in range(_ROUNDS):
        away = left[:, None] - level - shifts
        parts = log_density(away, scale, freedom) + np.log(weights[cells] + 1e-12)
        top = parts.max(axis=1, keepdims=True)
        share = np.exp(parts - top)
        total = share.sum(axis=1, keepdims=True)
        share /= total
        found = float((np.log(total) + top).sum())
        if found < log + 1e-3:
            log = found
            break
        log = found
        tail = 1.0 if np.isinf(freedom) else (freedom + 1) / (freedom + (away / scale) ** 2)
        if trace.free_mean:
            level += float((share * tail * away).sum() / (share * tail).sum())
        scale = max(float(np.sqrt((share * tail * away**2).sum() / len(left))), 1e-5)
        for m in range(_MISSED):
            weights[:, m] = np.bincount(cells, share[:, m], count) / np.bincount(cells, minlength=count)
    return log, weights, scale, level
