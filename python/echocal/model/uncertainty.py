"""Standard uncertainty of the distances that a model corrects."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, DomainWarning
from echocal.model import added
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape, Smooth

Values = NDArray[np.float64]

_STATED_AT = (0.5, 1.0, 2.0, 4.0)  # m: where the files of a device state the uncertainty of a distance
_REFERENCE_TEMPERATURE = 20.0  # degC; ISO 1:2022


class _Uncertain(Protocol):
    """What a model knows of its uncertainty."""

    air: Mapping[str, float]
    covariance: Values | None
    shape: Shape | Smooth | None
    residual_uncertainty: ResidualUncertainty | None

    def without_shape(self) -> Self: ...
    def jacobian(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values: ...


@dataclass(frozen=True)
class Parts:
    """Parts of the standard uncertainty of corrected distances."""

    sensitivities: Values | None
    """Change of a distance with each parameter [m per unit]; None where the parameters are not uncertain;
    shape (..., n)."""
    covariance: Values | None
    """Of the parameters; shape (n, n)."""
    shape: Values
    """Standard uncertainty from an unexplained term or a smooth correction [m]."""
    residual: Values
    """That of the repeatability and of what the model leaves unexplained [m]."""

    @property
    def variance(self) -> Values:
        """Square of the combined standard uncertainty [m^2]."""
        found: Any = self.shape**2 + self.residual**2
        if self.sensitivities is not None:
            g: Any = self.sensitivities
            found = found + np.einsum("...i,ij,...j->...", g, np.asarray(self.covariance), g)
        return np.asarray(found)


def standard_uncertainty(
    model: _Uncertain, distance: ArrayLike, conditions: Mapping[str, ArrayLike | None]
) -> Values:
    """Return the standard uncertainty of corrected distances [m].

    It has the covariance of the parameters (law of propagation of uncertainty, JCGM 100:2008, 5.1.2, with
    exact derivatives), the standard uncertainty of an unexplained term or a smooth correction, and the
    residual uncertainty. It has nothing of the uncertainty of the recorded conditions, as far as the
    residual uncertainty does not show it.

    Parameters
    ----------
    distance : array_like
        Corrected distances [m].
    conditions : mapping of str to array_like
        As for `Model.correct`.

    Returns
    -------
    ndarray
        In the shape of the arguments. NaN where there is no distance, and everywhere if the model states no
        uncertainty.

    Examples
    --------
    >>> from echocal.model import Model, ResidualUncertainty
    >>> residual = ResidualUncertainty(1e-3)
    >>> late = {"fixed_delay": {"delay": 30e-6}}
    >>> model = Model("linear", late, covariance=[[4e-12]], residual_uncertainty=residual)
    >>> model.standard_uncertainty([1.0, 2.0], temperature=20.0).round(6).tolist()
    [0.001057, 0.001057]
    """
    distance = np.asarray(distance, dtype=np.float64)
    found = parts(model, distance, conditions)
    if found is None:
        return np.full(distance.shape, np.nan)
    return np.sqrt(np.where(np.isnan(distance), np.nan, found.variance))


def parts(model: _Uncertain, distance: ArrayLike, conditions: Mapping[str, ArrayLike | None]) -> Parts | None:
    """Return what the standard uncertainty of corrected distances is made of; None if none is stated."""
    distance = np.asarray(distance, dtype=np.float64)
    if model.covariance is None and model.residual_uncertainty is None and model.shape is None:
        return None
    residual: Any = (
        0.0 if model.residual_uncertainty is None else model.residual_uncertainty.of(distance) ** 2
    )
    if model.shape is None and (model.covariance is None or not model.covariance.any()):
        return Parts(None, None, np.zeros(()), np.sqrt(residual))
    jacobian = model.without_shape().jacobian(distance, **added.others(model.shape, conditions))
    slope = jacobian[..., 0]
    shape: Any = 0.0
    if model.shape is not None:
        shape, residual = added.variance(model.shape, model.air, distance, conditions, residual)
    sensitivities = None if model.covariance is None else -jacobian[..., 1:] / slope[..., np.newaxis]
    return Parts(sensitivities, model.covariance, np.sqrt(shape) / np.abs(slope), np.sqrt(residual))


def stated(model: _Uncertain, air: Mapping[str, float], longest: float) -> list[tuple[float, float]]:
    """Distances up to the longest [m] and their standard uncertainties [m], at 20 degC.

    None where the model states no uncertainty, or asks for a condition that `air` does not have.
    """
    at = [distance for distance in _STATED_AT if distance <= longest]
    try:
        with warnings.catch_warnings(action="ignore", category=DomainWarning):  # told of the code ranges
            sizes = standard_uncertainty(model, at, {**air, "temperature": _REFERENCE_TEMPERATURE})
    except DataError:
        return []
    return [(a, float(f"{u:.6g}")) for a, u in zip(at, sizes.tolist(), strict=True) if np.isfinite(u)]
