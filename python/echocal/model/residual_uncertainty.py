"""What a corrected distance is uncertain by besides the parameters of its model: measured on rows."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from echocal.arrays import Column
from echocal.errors import ModelError

_CLASSES = 50  # of the distance, in which squares are summed: a variance that is linear in d^2 needs no more
_FINEST = 1e-6**2  # m^2, least variance that a rounding is compared with; far below that of any sensor


@dataclass(frozen=True)
class ResidualUncertainty:
    """Standard uncertainty of one corrected distance besides that of the parameters.

    It has the repeatability (VIM 2.21) and all that the model leaves unexplained, as far as the rows show
    it that it was measured on. Its square is ``constant**2 + (proportional * distance)**2``.

    Attributes
    ----------
    constant : float
        Part that every distance has [m].
    proportional : float
        Part that grows with the distance [1].
    rows : int
        Number of rows that it was measured on.
    low, high : float
        Smallest and largest distance of these rows [m].
    scheme : str
        How these rows were chosen.
    step : float
        Step of the readings, as a distance [m], whose rounding the constant part has; 0 for none.

    Raises
    ------
    ModelError
        If a value is no finite number of 0 or more.

    Examples
    --------
    >>> residual = ResidualUncertainty(3e-4, 4e-4, 480, 0.5, 2.5, "blocked by time, 5 folds")
    >>> residual.of([0.0, 1.0]).tolist()
    [0.0003, 0.0005]
    """

    constant: float
    proportional: float = 0.0
    rows: int = 0
    low: float = 0.0
    high: float = 0.0
    scheme: str = ""
    step: float = 0.0

    def __post_init__(self) -> None:
        for name in ("constant", "proportional", "rows", "low", "high", "step"):
            if not 0.0 <= getattr(self, name) < np.inf:
                message = f"the residual uncertainty has {name} {getattr(self, name)}; give a number >= 0"
                raise ModelError(message)

    @classmethod
    def measured(
        cls,
        error: Column,
        distance: Column,
        known: Column | float,
        scheme: str,
        step: float = 0.0,
    ) -> "ResidualUncertainty | None":
        """From errors of corrected distances whose variance is known in part.

        The two parts have the largest likelihood of normal errors of the variance that this class and
        the known part add up to. Where readings are in whole steps, this is the likelihood of the steps
        that they are in. The error of rounding is then added (GUM F.2.2.1): the rows show all of it only
        where their distances and their noise spread over a step.

        Parameters
        ----------
        error : ndarray, shape (n,)
            Corrected distances less reference distances [m]; NaN is left out.
        distance : ndarray, shape (n,)
            [m].
        known : float or ndarray, shape (n,)
            Variance from the parameters [m^2].
        scheme : str
            How the rows were chosen.
        step : float
            Step of the distances from one reading to the next [m]; 0 for none.

        Returns
        -------
        ResidualUncertainty or None
            None without any error.

        Examples
        --------
        >>> distance = np.tile([0.5, 1.0, 2.0, 4.0], 500)
        >>> error = np.random.default_rng(1).normal(0.0, np.hypot(1e-3, 5e-4 * distance))
        >>> found = ResidualUncertainty.measured(error, distance, 0.0, "")
        >>> round(1e3 * found.constant, 1), round(1e3 * found.proportional, 1)
        (1.0, 0.5)
        >>> exact = ResidualUncertainty.measured(np.zeros(500), distance[:500], 0.0, "", step=0.01)
        >>> round(1e3 * exact.constant, 2)
        2.89
        """
        rows = np.isfinite(error) & np.isfinite(distance)
        if not rows.any():
            return None
        error, distance = error[rows], distance[rows]
        known = np.broadcast_to(known, rows.shape)[rows]
        variances = _of_steps(error, distance, known, step) if step else _of_values(error, distance, known)
        constant, proportional = (float(v**0.5) for v in variances)
        ends = float(distance.min()), float(distance.max())
        return cls(constant, proportional, len(error), *ends, scheme, float(step))

    def of(self, distance: ArrayLike) -> Column:
        """Standard uncertainty [m] at distances [m]."""
        return np.asarray(np.hypot(self.constant, self.proportional * np.asarray(distance, dtype=float)))

    def to_dict(self) -> dict[str, Any]:
        """As in a model file."""
        steps = {"step": self.step} if self.step else {}
        return {
            "constant": self.constant,
            "proportional": self.proportional,
            "rows": self.rows,
            "low": self.low,
            "high": self.high,
            "scheme": self.scheme,
            **steps,
            "unit": "m",
        }


def _of_values(error: Column, distance: Column, known: Column) -> tuple[float, float]:
    """Variances of both parts, of errors that are not rounded."""
    limits = np.quantile(distance, np.linspace(0.0, 1.0, _CLASSES + 1)[1:-1])
    classes = np.searchsorted(limits, distance)
    count = np.bincount(classes).astype(np.float64)
    present = count > 0
    count = count[present]
    mean, square, given = (
        np.bincount(classes, values)[present] / count for values in (error**2, distance**2, known)
    )
    return _parts(count, mean, square, given)


def _of_steps(error: Column, distance: Column, known: Column, step: float) -> tuple[float, float]:
    """Variances of both parts, of errors in steps: rounding is part of the constant one."""
    from scipy.special import log_ndtr  # takes long to import

    half, size, square = 0.5 * step, np.abs(error), distance**2

    def cost(variance: Column) -> tuple[float, Column]:
        scale = np.sqrt(variance)
        near, far = (size - half) / scale, (size + half) / scale
        inside, outside = log_ndtr(-near), log_ndtr(-far)
        log = inside + np.log1p(-np.exp(outside - inside))
        below, above = (np.exp(-0.5 * (z**2 + np.log(2.0 * np.pi)) - log) * z for z in (near, far))
        return -float(log.mean()), -(below - above) / (2.0 * variance * len(size))

    whole = float(np.mean(error**2)) + step**2 / 12.0
    constant, proportional = _largest(cost, known + _FINEST, square, whole, float(square.mean()))
    return constant + step**2 / 12.0, proportional


def _parts(count: Column, mean: Column, square: Column, known: Column) -> tuple[float, float]:
    """Variance [m^2] of the constant part, and that of the other part over the squared distance."""
    whole, far = float(np.average(mean, weights=count)), float(np.average(square, weights=count))
    if whole == 0.0 or far == 0.0:
        return whole, 0.0
    weight = count / count.sum()

    def cost(variance: Column) -> tuple[float, Column]:
        slope = weight * (1.0 - mean / variance) / variance
        return float(weight @ (np.log(variance / whole) + mean / variance)), slope

    return _largest(cost, known + 1e-12 * whole, square, whole, far)


def _largest(
    cost: Callable[[Column], tuple[float, Column]], known: Column, square: Column, whole: float, far: float
) -> tuple[float, float]:
    """Variances of both parts that make the cost of all variances, and its slopes, the least."""
    from scipy.optimize import minimize  # takes long to import

    columns = np.stack([np.full(len(square), whole), whole * square / far])

    def of(parts: Column) -> tuple[float, Column]:
        value, slopes = cost(known + parts @ columns)
        return value, columns @ slopes

    if np.ptp(square) <= 1e-6 * far:  # one distance tells the two parts not apart
        columns = columns[:1]
    start = np.full(len(columns), 1.0 / len(columns))
    found = minimize(of, start, jac=True, method="L-BFGS-B", bounds=[(0.0, None)] * len(columns)).x
    constant, proportional = (*found, 0.0)[:2]
    return float(constant) * whole, float(proportional) * whole / far
