"""A least-squares problem: residuals and exact derivatives of a form on given rows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.errors import ModelError
from echocal.observations import Observations

Columns = Mapping[str, Column]
Matrix = NDArray[np.float64]
SETTLE = 3  # rounds in which robust values and their scale settle together


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

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, Matrix]:
        """Return the prediction (n,) and its exact derivatives (n, p) at these values."""

    def fitted(self, values: Column, covariance: Matrix) -> Any:
        """Return the object that holds what was found: a `Model`, a `Regression`."""


Loss = Callable[[Column], Column]

TOLERANCE = 1e-12  # of cost, step and gradient; the last digits come from `polish`


@dataclass
class Problem:
    """Predicted minus observed, weighted, and its derivatives."""

    form: Form
    observed: Column
    columns: Columns
    parameters: Sequence[Parameter]
    sigma: Column | None = None
    _seen: tuple[bytes, Column, Matrix] | None = field(default=None, repr=False)

    @property
    def lower(self) -> Column:
        """Lower bounds, shape (p,)."""
        return np.array([parameter.bounds[0] for parameter in self.parameters])

    @property
    def upper(self) -> Column:
        """Upper bounds, shape (p,)."""
        return np.array([parameter.bounds[1] for parameter in self.parameters])

    @property
    def weight(self) -> Column:
        """Factor of each residual, shape (n,)."""
        return np.ones(len(self.observed)) if self.sigma is None else 1.0 / self.sigma

    def residuals(self, values: Column) -> Column:
        """Predicted minus observed, in standard uncertainties where these are known, shape (n,)."""
        return (self._evaluate(values)[0] - self.observed) * self.weight

    def jacobian(self, values: Column) -> Matrix:
        """Return the derivatives of the residuals, shape (n, p)."""
        return self._evaluate(values)[1] * self.weight[:, None]

    def _evaluate(self, values: Column) -> tuple[Column, Matrix]:
        key = values.tobytes()
        if self._seen is None or self._seen[0] != key:  # scipy asks for both, one after the other
            self._seen = (key, *self.form.evaluate(values, self.columns))
        return self._seen[1], self._seen[2]

    def start(self) -> Column:
        """Return the given start, or one scale away from it where some derivative vanishes there.

        At amplitude 0, an effect with an amplitude and a time constant does not depend on the constant.
        """
        given = np.array([parameter.start for parameter in self.parameters], dtype=np.float64)
        given = np.clip(given, self.lower, self.upper)
        if np.all(np.any(self.jacobian(given) != 0.0, axis=0)):
            return given
        scales = np.array([parameter.scale for parameter in self.parameters])
        return np.asarray(np.clip(given + scales, self.lower, self.upper), dtype=np.float64)

    def search(self, start: Column, loss: str, scale: float) -> Column:
        """Trust-region search within the bounds, from a start."""
        chosen: Any = "linear" if loss == "linear" else LOSSES[loss]
        from scipy.optimize import least_squares  # slow import: only a fit needs it

        found = least_squares(
            self.residuals,
            start,
            self.jacobian,
            bounds=(self.lower, self.upper),
            x_scale="jac",
            loss=chosen,
            f_scale=scale,
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=1000,
        )
        return np.asarray(found.x, dtype=np.float64)

    def first(self) -> Column:
        """Search with the plain sum of squares; a linear form without bounds is left to `polish`."""
        start = self.start()
        bounded = bool(np.any(np.isfinite([self.lower, self.upper])))
        if self.form.linear and not bounded:
            return start
        return self.search(start, "linear", 1.0)

    def polish(self, values: Column) -> Column:
        """Last undamped Gauss-Newton steps: a trust region stops at half of the digits.

        The cost is flat at its minimum, so its decrease cannot steer the last steps; the size of
        the step can. A step is taken while it shrinks and stays within the bounds.
        """
        before = np.inf
        for _ in range(10):
            matrix = self.jacobian(values)
            norms = np.linalg.norm(matrix, axis=0)
            scaled = np.linalg.lstsq(matrix / norms, -self.residuals(values), rcond=None)[0]
            moved, size = values + scaled / norms, float(np.linalg.norm(scaled))
            if not size < before or np.any(moved < self.lower) or np.any(moved > self.upper):
                break
            values, before = moved, size
        return values


def _linear(z: Column) -> Column:
    return np.stack([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z: Column) -> Column:
    t = 1.0 + z
    return np.stack([2.0 * (np.sqrt(t) - 1.0), t**-0.5, -0.5 * t**-1.5])


def _huber(z: Column) -> Column:
    inner = z <= 1.0
    t = np.where(inner, 1.0, z)
    return np.stack(
        [
            np.where(inner, z, 2.0 * np.sqrt(t) - 1.0),
            np.where(inner, 1.0, t**-0.5),
            np.where(inner, 0.0, -0.5 * t**-1.5),
        ]
    )


def _cauchy(z: Column) -> Column:
    t = 1.0 + z
    return np.stack([np.log1p(z), 1.0 / t, -1.0 / t**2])


LOSSES: dict[str, Loss] = {"linear": _linear, "soft_l1": _soft_l1, "huber": _huber, "cauchy": _cauchy}
"""rho, rho' and rho'' of the squared scaled residual, shape (3, n), as scipy takes them."""


