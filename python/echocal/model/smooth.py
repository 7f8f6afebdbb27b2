"""A smooth correction: a sum of smooth functions of recorded columns, without a known cause."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError, ModelError
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape

__all__ = ["Smooth"]

Column = NDArray[np.float64]


@dataclass(frozen=True)
class Smooth:
    """A smooth correction: a sum of smooth functions of recorded columns, without a known cause.

    It holds only inside the range of each of its columns. Outside of one of them, or where one has no
    value, it adds nothing: it does not extrapolate, and `outside` marks such rows. It is added to the
    indication after all effects. No firmware can contain it.

    Attributes
    ----------
    offset : float
        Shift of the readings that no column has [m].
    terms : tuple of Shape
        One function for each column. The range of the column is from its first to its last knot.
    residual_uncertainty : ResidualUncertainty or None
        That of a model with this correction, inside of the ranges.

    Raises
    ------
    ModelError
        If there is no term, or two are against one column, or the offset is not finite.

    Examples
    --------
    >>> from echocal.model import Shape
    >>> smooth = Smooth(1e-3, (Shape("temperature", (0.0, 20.0), (0.0, 2e-3), (1e-4, 1e-4)),))
    >>> smooth.of({"temperature": [10.0, 20.0, 30.0]}).tolist()
    [0.002, 0.003, 0.0]
    >>> smooth.outside({"temperature": [10.0, 20.0, 30.0]}).tolist()
    [False, False, True]
    """

    offset: float
    terms: tuple[Shape, ...]
    residual_uncertainty: ResidualUncertainty | None = None

    def __post_init__(self) -> None:
        names = [term.against for term in self.terms]
        if not names or len(set(names)) < len(names) or not np.isfinite(self.offset):
            message = (
                "a smooth correction needs a finite offset and one term for each of its columns; it has "
                f"the offset {self.offset} and terms against {', '.join(names) or 'no column'}"
            )
            raise ModelError(message)

    @property
    def against(self) -> str:
        """Its columns, as text."""
        return ", ".join(self.columns)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its columns."""
        return tuple(term.against for term in self.terms)

    def of(self, given: Mapping[str, Any]) -> Column:
        """Shift [m] where the columns have these values; 0 outside of the range of one of them."""
        total = self.offset + sum(term.of(self._column(term, given)) for term in self.terms)
        return np.asarray(np.where(self.outside(given), 0.0, total))

    def within(self, given: Mapping[str, Any]) -> Column:
        """The same with values outside of a range set on its end."""
        return np.asarray(self.offset + sum(term.of(self._column(term, given)) for term in self.terms))

    def variance(self, given: Mapping[str, Any]) -> Column:
        """Variance of the shift [m^2], inside of the ranges."""
        return np.asarray(sum(term.band(self._column(term, given)) ** 2 for term in self.terms))

    def outside(self, given: Mapping[str, Any]) -> NDArray[np.bool_]:
        """Rows where a column is outside of its range or has no value."""
        inside: Any = True
        for term in self.terms:
            column = self._column(term, given)
            inside = inside & (column >= term.at[0]) & (column <= term.at[-1])
        return np.asarray(~np.asarray(inside))

    def which_outside(self, given: Mapping[str, Any]) -> tuple[NDArray[np.int64], tuple[str, ...]]:
        """Position of the first column that is outside of its range, -1 for none; and the columns."""
        first = np.full(np.shape(self.outside(given)), -1)
        for place, term in reversed(list(enumerate(self.terms))):
            column = self._column(term, given)
            first = np.where((column >= term.at[0]) & (column <= term.at[-1]), first, place)
        return first, self.columns

    def _column(self, term: Shape, given: Mapping[str, Any]) -> Column:
        if term.against not in given:
            message = (
                f"the model has a smooth correction against {self.against}, and {term.against} is not "
                "given: record it, or use the model without the correction (Model.without_shape)"
            )
            raise DataError(message)
        return np.asarray(given[term.against], dtype=float)

    def to_dict(self) -> dict[str, Any]:
        """As in a model file."""
        residual = self.residual_uncertainty
        measured = {} if residual is None else {"residual_uncertainty": residual.to_dict()}
        return {
            "offset": self.offset,
            "terms": [term.to_dict() for term in self.terms],
            "unit": "m",
            **measured,
        }
