"""What a model gains on rows that its parameters are not fitted to."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri, stdtrit

from echocal.diagnose.findings.parts import Gain, Ladder
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.least_squares import ROUNDING, principal
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.preprocess.folds import Folds, Rows
from echocal.diagnose.preprocess.table import Table, levels
from echocal.diagnose.settings.priors import WIDEST
from echocal.model import Model

__all__ = [
    "INTERVAL",
    "REACHABLE",
    "HeldOut",
    "errors",
    "fixed_speed_rms",
    "floor",
    "intervals",
    "measure",
    "on_common_rows",
    "pieces_of",
    "summarize",
]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

Interval = tuple[float, float]


INTERVAL = 0.95
"""Probability of the intervals of the gain and of the log score."""

REACHABLE = 0.02
"""Of the mean square before: if less can be removed, there is no gain to reach."""

_ROUNDS = 3  # of the fixed point of the floor: the variance sets the ridge, and the ridge the variance
_RESAMPLES = 2000  # of the pieces
_PIECES = 40  # most pieces
_FEWEST_PIECES = 5  # the folds; there are not fewer, however long the memory is
_MEMORIES = 2.0  # times 1 / (1 - autoregression) units in a piece: exp(-2) of the autocorrelation is left


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Errors of one model on all rows that a fold holds out.

    Attributes
    ----------
    error : ndarray, shape (n,)
        Reading corrected by the model, less reference or level [m]. NaN where no fold holds the
        row out, or where no fitted row has the same level.
    """

    error: Column

    @cached_property
    def known(self) -> Mask:
        """Rows that a fold holds out and that have a level."""
        return np.isfinite(self.error)

    @cached_property
    def rms(self) -> float:
        """Root mean square [m]; NaN where no row is known."""
        return float(np.sqrt(np.mean(self.error[self.known] ** 2))) if self.known.any() else np.nan

    def of_units(self, table: Table) -> "HeldOut":
        """Mean errors of the units of a table."""
        return HeldOut(table.means(self.error))

    def on(self, rows: Mask) -> "HeldOut":
        """The same, of some rows."""
        return self if rows.all() else HeldOut(np.where(rows, self.error, np.nan))


def measure(table: Table, folds: Folds, fitted: Callable[[Mask], Model]) -> HeldOut:
    """For each fold, fit the model without its blocks, and correct the rows of these blocks.

    Parameters
    ----------
    table : Table
    folds : Folds
    fitted : callable
        ``fitted(blocks)`` is the model fitted on these blocks.
    """
    error = np.full(len(table), np.nan)
    for held in folds.held:
        test = folds.rows(held)
        model = fitted(folds.fit & ~held)
        if table.reference is not None:  # no level is estimated: only these rows are needed
            held_out = error[test]  # a view if they are contiguous
            table.correct(model, test, out=held_out)
            held_out -= table.reference[test]
            error[test] = held_out
        else:
            error[test] = errors(table, model, _others(test, folds.fitted))[test]
    return HeldOut(error)


def _others(rows: Rows, among: Mask) -> Mask:
    """All of some rows except these."""
    others = among.copy()
    others[rows] = False
    return others


def errors(table: Table, model: Model, level_from: Mask) -> Column:
    """Reading corrected by a model, less reference or less the mean level of some rows [m]."""
    corrected = table.correct(model)
    if table.reference is not None:
        return corrected - table.reference
    return corrected - levels(corrected, table.groups, level_from, np.mean)


def fixed_speed_rms(table: Table, folds: Folds, speed: Column) -> float:
    """Error of a device that converts every echo with the mean speed of the fitted rows [m]."""
    error = np.full(len(table), np.nan)
    for held in folds.held:
        test = folds.rows(held)
        if table.reference is not None:
            usual = (speed.sum() - speed[test].sum()) / (len(speed) - len(speed[test]))
            reading = np.divide(table.indication[test], speed[test])
            reading *= usual
            reading -= table.reference[test]
            error[test] = reading
            continue
        others = _others(test, folds.fitted)
        reading = table.indication / speed * speed[others].mean()
        error[test] = (reading - levels(reading, table.groups, others, np.mean))[test]
    return HeldOut(error).rms


