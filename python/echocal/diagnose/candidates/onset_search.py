"""Search for the onset of an effect: what the effect explains for each possible onset."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.scene import Scene
from echocal.registry import Effect

__all__ = ["OnsetSearch", "PrefixSumSearch"]

Column = NDArray[np.float64]
Matrix = NDArray[np.floating[Any]]

_ALIKE = 1e-9  # relative ridge, for columns that are linearly dependent


@dataclass(kw_only=True)
class OnsetSearch:
    """What the sizes of an effect explain beside a level, for each onset.

    Attributes
    ----------
    parameters : mapping of str to float
        Parameters at which the tangents are taken, except the onset.
    place : str
        Name of the parameter that is the onset.
    of : sequence of ndarray, shape (n,)
        Columns to be explained [m].
    known : dict of float to ndarray
        Products of the level, the tangents and the columns to be explained, by onset.
    """

    effect: Effect
    parameters: Mapping[str, float]
    place: str
    scene: Scene
    of: Sequence[Column]
    known: dict[float, Matrix] = field(default_factory=dict)

    def at(self, wanted: Sequence[float]) -> None:
        """Compute the products at some onsets."""
        new = [value for value in dict.fromkeys(wanted) if value not in self.known]
        if new:
            self.known |= self._products(new)

    def squares(self, value: float, of: int) -> float:
        """Sum of squares of one column that the effect explains with an onset."""
        products = self.known[value]
        own = len(products) - len(self.of)
        among, along = products[:own, :own], products[:own, own + of]
        ridge = np.diag(_ALIKE * among.diagonal() + np.finfo(float).tiny)
        return float(np.linalg.solve(among + ridge, along) @ along)

    def _products(self, values: Sequence[float]) -> dict[float, Matrix]:
        """Products at all these onsets, from one pass over the rows."""
        columns = self.scene.columns()
        slope = columns.slope()
        tangents = {value: self._tangents(columns, value) for value in values}
        left = [columns.store(of) for of in self.of]
        gram = columns.gram()
        designs = {value: [slope, *own, *left] for value, own in tangents.items()}
        return {value: gram[np.ix_(design, design)] for value, design in designs.items()}

    def _tangents(self, columns: Columns, value: float) -> list[int]:
        at = {**self.parameters, self.place: value}
        sizes = (p.name for p in self.effect.parameters if p.role == "size")
        return [columns.tangent(self.effect.id, at, name, 1.0) for name in sizes]


@dataclass(kw_only=True)
class PrefixSumSearch(OnsetSearch):
    """The same for an effect that does not depend on its onset in the rows beyond it.

    The distance must be known.

    Attributes
    ----------
    column : ndarray, shape (n,)
        Column along which onsets are searched.
    first : float
        The earliest onset. With it, the effect acts in all rows that matter.
    """

    column: Column
    first: float

    def _products(self, values: Sequence[float]) -> dict[float, Matrix]:
        ascending, whole, beyond = self._sums
        rows = np.searchsorted(ascending, values, side="right").tolist()
        return {value: self._matrix(whole, beyond, row) for value, row in zip(values, rows, strict=True)}

    def _matrix(self, whole: Matrix, beyond: Sequence[Sequence[Column]], row: int) -> Matrix:
        products = whole.copy()
        for size, sums in enumerate(beyond, 1):
            line = [float(one[row]) if row < len(one) else 0.0 for one in sums]
            products[size, :] = products[:, size] = line
        return products

    @cached_property
    def _sums(self) -> tuple[Column, Matrix, list[list[Column]]]:
        """The sorted column; products over all rows; products with each tangent, from each row on."""
        columns = self.scene.columns()
        made = [columns.slope(), *self._tangents(columns, self.first)]
        lines = [*(columns.combined([position], np.ones(1)) for position in made), *self.of]
        ascending = self.column
        if (ascending[1:] < ascending[:-1]).any():
            order = np.argsort(ascending, kind="stable")
            ascending, lines = ascending[order], [line[order] for line in lines]
        whole = np.array([[one @ other for other in lines] for one in lines])
        tangents = lines[1 : len(made)]
        return ascending, whole, [[_onward(one * other) for other in lines] for one in tangents]


def _onward(values: Column) -> Column:
    """Sums from each row to the last."""
    return np.cumsum(values[::-1])[::-1]
