"""A form that can be calibrated: it has named parameters, a prediction and exact derivatives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echocal.observations import Observations

__all__ = ["Column", "Columns", "Form", "Parameter"]

Column = NDArray[np.float64]
Columns = Mapping[str, Column]


@dataclass(frozen=True)
class Parameter:
    """A parameter to be estimated.

    Attributes
    ----------
    name : str
        Name in ``fit=[...]``, in results and in messages.
    unit : str
        SI unit.
    start : float
        Where the search begins.
    bounds : tuple of float
        Lowest and highest value, inclusive.
    scale : float
        A typical magnitude: the step away from a start at which all derivatives vanish.
    """

    name: str
    unit: str = "1"
    start: float = 0.0
    bounds: tuple[float, float] = (-np.inf, np.inf)
    scale: float = 1.0


class Form(Protocol):
    """A form that `calibrate` fits: a physical model or a regression."""

    @property
    def parameters(self) -> Sequence[Parameter]:
        """What is estimated, in the order of the derivatives."""

    @property
    def unit(self) -> str:
        """Unit of the response."""

    @property
    def has_intercept(self) -> bool:
        """Whether R² compares with the mean (True) or with zero (False)."""

    @property
    def linear(self) -> bool:
        """Whether the prediction is linear in the parameters: one step then finds them."""

    def observed(self, observations: Observations) -> Column:
        """What was observed, shape (n,)."""

    def columns(self, observations: Observations) -> Columns:
        """Return what the prediction reads, by name, each of shape (n,)."""

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, NDArray[np.float64]]:
        """Return the prediction (n,) and its exact derivatives (n, p) at these values."""

    def fitted(self, values: Column, covariance: NDArray[np.float64]) -> Any:
        """Return the object that holds what was found: a `Model`, a `Regression`."""
