"""What a calibration found, with its uncertainties."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.arrays import Column
from echocal.calibrate.problem import Form, Parameter
from echocal.concise import concise
from echocal.conditions import numbers
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.shown import Shown


@dataclass(frozen=True)
class Estimate:
    """An estimated parameter and its standard uncertainty (GUM 2.3.1)."""

    name: str
    value: float
    standard_uncertainty: float
    unit: str

    def __str__(self) -> str:
        return f"{self.name} = {concise(self.value, self.standard_uncertainty, self.unit)}"


@dataclass(frozen=True)
class Prediction:
    """A predicted indication.

    Attributes
    ----------
    value : ndarray
        Prediction, in the unit of the response.
    standard_uncertainty : ndarray
        Its standard uncertainty from the parameters' covariance (delta method).
    observation_standard_uncertainty : ndarray
        The same for one further observation: the scatter of the residuals is added.
    """

    value: Column
    standard_uncertainty: Column
    observation_standard_uncertainty: Column


@dataclass(frozen=True, repr=False)
class Calibration(Shown):
    """Estimates, covariance and residuals of a calibration (VIM 2.39).

    Attributes
    ----------
    form : Form
        What was fitted.
    parameters : sequence of Parameter
        What was estimated, with bounds.
    values : ndarray, shape (p,)
        Estimates.
    covariance : ndarray, shape (p, p)
        Covariance of the estimates.
    residuals : ndarray, shape (n,)
        Observed minus predicted, in the unit of the response; NaN for a row that was not used.
    residual_standard_deviation : float
        From the residuals and the degrees of freedom; for a robust loss, from the median. In units of
        the given standard uncertainty if there is one.
    r_squared : float
        Coefficient of determination.
    rows : dict of str to int
        ``total``, ``used``, and a count for each reason why rows were not used.
    loss : str
        The loss.
    notes : tuple of str
        What a person should know: conditions that were stated, not recorded.
    model : Model or object
        The calibrated `Model`; for another form what its ``fitted`` returns.

    Examples
    --------
    >>> import numpy as np
    >>> from echocal import Regression, calibrate
    >>> from echocal.observations import Observations
    >>> echo = np.array([0.0121, 0.0120, 0.0118, 0.0117])
    >>> data = Observations(echo, {"temperature": np.array([0.0, 5.0, 10.0, 15.0])}, None, np.full(4, ""))
    >>> found = calibrate(data, Regression.polynomial("temperature", 1, law="343"))
    >>> print(found["temperature"])
    temperature = -0.0048(5) m/degC
    >>> round(found.r_squared, 3), found.degrees_of_freedom
    (0.98, 2)
    """

    form: Form
    parameters: Sequence[Parameter]
    values: Column
    covariance: NDArray[np.float64]
    residuals: Column
    residual_standard_deviation: float
    r_squared: float
    rows: dict[str, Any]
    loss: str = "linear"
    model: Any = field(default=None)
    notes: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """Names of the estimated parameters, in the order of `values`."""
        return [parameter.name for parameter in self.parameters]

    @property
    def standard_uncertainties(self) -> Column:
        """Standard uncertainty of each estimate, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Correlation of the estimates, shape (p, p)."""
        deviation = self.standard_uncertainties
        with np.errstate(invalid="ignore"):  # data without scatter have none: NaN
            return np.asarray(self.covariance / np.outer(deviation, deviation))

    @property
    def degrees_of_freedom(self) -> int:
        """Rows used minus parameters."""
        return int(self.rows["used"]) - len(self.values)

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, in the unit of the response."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))

    @property
    def at_bounds(self) -> list[str]:
        """Parameters that ended on a bound: their uncertainties are not reliable."""
        return [
            parameter.name
            for parameter, value in zip(self.parameters, self.values, strict=True)
            if np.isclose(value, parameter.bounds, rtol=1e-6, atol=1e-6 * parameter.scale).any()
        ]

    def __getitem__(self, name: str) -> Estimate:
        if name not in self.names:
            raise UsageError(f"'{name}' was not fitted; fitted: {', '.join(self.names)}")
        return list(self)[self.names.index(name)]

    def __iter__(self) -> Iterator[Estimate]:
        for parameter, value, deviation in zip(
            self.parameters, self.values, self.standard_uncertainties, strict=True
        ):
            yield Estimate(parameter.name, float(value), float(deviation), parameter.unit)

    def interval(self, coverage: float = 0.95) -> dict[str, tuple[float, float]]:
        """Coverage interval per parameter (GUM G.3: Student's t).

        Parameters
        ----------
        coverage : float
            Coverage probability.
        """
        from scipy import stats  # slow import: only an interval needs it

        factor = float(stats.t.ppf(0.5 + coverage / 2.0, self.degrees_of_freedom))
        return {
            e.name: (e.value - factor * e.standard_uncertainty, e.value + factor * e.standard_uncertainty)
            for e in self
        }

    def predict(self, **columns: ArrayLike) -> Prediction:
        """Predict the response, with its standard uncertainty.

        Parameters
        ----------
        **columns : array_like
            What the form reads: ``distance`` [m] and influence quantities for a physical model
            (the prediction is the indication [m] of a device with the law that was given),
            the columns of its terms for a regression.

        Returns
        -------
        Prediction
            In the shape of the columns.

        Raises
        ------
        UsageError
            If a column is no numbers, or the columns do not broadcast.
        DataError
            If the form reads a column that is not given.

        References
        ----------
        .. [1] JCGM 100:2008 (GUM), 5.2.2, equation (13).
        """
        value, jacobian = self._evaluate(columns)
        variance = np.einsum("...i,ij,...j->...", jacobian, self.covariance, jacobian)
        deviation = self.residual_standard_deviation
        return Prediction(value, np.sqrt(variance), np.sqrt(variance + deviation**2))

    def _evaluate(self, columns: Mapping[str, ArrayLike]) -> tuple[Column, NDArray[np.float64]]:
        arrays = {name: numbers(name, column) for name, column in columns.items()}
        if isinstance(self.model, Model):
            self.model.refuse_missing(columns)
        try:
            broadcast = dict(zip(arrays, np.broadcast_arrays(*arrays.values()), strict=True))
        except ValueError:
            shapes = ", ".join(f"{name} {column.shape}" for name, column in arrays.items())
            raise UsageError(f"shapes do not broadcast: {shapes}") from None
        try:
            return self.form.evaluate(self.values, broadcast)
        except KeyError as absent:
            message = f"the prediction needs {absent.args[0]}, which is not given: pass {absent.args[0]}=..."
            raise DataError(message) from None

    def to_dict(self) -> dict[str, Any]:
        """Everything but the rows, for JSON (schema ``echocal.calibration/1``)."""
        return {
            "schema": "echocal.calibration/1",
            "parameters": [
                {
                    "name": e.name,
                    "value": e.value,
                    "standard_uncertainty": _number(e.standard_uncertainty),
                    "unit": e.unit,
                }
                for e in self
            ],
            "covariance": [[_number(value) for value in row] for row in self.covariance],
            "correlation": [[_number(value) for value in row] for row in self.correlation],
            "residual_standard_deviation": _number(self.residual_standard_deviation),
            "rms": self.rms,
            "r_squared": self.r_squared,
            "degrees_of_freedom": self.degrees_of_freedom,
            "at_bounds": self.at_bounds,
            "loss": self.loss,
            "rows": self.rows,
            "notes": list(self.notes),
        }


def _number(value: float) -> float | None:
    """Return a number for JSON; what is not known is null."""
    return float(value) if np.isfinite(value) else None
