"""How probable rows are under each kind of noise that a simulator draws."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular, toeplitz
from scipy.special import gammaln, logsumexp

from hidden_effects.designs import Rows
from hidden_effects.disturbance import SHOT
from hidden_effects.menu import NULLS

Column = NDArray[np.float64]
Matrix = NDArray[np.float64]

_HEAVY, _SINGLE_TAPE, _NULL_TAPE = 0.3, 0.5e-3, 1e-3  # as `menu.draw` has them
_TAPED = 0.3
_OFFSETS = np.linspace(-3.0, 3.0, 13)  # standard deviations of a stand's error
_MOST_TAPED = 60  # sizes, the best ones, for which a heavy tail beside the tape is reckoned
_SCALES = np.geomspace(0.7, 1.4, 5)  # of any noise, where nobody knows how large it is
_ANY_TAPE = np.array([0.1, 0.2, 0.4, 0.8, 1.6, 3.2]) * 1e-3  # m
_LOG2PI = np.log(2 * np.pi)


def normal(left: Matrix) -> Column:
    """White noise; `left` has shape (rows, candidates)."""
    return np.asarray(-0.5 * (left**2).sum(0) / SHOT**2 - len(left) * (np.log(SHOT) + 0.5 * _LOG2PI))


def heavy(left: Matrix) -> Column:
    """Student t with four degrees of freedom."""
    return np.asarray(_heavy_rows(left).sum(0))


def _heavy_rows(left: Matrix) -> Matrix:
    scale = SHOT / np.sqrt(2.0)
    constant = gammaln(2.5) - gammaln(2.0) - 0.5 * np.log(4 * np.pi) - np.log(scale)
    return np.asarray(constant - 2.5 * np.log1p((left / scale) ** 2 / 4))


def taped(rows: Rows, left: Matrix, size: float) -> Column:
    """White noise, and an error that all rows of a stand share."""
    log = normal(left)
    for stand in np.unique(rows.stand):
        n = int((rows.stand == stand).sum())
        ratio = n * size**2 / SHOT**2
        total = left[rows.stand == stand].sum(0)
        log = log + 0.5 * size**2 * total**2 / SHOT**4 / (1 + ratio) - 0.5 * np.log1p(ratio)
    return np.asarray(log)


def heavy_taped(rows: Rows, left: Matrix, size: float) -> Column:
    """Heavy tails, and an error that all rows of a stand share: a sum over that error."""
    weight = -0.5 * _OFFSETS**2
    weight -= logsumexp(weight)
    log = np.zeros(left.shape[1])
    for stand in np.unique(rows.stand):
        mine = left[rows.stand == stand]
        log += logsumexp([w + heavy(mine - size * a) for w, a in zip(weight, _OFFSETS, strict=True)], axis=0)
    return log


def single_noise(rows: Rows, left: Matrix, *, tape: bool = True) -> Column:
    """Of the noises that single causes are drawn with; shape (candidates,)."""
    free = np.logaddexp(np.log(1 - _HEAVY) + normal(left), np.log(_HEAVY) + heavy(left))
    if rows.design != "b" or not tape:
        return np.asarray(free)
    with_tape = np.log(1 - _HEAVY) + taped(rows, left, _SINGLE_TAPE)
    best = np.argsort(-with_tape)[:_MOST_TAPED]
    tails = heavy_taped(rows, left[:, best], _SINGLE_TAPE) + np.log(_HEAVY)
    with_tape[best] = np.logaddexp(with_tape[best], tails)
    return np.asarray(np.logaddexp(np.log(1 - _TAPED) + free, np.log(_TAPED) + with_tape))


def nothing_but_noise(rows: Rows, error: Column) -> float:
    """Of the noises that tables without a cause are drawn with, at their own sizes."""
    left = error[:, None]
    logs = [normal(left), heavy(left), mean_of(_gaussian(_remembering(len(rows)), left))]
    if rows.design != "a":
        logs += [mean_of(_gaussian(_convection(rows), left)), taped(rows, left, _NULL_TAPE)]
    assert len(logs) == len(NULLS) - 2 * (rows.design == "a")
    return float(mean_of(logs)[0])


def unknown_noise(rows: Rows, left: Matrix) -> Column:
    """Of any of these noises, for somebody who does not know how large they are; shape (candidates,)."""
    kinds = [[_form(np.eye(len(rows)) * SHOT**2, left)]]
    kinds += [[_form(covariance, left) for covariance in _remembering(len(rows))]]
    if rows.design != "a":
        kinds += [[_form(covariance, left) for covariance in _convection(rows)]]
        kinds += [[_form(_tape(rows, size), left) for size in _ANY_TAPE]]
    at_any = []
    for scale in _SCALES:
        logs = [mean_of([-0.5 * (q / scale**2 + size) for q, size in kind]) for kind in kinds]
        at_any.append(mean_of([*logs, heavy(left / scale)]) - len(left) * np.log(scale))
    return mean_of(at_any)


def mean_of(logs: list[Column]) -> Column:
    """Logarithm of the mean of densities that are as likely as each other."""
    return np.asarray(logsumexp(logs, axis=0) - np.log(len(logs)))


def _gaussian(covariances: list[Matrix], left: Matrix) -> list[Column]:
    """Log density under each covariance."""
    forms = (_form(covariance, left) for covariance in covariances)
    return [-0.5 * (squares + size) for squares, size in forms]


def _form(covariance: Matrix, left: Matrix) -> tuple[Column, float]:
    """Squares of whitened rows, summed, and what a normal density has beside them."""
    factor = cholesky(covariance, lower=True, check_finite=False)
    white = solve_triangular(factor, left, lower=True, check_finite=False)
    size = 2 * np.log(np.diag(factor)).sum() + len(left) * _LOG2PI
    return (white**2).sum(0), float(size)


def _middles(low: float, high: float, count: int) -> Column:
    return np.asarray(low + (high - low) * (np.arange(count) + 0.5) / count)


@cache
def _remembering(n: int) -> list[Matrix]:
    """Covariances of `disturbance.remembering`, over its memories and shares."""
    lags = np.arange(n)
    return [
        SHOT**2 * (share * toeplitz(keep**lags) + (1 - share) * np.eye(n))
        for keep in _middles(0.3, 0.95, 6)
        for share in _middles(0.3, 1.0, 3)
    ]


def _tape(rows: Rows, size: float) -> Matrix:
    """Covariance of white noise with an error that all rows of a stand share."""
    same = rows.stand[:, None] == rows.stand
    return np.asarray(SHOT**2 * np.eye(len(rows)) + size**2 * same)


def _convection(rows: Rows) -> list[Matrix]:
    """Covariances of `disturbance.convection`, over its memories."""
    lags = np.arange(len(rows))
    growth = np.sqrt(np.outer(rows.distance, rows.distance)) / 2
    white = (0.8 * SHOT) ** 2 * np.eye(len(rows))
    return [
        white + (0.6 * SHOT) ** 2 * growth * toeplitz(np.exp(-lags / memory)) for memory in _middles(2, 40, 6)
    ]
