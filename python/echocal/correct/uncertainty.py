"""Standard uncertainty of corrected distances: law of propagation of uncertainty (JCGM 100:2008, 5.1.2)."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from echocal.correct.results import UNCERTAINTY
from echocal.errors import DomainWarning, UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.shape import is_extra
from echocal.observations import Observations
from echocal.observations.correction import base_indication, corrected_distance
from echocal.observations.units import NAMES
from echocal.quantities import DEFAULTS, FROM_THERMOMETERS, QUANTITIES

__all__ = ["Uncertainties", "included", "standard_uncertainty"]

Column = NDArray[np.float64]

_ECHOES = ("echo_time", "reading")


@dataclass(frozen=True)
class Uncertainties:
    """Standard uncertainties that the user states for recorded or assumed values.

    Attributes
    ----------
    stated : mapping of str to float
        By name of the quantity, or ``echo_time`` [s] or ``reading`` [m]; in SI units, temperatures in K.
        They are independent of each other and of the parameters of the model.
    """

    stated: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, texts: Sequence[str] | Mapping[str, float]) -> "Uncertainties":
        """From texts such as ``temperature_C=0.5``, or the same as a mapping.

        Raises
        ------
        UsageError
            If a name or a number cannot be understood.

        Examples
        --------
        >>> Uncertainties.of(["temperature_F=0.9", "reading_mm=3"]).stated
        {'temperature': 0.5, 'reading': 0.003}
        """
        pairs = texts.items() if isinstance(texts, Mapping) else [_pair(text) for text in texts]
        stated: dict[str, float] = {}
        for name, value in pairs:
            if name not in NAMES or NAMES[name][0].label or NAMES[name][0].quantity == "reference_distance":
                known = among(name, [own for own, (form, _) in NAMES.items() if not form.label], "there are")
                message = f"{keyword('uncertainties', {name: value})} names no quantity with its unit{known}"
                raise UsageError(message)
            form, symbol = NAMES[name]
            unit = form.units[symbol]
            size = float(value) * unit.numerator / unit.denominator
            if not 0.0 <= size < np.inf:
                stating = keyword("uncertainties", {name: value})
                message = f"{stating} is no standard uncertainty; give a number >= 0"
                raise UsageError(message)
            if form.quantity in stated:
                twice = form.quantity.replace("_", " ")
                message = f"{keyword('uncertainties')} states {twice} twice; state it once"
                raise UsageError(message)
            stated[form.quantity] = size
        return cls(stated)


def standard_uncertainty(
    observations: Observations, model: Model, distance: Column, uncertainties: Uncertainties
) -> Column:
    """Standard uncertainty [m] of corrected distances, shape (n,).

    It has that of the model (`echocal.Model.standard_uncertainty`), and what the user states for the echo
    time or the reading and for the influence quantities. For an influence quantity it is half the change
    of the distance between one standard uncertainty above and below (JCGM 100:2008, 5.1.3, note 2), at
    the recorded echo time.

    Returns
    -------
    ndarray, shape (n,)
        NaN where there is no distance, and everywhere if no uncertainty is known.
    """
    stated = {name: size for name, size in uncertainties.stated.items() if size}
    if not np.isfinite(distance).any():
        return np.full(len(distance), np.nan)
    given = {**observations.conditions, **observations.bound(model.columns)}
    if model.shape is not None:
        given |= {name: observations.extra[name] for name in model.shape.columns if is_extra(name)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DomainWarning)  # told when the distances were computed
        own = model.standard_uncertainty(distance, **given)
        if not uncertainties.stated:
            return own
        variance = np.where(np.isnan(distance), np.nan, np.nan_to_num(own) ** 2)
        if any(name in stated for name in _ECHOES):
            variance += _of_echo(observations, model, distance, stated, given)
        for name in stated:
            for quantity in _quantities(name, model):
                variance += _of_quantity(observations, model, quantity, stated[name]) ** 2
    return np.sqrt(variance)


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
    if not parts:
        return ""
    text = f"{UNCERTAINTY} includes {', '.join(parts)}"
    if model.residual_uncertainty is None:
        text += "; the model does not state the repeatability of a reading, so the uncertainty is without it"
    return text


def _of_echo(
    observations: Observations,
    model: Model,
    distance: Column,
    stated: Mapping[str, float],
    given: Mapping[str, Column],
) -> Column:
    """Variance [m^2] from the stated uncertainty of the echo time or the reading."""
    bare = {name: values for name, values in given.items() if not is_extra(name)}
    slope = model.without_shape().jacobian(distance, **bare)[:, 0]
    indication = base_indication(observations, model.law)
    if observations.reading is not None and "reading" in stated:
        relative = stated["reading"] / observations.reading
    else:
        relative = stated.get("echo_time", 0.0) / observations.echo_time
    return np.asarray((indication * relative / slope) ** 2)


def _of_quantity(observations: Observations, model: Model, quantity: str, size: float) -> Column:
    """Half the change of the distance [m] between one standard uncertainty above and below."""
    columns = model.columns
    recorded = observations.conditions.get(quantity)
    if quantity in columns:
        recorded = observations.thermometers[columns[quantity]]
    if recorded is None:
        value = model.air.get(quantity, DEFAULTS.get(quantity))
        if value is None:
            return np.zeros(len(observations))
        recorded = np.full(len(observations), value)
    low, high = QUANTITIES[quantity].possible
    above, below = np.minimum(recorded + size, high), np.maximum(recorded - size, low)
    far, near = (
        corrected_distance(_with(observations, columns, quantity, it), model) for it in (above, below)
    )
    return np.asarray((far - near) * (size / (above - below)))


def _with(
    observations: Observations, columns: Mapping[str, str], quantity: str, values: Column
) -> Observations:
    if quantity in columns:
        return replace(observations, thermometers={**observations.thermometers, columns[quantity]: values})
    return replace(observations, conditions={**observations.conditions, quantity: values})


def _quantities(name: str, model: Model) -> list[str]:
    """Influence quantities that a stated uncertainty belongs to, if the model reads them."""
    if name in _ECHOES:
        return []
    names = FROM_THERMOMETERS if name == "thermometer" else (name,)
    return [quantity for quantity in names if quantity in model.reads]


def _pair(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        message = f"{keyword('uncertainties', [text])} is not of the form NAME=VALUE; e.g. temperature_C=0.5"
        raise UsageError(message) from None
