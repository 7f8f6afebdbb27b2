"""The one computation of the uncertainty of corrected distances: a contribution for each source.

Law of propagation of uncertainty, JCGM 100:2008, 5.1.2 and 5.2.2; effective degrees of freedom, G.4.1.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal._core import speed_of_sound
from echocal.arrays import Column
from echocal.budget.sources import ECHOES, LAW, TAPE, Source, of_law
from echocal.budget.stated import Uncertainties
from echocal.errors import DataError, DomainWarning
from echocal.model import Model
from echocal.model.indicated_speed import indication_law
from echocal.model.shape import is_extra
from echocal.model.uncertainty import parts
from echocal.observations import Observations
from echocal.observations.correction import base_indication, corrected_distance
from echocal.quantities import DEFAULTS, FROM_THERMOMETERS, QUANTITIES
from echocal.registry import find_effect

_CRAMER = 300e-6
"""Cramer 1993, doi:10.1121/1.405827: 300 ppm."""
_VIRIAL = 110e-6
"""Of `virial` up to a mole fraction of water of 0.06: 43 ppm from two formulations of moist air, and these
65 ppm from each other (docs/physics.md)."""
_HUMIDITIES = (0.0, 0.5, 1.0)
"""Where none is recorded."""
_CARRIER = 40e3  # Hz
_READ = ("temperature", "pressure", "co2_mole_fraction")


@dataclass(frozen=True)
class Entry:
    """A line of a budget."""

    quantity: str  # input quantity
    words: str  # source, as a person reads it
    evaluation: str  # type ``A`` or ``B`` (JCGM 100:2008, 4.2 and 4.3)
    distribution: str  # ``normal``, ``t`` or ``rectangular``
    standard_uncertainty: Column  # of the input quantity [`unit`]; shape (n,)
    unit: str
    sensitivity: Column  # change of the distance with the quantity [m per unit]; shape (n,)
    degrees_of_freedom: float = inf
    group: str = "stated"  # ``parameters``, ``shape``, ``residual`` or ``stated``
    origin: str = ""  # where the number is from

    @property
    def contribution(self) -> Column:
        """Standard uncertainty times sensitivity coefficient, with its sign, shape (n,) [m]."""
        return np.asarray(self.sensitivity * self.standard_uncertainty)


@dataclass(frozen=True)
class Itemized:
    """Entries of a budget; those of the group ``parameters`` come first and are correlated.

    Examples
    --------
    >>> one = np.ones(1)
    >>> first = Entry("a", "a", "A", "t", 3.0 * one, "m", one, 9.0)
    >>> both = Itemized((first, Entry("b", "b", "B", "normal", 4.0 * one, "m", one)))
    >>> both.standard_uncertainty.item(), round(both.degrees_of_freedom.item(), 2)
    (5.0, 69.44)
    >>> both.shares[0].round(2).tolist()
    [0.36, 0.64]
    """

    entries: tuple[Entry, ...]
    correlation: Column | None = None

    @property
    def contributions(self) -> Column:
        """Shape (n, number of entries) [m]."""
        return np.stack([entry.contribution for entry in self.entries], axis=-1)

    @property
    def products(self) -> Column:
        """Part of each entry in the variance, with its correlations, shape (n, number of entries) [m^2]."""
        own = self.contributions
        found = own**2
        if self.correlation is not None:
            count = len(self.correlation)
            found[:, :count] = own[:, :count] * (own[:, :count] @ self.correlation)
        return np.asarray(found)

    @property
    def standard_uncertainty(self) -> Column:
        """Combined standard uncertainty, shape (n,) [m]."""
        return np.asarray(np.sqrt(np.maximum(self.products.sum(axis=-1), 0.0)))

    @property
    def shares(self) -> Column:
        """Part of each entry in the variance; they add up to 1, and a correlated one may be negative.

        All are 0 where no entry is uncertain.
        """
        found = self.products
        total = found.sum(axis=-1, keepdims=True)
        return np.asarray(found / np.where(total == 0.0, 1.0, total))

    @property
    def degrees_of_freedom(self) -> Column:
        """Effective ones after Welch and Satterthwaite, shape (n,).

        Correlated entries have theirs together: they come from one fit.
        """
        products = self.products
        count = 0 if self.correlation is None else len(self.correlation)
        groups = [products[:, :count].sum(axis=-1)] if count else []
        degrees = [entry.degrees_of_freedom for entry in self.entries[:count][:1]]
        groups += [products[:, i] for i in range(count, len(self.entries))]
        degrees += [entry.degrees_of_freedom for entry in self.entries[count:]]
        below = sum((own**2 / nu for own, nu in zip(groups, degrees, strict=True)), np.zeros(len(products)))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(below > 0.0, products.sum(axis=-1) ** 2 / below, inf)

    def refuse_unknown(self, distance: Column) -> None:
        """Refuse rows with a distance where the size of a source is not known.

        Raises `DataError` with the source, the number of rows and the first of them.
        """
        for entry in self.entries:
            lost = np.isfinite(distance) & np.isnan(entry.standard_uncertainty)
            if lost.any():
                quantity, first = entry.quantity.replace("_", " "), int(np.argmax(lost)) + 1
                raise DataError(
                    f"{entry.words}: the {quantity} is outside of the range that they are stated for in "
                    f"{int(lost.sum())} rows, first in row {first}; state it as a number"
                )

    def rows(self, places: NDArray[np.int64]) -> "Itemized":
        """The budgets of some rows."""
        kept = [
            replace(e, standard_uncertainty=e.standard_uncertainty[places], sensitivity=e.sensitivity[places])
            for e in self.entries
        ]
        return Itemized(tuple(kept), self.correlation)

    def only(self, *groups: str) -> "Itemized":
        """The entries of some groups."""
        kept = tuple(entry for entry in self.entries if entry.group in groups)
        return Itemized(kept, self.correlation if "parameters" in groups else None)


def conditions_of(observations: Observations, model: Model) -> dict[str, Column]:
    """What the rows say of the conditions that a model may ask for, with the columns of its terms."""
    given = {**observations.conditions, **observations.bound(model.columns)}
    if model.shape is not None:
        given |= {name: observations.extra[name] for name in model.shape.columns if is_extra(name)}
    return given


def itemized(
    observations: Observations, model: Model, distance: Column, uncertainties: Uncertainties
) -> Itemized:
    """Return the contribution of each source to the uncertainty of corrected distances.

    The model brings the covariance of its parameters, its unexplained term or smooth correction and its
    residual uncertainty. The user states the rest. The sensitivity to an influence quantity is half the
    change of the distance between one standard uncertainty above and below, divided by that uncertainty
    (JCGM 100:2008, 5.1.3, note 2), at the recorded echo time. `distance`, shape (n,), has the corrected
    distances of the n rows [m].
    """
    given = conditions_of(observations, model)
    with warnings.catch_warnings(action="ignore", category=DomainWarning):  # told with the distances
        own, correlation = _of_model(model, distance, given)
        sources: list[tuple[Source, Column | None]] = [(source, None) for source in uncertainties.sources]
        if "law" in uncertainties.instruments:
            sources.append(published(model, given, len(distance)))
        for source, half in sources:
            own += _of_source(observations, model, distance, given, source, half)
    return Itemized(tuple(own), correlation)


def _of_model(
    model: Model, distance: Column, given: Mapping[str, Column]
) -> tuple[list[Entry], Column | None]:
    found = parts(model, distance, given)
    if found is None:
        return [], None
    one = np.ones(len(distance))
    residual = model.residual_uncertainty
    sizes = model.standard_uncertainties
    uncertain = [i for i, name in enumerate(model.parameter_names) if sizes[name]]
    degrees = inf if residual is None or not residual.rows else max(residual.rows - len(uncertain), 1)
    entries, correlation = [], None
    if found.sensitivities is not None and uncertain:
        assert found.covariance is not None  # it has the sensitivities
        scale = np.sqrt(np.diag(found.covariance))[uncertain]
        correlation = found.covariance[np.ix_(uncertain, uncertain)] / np.multiply.outer(scale, scale)
        units = [p.unit for id_ in model.effects for p in find_effect(id_).parameters]
        entries = [
            Entry(
                model.parameter_names[i], model.parameter_names[i], "A", "t", size * one,
                units[i], found.sensitivities[:, i], degrees, "parameters", "covariance of the model",
            )
            for i, size in zip(uncertain, scale.tolist(), strict=True)
        ]  # fmt: skip
    if model.shape is not None:
        words = "term without a cause, or smooth correction"
        entries.append(
            Entry("shape", words, "A", "normal", found.shape * one, "m", one, inf, "shape", "model")
        )
    if residual is not None:
        words = "repeatability and unexplained remainder"
        origin = f"{residual.rows} rows, {residual.scheme}" if residual.rows else "model"
        size = found.residual * one
        entries.append(Entry("distance", words, "A", "t", size, "m", one, degrees, "residual", origin))
    return entries, correlation


def _of_source(
    observations: Observations,
    model: Model,
    distance: Column,
    given: Mapping[str, Column],
    source: Source,
    half: Column | None,
) -> list[Entry]:
    """Entries of a source: none where the model does not read its quantity."""

    def entry(quantity: str, size: Column, unit: str, sensitivity: Column) -> Entry:
        evaluation = "A" if np.isfinite(source.degrees_of_freedom) else "B"
        return Entry(
            quantity, source.words, evaluation, source.distribution, np.asarray(size), unit, sensitivity,
            source.degrees_of_freedom, "stated", source.origin,
        )  # fmt: skip

    if source.quantity in ECHOES:
        values, unit = observations.echo_time, "s"
        if observations.reading is not None and source.quantity == "reading":
            values, unit = observations.reading, "m"
        elif source.quantity == "reading":
            return []
        bare = {name: own for name, own in given.items() if not is_extra(name)}
        slope = model.without_shape().jacobian(distance, **bare)[:, 0]
        sensitivity = base_indication(observations, indication_law(model)) / values / slope
        size = _new(source, model, source.standard_uncertainty(values), sensitivity)
        return [entry(source.quantity, size, unit, sensitivity)]
    if source.quantity == TAPE:
        at = distance if observations.reference_distance is None else observations.reference_distance
        return [entry(TAPE, source.standard_uncertainty(at), "m", np.ones(len(distance)))]
    if source.quantity == LAW:
        size = source.standard_uncertainty(distance) if half is None else half / 3.0**0.5
        return [entry(LAW, size, "1", distance)]
    names = FROM_THERMOMETERS if source.quantity == "thermometer" else (source.quantity,)
    found = []
    for quantity in names:
        if quantity in model.reads:
            recorded = values_of(observations, model, quantity)
            if recorded is not None:
                size = source.standard_uncertainty(np.where(np.isnan(distance), np.nan, recorded))
                slope = _slope(observations, model, quantity, recorded, size)
                found.append(entry(quantity, size, QUANTITIES[quantity].unit, slope))
    return found


def _new(source: Source, model: Model, size: Column, sensitivity: Column) -> Column:
    """Standard uncertainty without the rounding that the repeatability of the model has already."""
    residual = model.residual_uncertainty
    if not source.rounding or residual is None or not residual.step:
        return size
    known = residual.step / 12**0.5 / np.abs(sensitivity)
    return np.asarray(np.sqrt(np.maximum(size**2 - known**2, 0.0)))


def values_of(observations: Observations, model: Model, quantity: str) -> Column | None:
    """Recorded or assumed values of a quantity, shape (n,); None where it has none."""
    if quantity in model.columns:
        return observations.thermometers[model.columns[quantity]]
    if quantity in observations.conditions:
        return observations.conditions[quantity]
    value = model.air.get(quantity, DEFAULTS.get(quantity))
    return None if value is None else np.full(len(observations), value)


def _slope(observations: Observations, model: Model, quantity: str, recorded: Column, size: Column) -> Column:
    """Change of the distance with a quantity, over one standard uncertainty to either side [m per unit]."""
    low, high = QUANTITIES[quantity].possible
    above, below = np.minimum(recorded + size, high), np.maximum(recorded - size, low)
    far, near = (
        corrected_distance(_with(observations, model.columns, quantity, it), model) for it in (above, below)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(above > below, (far - near) / (above - below), 0.0)


def _with(
    observations: Observations, columns: Mapping[str, str], quantity: str, values: Column
) -> Observations:
    if quantity in columns:
        return replace(observations, thermometers={**observations.thermometers, columns[quantity]: values})
    return replace(observations, conditions={**observations.conditions, quantity: values})


def published(model: Model, given: dict[str, Column], count: int) -> tuple[Source, Column]:
    """Source of a model's law, and its half-width relative to the speed of sound, shape (n,).

    For Cramer's law inside of its domain it is what its author states. For any other law it is the
    difference from `virial`, over the humidity that is recorded, else over every humidity, and the
    uncertainty of `virial` in addition. At 40 kHz sound is faster than the laws say, if the model has no
    `dispersion`: this is part of the difference.
    """
    air: dict[str, Any] = {name: given[name] for name in _READ if name in given}
    air = {**{name: own for name, own in model.air.items() if name in _READ}, **air}
    humid = given.get("relative_humidity", model.air.get("relative_humidity"))
    frequency = 0.0 if "dispersion" in model.effects else _CARRIER
    law = Model(model.law)
    worst = np.zeros(count)
    with warnings.catch_warnings(action="ignore", category=DomainWarning):
        for humidity in _HUMIDITIES if humid is None else (humid,):
            true = speed_of_sound(**air, relative_humidity=humidity, law="virial", frequency=frequency)
            assumed = given.get("relative_humidity", model.air.get("relative_humidity", 0.0))
            own = law.speed_of_sound(1.0, **air, relative_humidity=assumed)
            worst = np.maximum(worst, np.abs(np.asarray(own) / true - 1.0))
    half = worst + _VIRIAL
    words = "difference from virial at 40 kHz, and 110 ppm of virial itself"
    if model.law == "cramer":
        half = np.maximum(half, _CRAMER)
        words = f"Cramer 1993: 300 ppm, or where it is more, the {words}"
    law_words = "law of the speed of sound" + (", humidity not recorded" if humid is None else "")
    return replace(of_law(0.0, words), words=law_words), np.broadcast_to(half, (count,))


def some_rows(observations: Observations, places: NDArray[np.int64] | slice) -> Observations:
    """The observations of some rows."""

    def of(columns: Mapping[str, Any]) -> dict[str, Any]:
        return {name: values[places] for name, values in columns.items()}

    def optional(values: Any) -> Any:
        return None if values is None else values[places]

    return replace(
        observations,
        echo_time=observations.echo_time[places],
        conditions=of(observations.conditions),
        reference_distance=optional(observations.reference_distance),
        unusable=observations.unusable[places],
        reading=optional(observations.reading),
        time=optional(observations.time),
        labels=of(observations.labels),
        extra=of(observations.extra),
        thermometers=of(observations.thermometers),
    )
