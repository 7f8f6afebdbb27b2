"""Standard uncertainty of the distances that a model corrects."""

import warnings
from collections.abc import Mapping
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, DomainWarning
from echocal.model import added
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape
from echocal.model.smooth import Smooth

__all__ = ["standard_uncertainty", "stated"]

Values = NDArray[np.float64]

_STATED_AT = (0.5, 1.0, 2.0, 4.0)  # m: where the files of a device state the uncertainty of a distance
_REFERENCE_TEMPERATURE = 20.0  # degC; ISO 1:2022


class Uncertain(Protocol):
    """What a model knows of its uncertainty."""

    air: Mapping[str, float]
    covariance: Values | None
    shape: Shape | Smooth | None
    residual_uncertainty: ResidualUncertainty | None

    def without_shape(self) -> Self: ...
    def jacobian(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values: ...


def standard_uncertainty(
    model: Uncertain, distance: ArrayLike, conditions: Mapping[str, ArrayLike | None]
) -> Values:
    """Return the standard uncertainty of corrected distances [m].

    It has the covariance of the parameters (law of propagation of uncertainty, JCGM 100:2008, 5.1.2, with
    exact derivatives), the standard uncertainty of an unexplained term or a smooth correction, and the
    residual uncertainty. It has nothing of the uncertainty of the recorded conditions, as far as the
    residual uncertainty does not show it.

    Parameters
    ----------
    model : Model
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
    if model.covariance is None and model.residual_uncertainty is None and model.shape is None:
        return np.full(distance.shape, np.nan)
    residual: Any = (
        0.0 if model.residual_uncertainty is None else model.residual_uncertainty.of(distance) ** 2
    )
    if model.shape is None and (model.covariance is None or not model.covariance.any()):
        return np.sqrt(np.where(np.isnan(distance), np.nan, residual))
    jacobian = model.without_shape().jacobian(distance, **added.others(model.shape, conditions))
    variance: Any = 0.0
    if model.shape is not None:
        variance, residual = added.variance(model.shape, model.air, distance, conditions, residual)
    if model.covariance is not None:
        tangents = jacobian[..., 1:]
        variance = variance + np.einsum("...i,ij,...j->...", tangents, model.covariance, tangents)
    return np.asarray(np.sqrt(residual + variance / jacobian[..., 0] ** 2))


def stated(model: Uncertain, air: Mapping[str, float], longest: float) -> list[tuple[float, float]]:
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
