"""Terms without a known cause: against one column (`Shape`), or a sum over several (`Smooth`)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.arrays import Column
from echocal.errors import DataError, ModelError
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.quantities import QUANTITIES

DISTANCE = "distance"
"""Name under which a shape is a function of the true distance."""


def is_extra(name: str) -> bool:
    """Whether a column of a term is neither an influence quantity nor the distance."""
    return name not in QUANTITIES and name != DISTANCE


@dataclass(frozen=True)
class Shape:
    """An unexplained term: deviation of the readings as a function of one column, without a known cause.

    It is linear between its knots and constant outside the observed range. It is added to the
    indication after all effects. No firmware can contain it.

    Attributes
    ----------
    against : str
        ``"distance"``, an influence quantity, or a further column by its name in the table.
    at : tuple of float
        Knots, ascending, in the unit of the column (SI for quantities, degC for temperatures).
    shift : tuple of float
        Deviation of the readings there [m].
    standard_uncertainty : tuple of float
        Of the shifts [m].

    Raises
    ------
    ModelError
        If the knots are no ascending finite numbers, or the lengths differ.

    Examples
    --------
    >>> shape = Shape("temperature", (0.0, 20.0), (0.0, 2e-3), (1e-4, 1e-4))
    >>> shape.of([-5.0, 10.0, 30.0]).tolist()
    [0.0, 0.001, 0.002]
    """

    against: str
    at: tuple[float, ...]
    shift: tuple[float, ...]
    standard_uncertainty: tuple[float, ...]

    def __post_init__(self) -> None:
        lengths = {len(self.at), len(self.shift), len(self.standard_uncertainty)}
        numbers = np.array([*self.at, *self.shift, *self.standard_uncertainty])
        fits = len(lengths) == 1 and len(self.at) >= 2 and np.isfinite(numbers).all()
        if not fits or not (np.diff(self.at) > 0).all() or min(self.standard_uncertainty) < 0:
            raise ModelError(
                f"the shape against {self.against} needs at, shift and standard_uncertainty of one length of "
                f"2 or more, finite, at ascending; they have {len(self.at)}, {len(self.shift)} and "
                f"{len(self.standard_uncertainty)}"
            )

    def of(self, values: ArrayLike) -> Column:
        """Shift [m] at values of the column; NaN where the value is NaN."""
        return np.asarray(np.interp(np.asarray(values, dtype=float), self.at, self.shift))

    def band(self, values: ArrayLike) -> Column:
        """Standard uncertainty of the shift [m]."""
        return np.asarray(np.interp(np.asarray(values, dtype=float), self.at, self.standard_uncertainty))

    @property
    def columns(self) -> tuple[str, ...]:
        """Its column, as a tuple."""
        return (self.against,)

    def column(self, conditions: dict[str, Any]) -> Any:
        """Values of its column among what is given."""
        if self.against not in conditions:
            raise DataError(
                f"the model has an unexplained term against {self.against}, and {self.against} is "
                "not given: record it, or use the model without its shape (Model.without_shape)"
            )
        return conditions[self.against]

    def to_dict(self) -> dict[str, Any]:
        """As in a model file."""
        return {
            "against": self.against,
            "at": list(self.at),
            "shift": list(self.shift),
            "standard_uncertainty": list(self.standard_uncertainty),
            "unit": "m",
        }


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
            raise ModelError(
                "a smooth correction needs a finite offset and one term for each of its columns; it has "
                f"the offset {self.offset} and terms against {', '.join(names) or 'no column'}"
            )

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
            raise DataError(
                f"the model has a smooth correction against {self.against}, and {term.against} is not "
                "given: record it, or use the model without the correction (Model.without_shape)"
            )
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