def psi(loss: str, residuals: Column, scale: float) -> tuple[Column, Column]:
    """First and second derivative of the cost to each residual, each of shape (n,)."""
    z = (residuals / scale) ** 2
    _, first, second = LOSSES[loss](z)
    return first * residuals, first + 2.0 * second * z


def robust_scale(residuals: Column, parameters: int) -> float:
    """Standard deviation from the median absolute residual, corrected for the parameters.

    The factor 1.4826 = 1 / Phi^-1(3/4) makes it the standard deviation of a normal distribution.
    """
    n = len(residuals)
    return float(1.4826 * np.median(np.abs(residuals)) * np.sqrt(n / max(n - parameters, 1)))


@dataclass(frozen=True)
class Solution:
    """Where the search ended; residuals are predicted minus observed, in the response's unit."""

    values: Column
    covariance: Matrix
    residuals: Column
    residual_standard_deviation: float


def solve(problem: Problem, loss: str, loss_scale: float | None) -> Solution:
    """Find the values and propagate the scatter to their covariance.

    `loss_scale` is the residual at which the loss turns robust; None takes it from the residuals. Raises
    `ModelError` if the rows cannot identify a parameter.
    """
    values = problem.first()
    _require_rank(problem.jacobian(values), problem.parameters)
    values = problem.polish(values)
    scale = 1.0
    if loss != "linear":
        for _ in range(SETTLE):
            scale = loss_scale or robust_scale(problem.residuals(values), len(values)) or 1.0
            values = problem.search(values, loss, scale)
    residuals = problem.residuals(values)
    deviation = _deviation(residuals, len(values), loss)
    matrix = problem.jacobian(values)
    if loss == "linear":
        covariance = _covariance(matrix, deviation if problem.sigma is None else 1.0)
    else:
        covariance = _sandwich(matrix, *psi(loss, residuals, scale))
    return Solution(values, covariance, residuals / problem.weight, deviation)


def _deviation(residuals: Column, parameters: int, loss: str) -> float:
    degrees = len(residuals) - parameters
    if degrees < 1:
        return float("nan")
    if loss != "linear":
        return robust_scale(residuals, parameters)
    return float(np.sqrt(residuals @ residuals / degrees))


def _covariance(matrix: Matrix, deviation: float) -> Matrix:
    """Covariance of least squares (GUM H.3): the inverse of the normal matrix, from its square root."""
    norms = np.linalg.norm(matrix, axis=0)
    _, singular, axes = np.linalg.svd(matrix / norms, full_matrices=False)
    root = axes.T / singular * deviation
    return np.asarray(root @ root.T / np.outer(norms, norms))


def _sandwich(matrix: Matrix, first: Column, second: Column) -> Matrix:
    """Covariance of an M-estimate (Huber 1981, 7.6), from the cost's derivatives."""
    norms = np.linalg.norm(matrix, axis=0)
    scaled = matrix / norms
    rows, parameters = matrix.shape
    bread = np.linalg.inv(scaled.T @ (scaled * second[:, None]))
    meat = scaled.T @ (scaled * first[:, None] ** 2) * (rows / max(rows - parameters, 1))
    return np.asarray(bread @ meat @ bread / np.outer(norms, norms))


def _require_rank(matrix: Matrix, parameters: Sequence[Parameter]) -> None:
    """Raise `ModelError` with the names of the parameters that the rows cannot separate."""
    norms = np.linalg.norm(matrix, axis=0)
    names = [parameter.name for parameter in parameters]
    idle = [name for name, norm in zip(names, norms, strict=True) if norm == 0.0]
    if idle:
        message = f"cannot identify {' and '.join(idle)}: no influence on these rows; leave it out of fit"
        raise ModelError(message)
    _, singular, axes = np.linalg.svd(matrix / norms, full_matrices=False)
    if singular[-1] > max(matrix.shape) * np.finfo(float).eps * singular[0]:
        return
    together = [name for name, part in zip(names, axes[-1], strict=True) if abs(part) > 0.05]
    raise ModelError(
        f"cannot identify {' and '.join(together)}: on these rows they act alike; fit one of them, "
        "or measure at more distances or under other conditions"
    )
