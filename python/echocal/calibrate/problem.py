"""A least-squares problem: residuals and exact derivatives of a form on given rows."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate.form import Column, Columns, Form, Parameter
from echocal.calibrate.losses import LOSSES

__all__ = ["Problem"]

TOLERANCE = 1e-12  # of cost, step and gradient; the last digits come from `polish`

Matrix = NDArray[np.float64]


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
