"""Which of two models makes rows that neither has seen more probable: docs/method.md, Eq. 48 and 49."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from echocal import _core
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, WHITE, Noise
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.validation.gain import INTERVAL, HeldOut, pieces_of

__all__ = ["Score", "score"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Score:
    """Log density of held-out rows with one model, less that with another one.

    Attributes
    ----------
    of_rows : ndarray, shape (k,)
        What each row adds, in the order of the rows.
    """

    of_rows: Column

    @property
    def total(self) -> float:
        """The sum over rows."""
        return float(self.of_rows.sum())

    def interval(self) -> tuple[float, float]:
        """Interval of the sum, from the variance between contiguous pieces: docs/method.md, Eq. 49."""
        count = len(self.of_rows)
        if not count:
            return 0.0, 0.0
        pieces = pieces_of(count)
        firsts = -(-np.arange(pieces) * count // pieces)
        sums = np.add.reduceat(self.of_rows, firsts)
        if pieces < 2:
            return -np.inf, np.inf
        half = stdtrit(pieces - 1, 0.5 + 0.5 * INTERVAL) * np.sqrt(pieces) * float(sums.std(ddof=1))
        return float(sums.sum() - half), float(sums.sum() + half)


def score(
    with_cause: HeldOut, without: HeldOut, order: Order, folds: Folds, noises: Sequence[Noise]
) -> Score:
    """Compare two models on the rows that the folds hold out.

    Parameters
    ----------
    with_cause, without : HeldOut
    order : Order
        Of the rows.
    folds : Folds
    noises : sequence of Noise
        That of each fold, known from the rows that it does not hold out.
    """
    judged = with_cause.known & without.known
    every, gained, square = np.arange(len(judged)), np.zeros(len(judged)), 0.0
    compared = np.zeros(len(judged), dtype=bool)
    for held, noise in zip(folds.held, noises, strict=True):
        rows = every[folds.rows(held)]
        rows = rows[judged[rows]]
        if not len(rows):
            continue
        whitening = _Whitening.of(order, rows, noise, _known_levels(order, folds, held, noise))
        own, other = (whitening.squares(one.error[rows]) for one in (with_cause, without))
        gained[rows], compared[rows] = other - own, True
        square += float(own.sum())
    variance = max(square / max(int(compared.sum()), 1), VARIANCE_FLOOR**2)
    return Score(gained[compared] / (2.0 * variance))


def _known_levels(order: Order, folds: Folds, held: Mask, noise: Noise) -> Column | None:
    """Information on the level, or on the error, of each group before its held-out rows are seen.

    That of the rows that the fold does not hold out, where the level is unknown; that of the prior, where
    stations err; None where they do not.
    """
    if not order.flat_level and noise.station_ratio == 0.0:
        return None
    groups = int(order.groups.max()) + 1
    if not order.flat_level:
        return np.full(groups, 1.0 / noise.station_ratio)
    seen = np.flatnonzero((folds.fit & ~held)[folds.blocks])
    if not len(seen):
        return np.zeros(groups)
    level = _white(np.ones(len(seen)), _followed(order, seen, noise), noise)
    return np.asarray(np.bincount(order.groups[seen], level**2, minlength=groups), dtype=np.float64)


@dataclass(frozen=True)
class _Whitening:
    """What whitens held-out rows of a fold.

    Attributes
    ----------
    order : Order or None
        Of these rows; None for white noise.
    groups : ndarray of int, or None
        Group of each of these rows; None where no group has a level.
    level : ndarray, or None
        A constant, whitened.
    before, own : ndarray, or None
        Information on the level of each group: before these rows are seen, and of these rows.
    """

    order: Order | None
    noise: Noise
    groups: Labels | None = None
    level: Column | None = None
    before: Column | None = None
    own: Column | None = None

    @classmethod
    def of(cls, order: Order, rows: Labels, noise: Noise, before: Column | None) -> "_Whitening":
        followed = _followed(order, rows, noise)
        if before is None:
            return cls(followed, noise)
        level, groups = _white(np.ones(len(rows)), followed, noise), order.groups[rows]
        known = np.bincount(groups, level**2, minlength=len(before))
        return cls(followed, noise, groups, level, before, np.asarray(known, dtype=np.float64))

    def squares(self, error: Column) -> Column:
        """What each row adds to the whitened sum of squares [m^2], levels averaged out.

        The rows of a group share what its level adds, which is its square times the information before.
        """
        white, groups = _white(error, self.order, self.noise), self.groups
        if groups is None or self.level is None or self.before is None or self.own is None:
            return white**2
        present = self.own > 0.0
        along = np.bincount(groups, self.level * white, minlength=len(self.own))
        levels = np.divide(along, self.before + self.own, out=np.zeros_like(along), where=present)
        shared = np.divide(self.before * levels**2, self.own, out=np.zeros_like(along), where=present)
        return np.asarray((white - self.level * levels[groups]) ** 2 + shared[groups] * self.level**2)


def _followed(order: Order, rows: Labels, noise: Noise) -> Order | None:
    """Which of some rows follow each other; None where that does not matter."""
    return None if noise.correlation is WHITE else order.at(rows)


def _white(values: Column, order: Order | None, noise: Noise) -> Column:
    """Innovations of a column: docs/method.md, Eq. 3, and docs/method/noises.md, Eq. 4."""
    if order is None:
        return values
    given = np.ascontiguousarray(values), order.starts, order.distance
    white, _ = _core.whitened(noise.correlation, noise.rho, noise.first_weight, *given)
    return np.asarray(white)
