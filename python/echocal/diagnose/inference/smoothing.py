"""Additive penalized splines: which columns take part, how smooth they are, and their coefficients."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.splines import Spline
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.table import Table
from echocal.model.shape import DISTANCE

__all__ = ["Coefficients", "Smoother", "least", "values_of"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]
Weights = Mapping[int, float]
"""Weight of the penalty of each spline that takes part, by its position."""

WHITE_NOISE = Noise(0.0, 0.0, 0.0, 1.0)

_RIDGE = 1e-8  # of the mean product: a spline without its mean has one coefficient too many


def values_of(table: Table, name: str) -> Column:
    """Values of a column of a spline."""
    if name == DISTANCE:
        assert table.reference is not None
        return table.reference
    return table.conditions[name] if name in table.conditions else table.extra[name]


MOST_ROWS = 50_000
"""Rows of a larger table that are fitted: evenly spaced runs."""

_GAIN = 3.0  # log likelihood of rows left out, that a column must add
_STANDARD_ERRORS = 1.0  # of what it adds, from its scatter over the parts left out, that it must add besides
_RUN = 500  # rows, far longer than noise is correlated
_PENALTIES = (
    1e-4,
    1e-3,
    1e-2,
    1e-1,
    1.0,
    1e2,
)  # of the trace: about ten degrees of freedom to a straight line
_MOST_TERMS = 6  # columns of one smooth correction
_MOST_BESIDE = 8  # columns that are tried beside the first one: those that predict best alone


@dataclass(frozen=True)
class Coefficients:
    """Splines fitted to some rows.

    Attributes
    ----------
    offset : float
        The part without a column [m].
    splines : tuple of (int, ndarray, ndarray)
        Position of each spline, its coefficients [m] and their covariance [m^2].
    """

    offset: float
    splines: tuple[tuple[int, Column, Column], ...]


@dataclass(frozen=True, eq=False)
class Smoother:
    """Splines of several columns, and products of their basis functions over blocks of rows.

    Attributes
    ----------
    splines : tuple of Spline
    means : tuple of ndarray
        Mean of each basis function, which is subtracted.
    places : tuple of slice
        Position of each spline among the products.
    has_offset : bool
        Whether a constant is fitted; an unknown level contains it.
    sums : Sums
    noise : Noise
    known : dict
        Products over blocks that were requested before.
    """

    splines: tuple[Spline, ...]
    means: tuple[Column, ...]
    places: tuple[slice, ...]
    has_offset: bool
    sums: Sums
    noise: Noise
    known: dict[tuple[bool, bytes], tuple[Column, int]] = field(default_factory=dict, repr=False)

    @classmethod
    def of(
        cls, case: Case, splines: Sequence[Spline], residuals: Sequence[Column], noise: Noise
    ) -> "Smoother":
        """Pass once over the rows, for several residuals [m] that are to be explained."""
        table = case.table
        rows = _rows(len(table))
        columns = Columns(case.base.plain, np.ones(len(rows)), {}, None)
        columns.store(np.ones(len(rows)))
        has_offset = table.reference is not None
        if has_offset:
            columns.store(np.ones(len(rows)))
        means, places = [], []
        for spline in splines:
            design = spline.at(values_of(table, spline.against)[rows])
            means.append(design.mean(axis=0))
            first = len(columns)
            for column in (design - means[-1]).T:
                columns.store(column)
            places.append(slice(first, len(columns)))
        for residual in residuals:
            columns.store(residual[rows])
        order = case.sums.order if len(rows) == len(table) else case.sums.order.at(rows)
        sums = Sums.gather(columns, order, case.folds.blocks[rows], [0.0, noise.correlation])
        return cls(tuple(splines), tuple(means), tuple(places), has_offset, sums, noise)

    def over(self, blocks: Mask, noise: Noise | None = None) -> tuple[Column, int]:
        """Whitened products over some blocks, and rows less unknown levels."""
        key = (noise is None, blocks.tobytes())
        if key not in self.known:
            products = self.sums.whiten(noise or self.noise, blocks).products
            self.known[key] = products, self.sums.degrees(blocks)
        return self.known[key]

    def chosen(self, blocks: Mask, held: Sequence[Mask], residual: int) -> dict[int, float]:
        """Columns and penalties that predict blocks which they are not fitted to.

        docs/method/checks.md, Eq. 33.

        Parameters
        ----------
        blocks : ndarray of bool
            Blocks that may be seen.
        held : sequence of ndarray of bool
            Parts of them that are left out in turn.
        residual : int
            Position of what is explained, among the products.
        """
        best: dict[int, float] = {}
        able, square = list(range(len(self.splines))), np.inf
        gains = np.zeros(len(held))
        while len(best) < _MOST_TERMS and able:
            tried = {place: self._gains(blocks, held, best, place, residual) for place in able}
            found = {
                p: np.where(squares < square, parts.sum(axis=0), -np.inf)
                for p, (parts, squares) in tried.items()
            }
            able = sorted(able, key=lambda place: -found[place].max())[:_MOST_BESIDE]
            place = able.pop(0)
            weight = int(found[place].argmax())
            more = tried[place][0][:, weight] - gains
            if not (np.isfinite(found[place][weight]) and more.sum() > least(more)):
                break
            gains, square = gains + more, float(tried[place][1][weight])
            best[place] = float(self._weights(blocks, place)[weight])
        return best

    def fitted(self, blocks: Mask, weights: Weights, residual: int) -> Coefficients:
        """Coefficients of the splines that take part: docs/method/checks.md, Eq. 32."""
        (products, degrees), used = self.over(blocks), self._used(weights)
        whole = products[np.ix_(used, used)] + self._penalty(weights, used)
        along, square = products[used, residual], products[residual, residual]
        mean = np.linalg.solve(whole, along)
        left = square - 2 * mean @ along + mean @ products[np.ix_(used, used)] @ mean
        variance = max(left / max(degrees, 1), VARIANCE_FLOOR**2)
        covariance = variance * np.linalg.inv(whole)
        splines, first = [], int(self.has_offset)
        for place in weights:
            own = slice(first, first + len(self.means[place]))
            splines.append((place, mean[own], covariance[own, own]))
            first = own.stop
        return Coefficients(float(mean[0]) if self.has_offset else 0.0, tuple(splines))

    def curve(self, place: int, at: Column, mean: Column, covariance: Column) -> tuple[Column, Column]:
        """A fitted spline and its standard uncertainty at values of its column [m]."""
        design = self.splines[place].at(at) - self.means[place]
        variance = np.einsum("ki,ij,kj->k", design, covariance, design)
        return np.asarray(design @ mean), np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    def _weights(self, blocks: Mask, place: int) -> Column:
        own, penalty = self.places[place], self.splines[place].penalty
        products, _ = self.over(blocks)
        unit = float(np.trace(products[own, own]) / np.trace(penalty))
        return unit * np.array(_PENALTIES)

    def _gains(
        self, blocks: Mask, held: Sequence[Mask], weights: Weights, place: int, residual: int
    ) -> tuple[Column, Column]:
        """Log likelihood of each part left out, relative to no splines; the scale of each is free.

        With some splines, and one more, for each weight of its penalty. Also the sum of squares of these
        blocks, as they are; infinite where it is not smaller than without splines.
        """
        tried = self._weights(blocks, place)
        used = self._used({**weights, place: 0.0})
        own = np.zeros((len(used), len(used)))
        own[-len(self.means[place]) :, -len(self.means[place]) :] = self.splines[place].penalty
        total, square, bare = np.zeros((len(held), len(tried))), np.zeros(len(tried)), 0.0
        for part, out in enumerate(held):
            fit = blocks & ~out
            if not fit.any():
                continue
            (seen, _), (other, degrees) = self.over(fit), self.over(out)
            whole = seen[np.ix_(used, used)] + self._penalty({**weights, place: 0.0}, used)
            along = np.broadcast_to(seen[used, residual][:, None], (len(tried), len(used), 1))
            mean = np.linalg.solve(whole + np.multiply.outer(tried, own), along)[..., 0]
            floor = max(degrees, 1) * VARIANCE_FLOOR**2
            before = max(other[residual, residual], floor)
            after = np.maximum(_left(other, used, residual, mean), floor)
            total[part] = 0.5 * degrees * np.log(before / after)
            plain = self.over(out, WHITE_NOISE)[0]
            square += _left(plain, used, residual, mean)
            bare += plain[residual, residual]
        return total, np.where(square < bare, square, np.inf)

    def _used(self, weights: Weights) -> Labels:
        own = [np.arange(self.places[p].start, self.places[p].stop) for p in weights]
        return np.concatenate([np.arange(1, 2 if self.has_offset else 1), *own])

    def _penalty(self, weights: Weights, used: Labels) -> Column:
        every, _ = self.over(np.ones(len(self.sums.rows), dtype=bool))  # a column may not vary in some blocks
        matrix = _RIDGE * np.trace(every[np.ix_(used, used)]) / len(used) * np.eye(len(used))
        first = int(self.has_offset)
        for place, weight in weights.items():
            end = first + len(self.means[place])
            matrix[first:end, first:end] += weight * self.splines[place].penalty
            first = end
        return np.asarray(matrix)


def least(more: Column) -> float:
    """What a further column must add to the log likelihood, from what it adds in each part left out."""
    parts = len(more)
    error = np.sqrt(parts) * more.std(ddof=1) if parts > 1 else 0.0
    return float(_GAIN + _STANDARD_ERRORS * error)


def _left(products: Column, used: Labels, residual: int, mean: Column) -> Column:
    """Sum of squares that some coefficients leave, for each line of coefficients."""
    squares = ((mean @ products[np.ix_(used, used)]) * mean).sum(axis=1)
    return np.asarray(products[residual, residual] - 2 * mean @ products[used, residual] + squares)


def _rows(count: int) -> Labels:
    """All rows, or evenly spaced runs of many."""
    if count <= MOST_ROWS:
        return np.arange(count)
    runs = MOST_ROWS // _RUN
    firsts = np.arange(runs) * (count - _RUN) // (runs - 1)
    return (firsts[:, None] + np.arange(_RUN)).ravel()
