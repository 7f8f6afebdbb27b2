"""Standard uncertainty of corrected distances: what the budget of `echocal.budget` combines to."""

import numpy as np

from echocal.arrays import Column
from echocal.budget.entries import itemized
from echocal.budget.stated import Uncertainties
from echocal.correct.results import UNCERTAINTY
from echocal.model import Model
from echocal.observations import Observations


def standard_uncertainty(
    observations: Observations, model: Model, distance: Column, uncertainties: Uncertainties
) -> Column:
    """Standard uncertainty [m] of corrected distances, shape (n,).

    It combines what the model states (`echocal.Model.standard_uncertainty`) and what the user states; see
    `echocal.budget.entries.itemized`. NaN where there is no distance, and everywhere if no uncertainty is
    known.
    """
    stated = uncertainties or model.covariance is not None or model.shape is not None
    if not np.isfinite(distance).any() or not (stated or model.residual_uncertainty is not None):
        return np.full(len(distance), np.nan)
    found = itemized(observations, model, distance, uncertainties)
    combined = found.standard_uncertainty if found.entries else np.zeros(len(distance))
    return np.where(np.isnan(distance), np.nan, combined)


def included(model: Model, uncertainties: Uncertainties) -> str:
    """Say what the standard uncertainty of a corrected distance includes; empty if none is known."""
    parts = []
    if model.covariance is not None and model.covariance.any():
        parts.append("the fitted parameters")
    if model.residual_uncertainty is not None:
        parts.append("the repeatability and what the model leaves unexplained (residual_uncertainty)")
    if model.shape is not None:
        parts.append("the terms without a cause")
    parts += [f"the stated uncertainty of {name.replace('_', ' ')}" for name in uncertainties.stated]
    parts += [f"the {name.partition('_')[0]} {value}" for name, value in uncertainties.instruments.items()]
    if not parts:
        return ""
    text = f"{UNCERTAINTY} includes {', '.join(parts)}"
    if model.residual_uncertainty is None:
        text += "; the model does not state the repeatability of a reading, so the uncertainty is without it"
    return text
