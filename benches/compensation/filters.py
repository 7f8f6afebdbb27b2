"""Filters over corrected readings in the order of their time: a value at the end of each burst."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from compensation.world import EACH, Column, Truth

Labels = NDArray[np.int64]
Filter = Callable[[Column, Column], Column]
_GATE = 5.0  # standard deviations, beyond which a filter begins anew


def last(distance: Column, seconds: Column) -> Column:
    """Take one reading."""
    return distance[EACH - 1 :: EACH]


def median(distance: Column, seconds: Column) -> Column:
    """Take the median of a burst."""
    return _over(np.nanmedian, distance.reshape(-1, EACH))


def mean(distance: Column, seconds: Column) -> Column:
    """Take the mean of a burst: a moving mean of its length."""
    return _over(np.nanmean, distance.reshape(-1, EACH))


def moving(distance: Column, seconds: Column) -> Column:
    """Take the mean of three bursts."""
    padded = np.concatenate([np.full(2 * EACH, np.nan), distance])
    return _over(np.nanmean, np.lib.stride_tricks.sliding_window_view(padded, 3 * EACH)[::EACH])


def _over(function: Callable[..., Column], rows: Column) -> Column:
    """Of each row; NaN where nothing is known."""
    found = np.full(len(rows), np.nan)
    known = np.isfinite(rows).any(axis=1)
    found[known] = function(rows[known], axis=1)
    return found


@dataclass(frozen=True)
class Kalman:
    """A filter of one state: the distance walks at random. Kalman 1960, doi:10.1115/1.3662552."""

    walk: float  # m2/s, variance that a second adds
    noise: float  # m2, variance of a value
    gate: bool = False  # whether it begins anew at a value that is far off

    def __call__(self, distance: Column, seconds: Column) -> Column:
        """Filter the medians of bursts; NaN where one has no echo."""
        middle = median(distance, seconds)
        return np.where(np.isfinite(middle), self.run(middle, last(seconds, seconds))[0], np.nan)

    def run(self, distance: Column, seconds: Column) -> tuple[Column, float]:
        """Filter readings; return the states and the log likelihood of the readings."""
        state, variance, before = float("nan"), 0.0, float(seconds[0])
        states, likelihood = [], 0.0
        for read, at in zip(distance.tolist(), seconds.tolist(), strict=True):
            variance, before = variance + self.walk * (at - before), at
            if np.isfinite(read):
                expected = variance + self.noise
                if np.isfinite(state) and not (self.gate and (read - state) ** 2 > _GATE**2 * expected):
                    likelihood -= 0.5 * (np.log(expected) + (read - state) ** 2 / expected)
                    gain = variance / expected
                    state, variance = state + gain * (read - state), (1 - gain) * variance
                else:
                    state, variance = read, self.noise
            states.append(state)
        return np.array(states), likelihood

    @classmethod
    def fitted(cls, distance: Column, seconds: Column, placement: Labels | None = None) -> "Kalman":
        """Choose both variances by maximum likelihood; with placements: of a target at rest, with a gate."""
        parts = [slice(None)]
        if placement is not None:
            edges = np.flatnonzero(np.diff(placement)) + 1
            parts = [slice(a, b) for a, b in zip([0, *edges], [*edges, len(placement)], strict=True)]

        def cost(logs: Column) -> float:
            one = cls(*np.exp(logs))
            return -sum(one.run(distance[part], seconds[part])[1] for part in parts)

        start = np.log([1e-10, 1e-6] if placement is not None else [1e-5, 1e-6])
        found = minimize(
            cost, start, method="Nelder-Mead", options={"maxiter": 80, "xatol": 0.05, "fatol": 0.5}
        )
        return cls(*np.exp(found.x), gate=placement is not None)


FILTERS = {
    "last": "one reading",
    "median": "median of a burst of 5",
    "mean": "mean of a burst of 5",
    "moving": "moving mean of three bursts",
    "kalman": "Kalman filter of medians, random walk",
    "gated": "Kalman filter of medians, for a target at rest, begins anew after a move",
}


def made(name: str, training: Callable[[], Column], truth: Truth) -> Filter:
    """Return a filter; that of Kalman is fitted to the corrected readings of the training."""
    plain: dict[str, Filter] = {"last": last, "median": median, "mean": mean, "moving": moving}
    if name in plain:
        return plain[name]
    placement = truth.placement[::EACH] if name == "gated" else None
    return Kalman.fitted(median(training(), truth.seconds), last(truth.seconds, truth.seconds), placement)
