"""Conformity of errors with a maximum permissible error, with a guard band: JCGM 106:2012."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.budget.coverage import COVERAGE, conformity_probability, coverage_factor, decided
from echocal.budget.entries import Entry, Itemized, itemized
from echocal.budget.sources import LAW, TAPE
from echocal.budget.stated import Uncertainties
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.at import uncertain
from echocal.observations.echoes import DEFAULT_SPEED
from echocal.quantities import FROM_THERMOMETERS


@dataclass(frozen=True)
class Conformity:
    """What a measurement decides about errors, one for each row."""

    error: Column  # measured errors [m]; 0 where there is no reference distance; shape (n,)
    standard_uncertainty: Column  # of these errors [m]; shape (n,)
    expanded_uncertainty: Column  # width of the guard band [m]; shape (n,)
    decision: NDArray[np.int64]  # place in `echocal.budget.coverage.DECISIONS`; shape (n,)
    probability: Column  # that the true error is within the bound; shape (n,)
    bound: float  # maximum permissible error [m]


def assessed(error: Column, itemized_error: Itemized, bound: float, coverage: float = COVERAGE) -> Conformity:
    """Decide about errors with the uncertainty of their own budget.

    Examples
    --------
    >>> found = assessed(np.array([1e-3, -4e-3]), Itemized(()), 3e-3)
    >>> found.decision.tolist(), found.probability.tolist()
    ([0, 2], [1.0, 0.0])
    """
    u, degrees = np.zeros(len(error)), np.full(len(error), np.inf)
    if itemized_error.entries:
        u, degrees = itemized_error.standard_uncertainty, itemized_error.degrees_of_freedom
    expanded = coverage_factor(degrees, coverage) * u
    probability = conformity_probability(error, u, degrees, bound)
    return Conformity(error, u, expanded, decided(error, expanded, bound), probability, bound)


def budget_of_errors(
    observations: Observations,
    model: Model | None,
    indication: Column,
    uncertainties: Any,
    law: str = "linear",
) -> Itemized:
    """Budget of errors of indication: only what is stated and the join of a reference.

    The device and its model are what is examined; without a model the indications [m] stay as they are.
    `law` turns echo times into indications, where the table has no readings and there is no model.
    """
    own = Uncertainties.with_conditions(uncertainties, uncertain(observations))
    bare = model is None and observations.reading is not None
    corrects = model or Model((observations.reading_speed or DEFAULT_SPEED) if bare else law)
    found = itemized(observations, corrects, indication, own).only("stated")
    found.refuse_unknown(indication)
    entries = found.entries
    if bare:  # nothing corrects the readings: the air does not matter
        entries = tuple(e for e in entries if e.quantity in (TAPE, "reading"))
    if joined := observations.reference_join_uncertainty:
        one = np.ones(len(indication))
        words = "reference distance, joined by time"
        entries += (Entry(TAPE, words, "B", "normal", joined * one, "m", one, origin="the other log"),)
    return Itemized(entries)


def without_effect(stated: Uncertainties, budget: Itemized) -> list[str]:
    """Quantities whose uncertainty is stated and is in no entry of a budget.

    Examples
    --------
    >>> without_effect(Uncertainties.of({"law": "published", "thermometer": "DHT22"}), Itemized(()))
    ['temperature', 'speed of sound']
    """
    counted = {entry.quantity for entry in budget.entries}
    named = [source.quantity for source in stated.sources]
    named += [LAW] if "law" in stated.instruments else []
    lost = [
        name
        for name in dict.fromkeys(named)
        if not counted & set(FROM_THERMOMETERS if name == "thermometer" else [name])
    ]
    return [name.replace("_", " ") for name in lost]