def intervals(
    before: HeldOut, after: HeldOut, unit: Labels, rho: float, seed: int
) -> tuple[Interval, Interval]:
    """Intervals of the decrease of the RMS error [m] and of the part of the mean square that is removed.

    From resampled contiguous pieces of units, which are long against the memory of the noise. `unit` is that
    of each row.
    """
    judged = before.known & after.known
    begins = np.flatnonzero(np.diff(unit[judged], prepend=-1))
    count = len(begins)
    if count == 0:  # no row that judges has a level
        return (0.0, 0.0), (0.0, 0.0)
    pieces = pieces_of(count, rho)
    firsts = np.append(begins, judged.sum())[-(-np.arange(pieces + 1) * count // pieces)]
    rows = np.diff(firsts)
    errors = [held.error if judged.all() else held.error[judged] for held in (before, after)]
    squares = [np.array([_squares(piece) for piece in np.split(error, firsts[1:-1])]) for error in errors]
    drawn = np.random.default_rng(seed).integers(len(rows), size=(_RESAMPLES, len(rows)))
    places = drawn + len(rows) * np.arange(_RESAMPLES)[:, None]
    counts = np.bincount(places.ravel(), minlength=places.size).reshape(_RESAMPLES, -1)
    total = counts @ rows
    first, second = (counts @ square / total for square in squares)
    removed = 1.0 - np.divide(second, first, out=np.ones_like(first), where=first > 0.0)
    tail = 0.5 * (1 - INTERVAL)
    figures = np.array([np.sqrt(first) - np.sqrt(second), removed])
    ends = np.quantile(figures, [tail, 1 - tail], axis=1)
    middle = figures.mean(axis=1)
    low, high = (middle + _for_few(pieces, tail) * (ends - middle)).tolist()
    return (low[0], high[0]), (low[1], high[1])


def pieces_of(units: int, rho: float = 0.0) -> int:
    """Number of contiguous pieces of units that are nearly independent."""
    return min(max(_FEWEST_PIECES, min(int(units * (1.0 - rho) / _MEMORIES), _PIECES)), units)


def _for_few(pieces: int, tail: float) -> float:
    """Factor of an interval from resampled pieces, which is too narrow where they are few."""
    if pieces < 2:
        return 1.0
    return float(stdtrit(pieces - 1, tail) / ndtri(tail) * np.sqrt(pieces / (pieces - 1)))


def on_common_rows(one: HeldOut, other: HeldOut) -> tuple[HeldOut, HeldOut]:
    """Errors of two models on the rows that both can judge."""
    rows = one.known & other.known
    return one.on(rows), other.on(rows)


def _squares(values: Column) -> float:
    return float(np.einsum("i,i->", values, values))  # one pass, one thread


def floor(case: Case, variance: float) -> float:
    """Error that all columns together reach on the rows of the folds, without what chance removes [m].

    From a ridge regression whose prior is three times as wide as the priors. The
    residual sum of squares is divided by the rows less the effective number of coefficients. It is R_f of
    docs/method.md, Eq. 31.
    """
    sums, held = case.sums, case.folds.judged
    white = case.without_slow_air(sums.whiten(Noise(0.0, 0.0, 0.0, 1.0), held).products)
    squares, along = principal(white)
    for _ in range(_ROUNDS):
        ridge = max(variance, VARIANCE_FLOOR**2) / WIDEST**2
        taken = float((along**2 * (squares + 2.0 * ridge) / (squares + ridge) ** 2).sum())
        used = float((squares / (squares + ridge)).sum())
        left = max(white[-1, -1] - taken, ROUNDING * white[-1, -1])
        variance = left / max(sums.degrees(held) - used, 1.0)
    within = float(np.mean(case.table.deviation**2))  # of rows inside of units no column explains any
    return float(np.sqrt(variance + within))


def summarize(
    rms_fixed: float | None,
    ladder: Ladder,
    before: HeldOut,
    after: HeldOut,
    rms_floor: float,
    scheme: str,
    unit: Labels,
    rho: float,
    seed: int,
) -> Gain:
    """Put the errors together: docs/method.md, Eq. 31; `rho` is the autoregression of the noise of units."""
    before, after = on_common_rows(before, after)
    judged = int(before.known.sum())
    rms_floor = min(rms_floor, before.rms, after.rms)
    reachable = before.rms**2 - rms_floor**2
    gained, removed = intervals(before, after, unit, rho, seed)
    worth = reachable > REACHABLE * before.rms**2  # else there is no gain to reach
    return Gain(
        rms_fixed_speed_m=rms_fixed,
        ladder=ladder,
        rms_before_m=before.rms,
        rms_after_m=after.rms,
        rms_floor_m=rms_floor,
        held_out_rows=judged,
        fraction_of_reachable=(before.rms**2 - after.rms**2) / reachable if worth else None,
        interval_95=gained,
        variance_removed=1.0 - (after.rms / before.rms) ** 2 if before.rms > 0.0 else 0.0,
        variance_removed_interval_95=removed,
        scheme=scheme,
    )
