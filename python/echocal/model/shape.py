"""An unexplained term of a model: a function of one column, estimated from data."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, ModelError
from echocal.quantities import QUANTITIES

__all__ = ["DISTANCE", "Shape", "is_extra"]

Column = NDArray[np.float64]

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
            message = (
                f"the shape against {self.against} needs at, shift and standard_uncertainty of one length of "
                f"2 or more, finite, at ascending; they have {len(self.at)}, {len(self.shift)} and "
                f"{len(self.standard_uncertainty)}"
            )
            raise ModelError(message)

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
            message = (
                f"the model has an unexplained term against {self.against}, and {self.against} is "
                "not given: record it, or use the model without its shape (Model.without_shape)"
            )
            raise DataError(message)
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
