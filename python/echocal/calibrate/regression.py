"""Data-driven forms: regressions in columns of the table, calibrated like a physical model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate.form import Column, Columns, Parameter
from echocal.errors import DataError, UsageError, among
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import QUANTITIES

__all__ = ["Regression", "indication"]

UNITS = {name: quantity.unit for name, quantity in QUANTITIES.items()} | {"distance": "m", "echo_time": "s"}


def indication(observations: Observations, device: Model) -> Column:
    """Indication [m] of a device without effects that converts the recorded echoes, shape (n,).

    Its echo time at 1 m is 2/c at the recorded conditions, so no formula for c is needed here.
    """
    rows = len(observations)
    used = observations.usable
    at = {name: column[used] for name, column in observations.conditions.items()}
    per_meter = np.full(rows, np.nan)
    per_meter[used] = device.time_of_flight(np.ones(int(used.sum())), **at)
    return np.asarray(observations.echo_time / per_meter)


@dataclass(frozen=True)
class Regression:
    """A sum of terms in the columns of a table, each with a coefficient.

    Parameters
    ----------
    terms : sequence of str
        ``"1"``, a column's name, a power ``"temperature^2"`` or a product
        ``"temperature*relative_humidity"``. Columns are the influence quantities,
        ``"distance"`` (the reference), ``"echo_time"`` and every further column of the table.
    response : str
        The column to be described; ``"indication"`` is the indication of a device that converts
        the echoes with `law`.
    law : str
        Name or expression of that law.
    values : tuple of float
        Coefficients, once known.

    Examples
    --------
    >>> Regression.polynomial("temperature", 2).terms
    ('1', 'temperature', 'temperature^2')
    """

    terms: Sequence[str]
    response: str = "indication"
    law: str = "linear"
    values: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        repeated = {term for term in self.terms if list(self.terms).count(term) > 1}
        if not self.terms or repeated:
            message = f"a regression needs distinct terms; got {list(self.terms)}"
            raise UsageError(message)

    @classmethod
    def polynomial(
        cls, column: str, degree: int, *, response: str = "indication", law: str = "linear"
    ) -> "Regression":
        """Return a polynomial in one column.

        Parameters
        ----------
        column : str
            The column that the polynomial is in.
        degree : int
            Its degree; 1 is a straight line.
        response : str
            The column to be described.
        law : str
            Law that turns echoes into indications.
        """
        if not isinstance(degree, int) or degree < 0:
            message = f"degree is {degree!r}; give a whole number of 0 or more"
            raise UsageError(message)
        powers = [column if power == 1 else f"{column}^{power}" for power in range(1, degree + 1)]
        return cls(("1", *powers), response, law)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """One coefficient per term, named like the term."""
        start = self.values or (0.0,) * len(self.terms)
        return tuple(
            Parameter(term, self._unit(term), value) for term, value in zip(self.terms, start, strict=True)
        )

    @property
    def unit(self) -> str:
        """Unit of the response, where it is known."""
        return "m" if self.response == "indication" else UNITS.get(self.response, "")

    def _unit(self, term: str) -> str:
        """Unit of a coefficient; empty where a column's unit is not known."""
        parts = [(UNITS.get(name, ""), power) for name, power in _factors(term)]
        if not self.unit or not all(unit for unit, _ in parts):
            return self.unit if term == "1" else ""
        below = [unit if power == 1 else f"{unit}^{power}" for unit, power in parts if unit != "1"]
        return "/".join([self.unit, *below])

    @property
    def has_intercept(self) -> bool:
        """Whether the terms include the constant."""
        return "1" in self.terms

    @property
    def linear(self) -> bool:
        """A sum of terms is linear in its coefficients."""
        return True

    def observed(self, observations: Observations) -> Column:
        """Return what was observed, shape (n,)."""
        if self.response == "indication":
            return indication(observations, Model(self.law))
        return _column(observations, self.response)

    def columns(self, observations: Observations) -> Columns:
        """Return the columns that the terms read."""
        names = {name for term in self.terms for name, _ in _factors(term)}
        return {name: _column(observations, name) for name in sorted(names)}

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, NDArray[np.float64]]:
        """Return the prediction and its derivatives, which are the terms themselves."""
        columns = {name: np.asarray(column, dtype=np.float64) for name, column in columns.items()}
        shape = np.broadcast_shapes(*(column.shape for column in columns.values()))
        products = [
            np.prod(
                [np.broadcast_to(columns[name], shape) ** power for name, power in _factors(term)], axis=0
            )
            if term != "1"
            else np.ones(shape)
            for term in self.terms
        ]
        jacobian = np.stack(products, axis=-1)
        return jacobian @ values, jacobian

    def fitted(self, values: Column, covariance: NDArray[np.float64]) -> "Regression":
        """Return the regression with these coefficients."""
        return replace(self, values=tuple(values.tolist()))


def _factors(term: str) -> list[tuple[str, int]]:
    """Names and powers in a term: ``"a^2*b"`` is ``[("a", 2), ("b", 1)]``."""
    if term == "1":
        return []
    factors = []
    for factor in term.split("*"):
        name, caret, power = factor.strip().partition("^")
        if not name or (caret and not power.strip().isdigit()):
            message = f"cannot read the term '{term}'; write '1', 'temperature', 'temperature^2' or 'a*b'"
            raise UsageError(message)
        factors.append((name, int(power) if caret else 1))
    return factors


def _column(observations: Observations, name: str) -> Column:
    known: dict[str, Column] = {"echo_time": observations.echo_time}
    known |= observations.conditions
    known |= observations.extra
    if observations.reference_distance is not None:
        known["distance"] = observations.reference_distance
    if name not in known:
        message = f"the table has no column '{name}'{among(name, known)}"
        raise DataError(message)
    return known[name]
