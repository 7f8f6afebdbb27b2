"""The noise of a sensor: learned once from its first rows, then used to whiten each row."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.signal import lfilter
from scipy.stats import chi2

from echocal.arrays import Column
from echocal.observations.quantiles import MAD_TO_SD
from echocal.watch.settings import WatchSettings

_ROUNDS = 4  # of clipping outliers and fitting again
_GROWTHS = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 1e3)
_BLOCKS = (8, 16, 32, 64, 128)  # rows


@dataclass(frozen=True)
class Learned:
    """What the first rows tell."""

    # rho, theta: autocorrelation and white part of the most probable noise (docs/method.md, Eq. 3).
    rho: float
    theta: float
    scale: float  # standard deviation of the whitened noise [m]
    mean: Column  # sizes of the columns before any change; shape (p,)
    covariance: Column  # their covariance over the square of the scale; shape (p, p)
    cleaned: Column  # what the sizes leave of the residual, without outliers [m]; shape (n,)


class Noises:
    """All noises that are tried, with their sums of squares: the posterior grows sharper with each row."""

    def __init__(self, settings: WatchSettings) -> None:
        tried = _tried(settings)
        self.rho = np.array([rho for rho, _ in tried])
        self.theta = np.array([theta for _, theta in tried])
        part = (1.0 - settings.white) / (len(tried) - 1)
        self.prior = np.log(np.where(np.arange(len(tried)) == 0, settings.white, part))
        self.past = np.zeros(len(tried))
        self.squares = np.full(len(tried), 1e-18)
        self.rows = 0

    def add(self, value: float, *, begins: bool) -> None:
        """Take in what the usual sizes leave of one row, without outliers [m]."""
        if begins:
            first = (1.0 - self.rho**2) / (1.0 - 2.0 * self.rho * self.theta + self.theta**2)
            self.squares += first * value * value
            self.past[:] = value
        else:
            innovation = value + (self.theta - self.rho) * self.past
            self.squares += innovation * innovation
            self.past *= self.theta
            self.past += value
        self.rows += 1

    def posterior(self) -> Column:
        """Probability of each, with the scale of each integrated out."""
        log = self.prior - 0.5 * self.rows * np.log(self.squares)
        weights = np.exp(log - log.max())
        return np.asarray(weights / weights.sum())

    def slow(self) -> Column:
        """Standard deviation of slow sums by each [m]."""
        scale = np.sqrt(self.squares / max(self.rows, 1))
        return np.asarray(scale * (1.0 - self.theta) / (1.0 - self.rho))


def _tried(settings: WatchSettings) -> list[tuple[float, float]]:
    return [(0.0, 0.0)] + [
        (rho, theta) for rho in settings.autocorrelations for theta in settings.moving if theta < rho
    ]


def whitened(values: Column, rho: float, theta: float, starts: NDArray[np.intp]) -> Column:
    """Innovations of a column or of columns, shape (n, ...); `starts` are first rows of series."""
    pieces = np.split(values, starts[1:])
    first = np.sqrt((1.0 - rho**2) / (1.0 - 2.0 * rho * theta + theta**2))
    found = [lfilter([1.0, -rho], [1.0, -theta], piece, axis=0) for piece in pieces]
    for piece in found:
        piece[0] *= first
    return np.concatenate(found)


def learn(
    residual: Column, columns: Column, prior: Column, starts: NDArray[np.intp], settings: WatchSettings
) -> Learned:
    """Fit the sizes and the noise before a change.

    `residual`, shape (n,), is the corrected less the reference distance [m]; `columns`, shape (n, p), are
    signatures in prior standard deviations [m]; `prior` is the precision of the sizes before anything is
    known; `starts` are the first rows of series.
    """
    noises = _tried(settings)
    cleaned = _without_outliers(residual, columns, prior, starts, settings)
    fits = [_fit(cleaned, columns, prior, starts, rho, theta) for rho, theta in noises]
    log = np.array([fit[0] for fit in fits])
    part = (1.0 - settings.white) / (len(noises) - 1)
    log += np.log(np.where(np.arange(len(noises)) == 0, settings.white, part))
    best = int(np.argmax(log))
    _, scale, mean, covariance = fits[best]
    return Learned(*noises[best], float(scale), mean, covariance, cleaned - columns @ mean)


def _fit(
    residual: Column, columns: Column, prior: Column, starts: NDArray[np.intp], rho: float, theta: float
) -> tuple[float, float, Column, Column]:
    """Log evidence, scale, sizes and their covariance over scale^2, of one noise."""
    y = whitened(residual, rho, theta, starts)
    x = whitened(columns, rho, theta, starts)
    n = len(y)
    square = float(np.mean((y - y.mean()) ** 2)) + 1e-18
    moments, along = x.T @ x, x.T @ y
    for _ in range(3):  # the prior of the sizes is in their own units, not in those of the noise
        precision = moments + np.diag(prior * square)
        factor = cho_factor(precision)
        mean = cho_solve(factor, along)
        rest = float(y @ y - along @ mean)
        square = max(rest / n, 1e-18)
    determinant = 2.0 * float(np.log(np.diag(factor[0])).sum()) - float(np.log(prior * square).sum())
    first = 0.5 * len(starts) * np.log((1.0 - rho**2) / (1.0 - 2.0 * rho * theta + theta**2))
    evidence = -0.5 * n * np.log(square) - 0.5 * determinant + float(first)
    return evidence, np.sqrt(square), mean, cho_solve(factor, np.eye(len(prior)))


def _without_outliers(
    residual: Column, columns: Column, prior: Column, starts: NDArray[np.intp], settings: WatchSettings
) -> Column:
    """The residual with outliers drawn to the neighborhood: a fit of slow noise would follow them."""
    cleaned = residual
    for _ in range(_ROUNDS):
        _, _, mean, _ = _fit(cleaned, columns, prior, starts, 0.0, 0.0)
        left = residual - columns @ mean
        ends = [*starts[1:].tolist(), len(left)]
        level = np.concatenate(
            [_running_median(left[a:b]) for a, b in zip(starts.tolist(), ends, strict=True)]
        )
        away = left - level
        spread = MAD_TO_SD * float(np.median(np.abs(away))) + 1e-12
        limit = (settings.clip + 1.0) * spread
        cleaned = residual - away + np.clip(away, -limit, limit)
    return cleaned


def _running_median(values: Column) -> Column:
    if len(values) < 5:
        return np.full(len(values), float(np.median(values)))
    padded = np.pad(values, 2, mode="reflect")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, 5), axis=1))


def weights(distance: Column | float, growth: tuple[float, float]) -> Any:
    """Usual noise over that at a distance [m]; `growth` is its slope at the distance beside it."""
    slope, usual = growth
    return np.sqrt((1.0 + slope**2) / (1.0 + (slope * np.asarray(distance) / usual) ** 2))


def growth(cleaned: Column, distance: Column) -> tuple[float, float]:
    """How noise grows with the distance: the most probable slope, if the rows show one (BIC)."""
    usual = float(np.median(np.abs(distance))) or 1.0
    tried = [weights(distance, (slope, usual)) for slope in _GROWTHS]
    log = [float(np.log(w).sum() - 0.5 * len(w) * np.log(np.mean((w * cleaned) ** 2) + 1e-18)) for w in tried]
    best = int(np.argmax(log))
    return (_GROWTHS[best] if log[best] - log[0] > 0.5 * np.log(len(cleaned)) else 0.0), usual


def unlike(scores: Column, columns: Column, probability: float) -> str:
    """Why whitened rows are not those of steady noise of the model class; nothing if they may be.

    Sums over blocks of independent scores have the variance of the sum of their squares. The scores are
    standardized and clipped, the columns whitened signatures; `probability` is that of refusing steady
    noise.
    """
    squares = scores * scores
    tried = np.column_stack([columns * scores[:, None], squares - squares.mean()])
    level = 1.0 - probability / (len(_BLOCKS) * tried.shape[1])
    over = np.zeros(tried.shape[1], dtype=bool)
    for rows in _BLOCKS:
        blocks = len(scores) // rows
        if blocks >= 3:
            own = tried[: blocks * rows].reshape(blocks, rows, -1)
            ratio = (own.sum(axis=1) ** 2).sum(axis=0) / ((own * own).sum(axis=(0, 1)) + 1e-300)
            over |= ratio * blocks > chi2.ppf(level, blocks)
    if over[:-1].any():
        return "errors that belong to a cause come and go"
    return "the noise is greater at some times than at others" if over[-1] else ""


def coarse(reading: Column, distance: Column, cleaned: Column) -> str:
    """Why rounded readings leave an error that rows do not average out; nothing if they do not.

    From a noise of 0.5 steps on (0.58 with the rounding), and at ever new distances, rounding is white noise.
    """
    if not np.isfinite(reading).all() or 10 * len(np.unique(distance)) > len(distance):
        return ""
    steps = np.diff(np.unique(reading))
    scale = abs(float(np.median(distance)) / (float(np.median(reading)) or np.nan))
    step = float(steps.min(initial=np.inf)) * scale
    if not np.isfinite(step) or np.std(cleaned) > step / np.sqrt(3.0):
        return ""
    return f"readings are whole steps of {1e3 * step:.3g} mm, more than their noise, at few distances"
