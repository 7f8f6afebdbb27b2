"""Propagation of distributions by a Monte Carlo method: JCGM 101:2008."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.budget.entries import Entry, Itemized, conditions_of, values_of
from echocal.budget.sources import ECHOES
from echocal.errors import DomainWarning, ModelError
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import QUANTITIES

Random = np.random.Generator

_AGAIN = 100  # times that parameters beyond their bounds are drawn again


@dataclass(frozen=True)
class MonteCarlo:
    """Distribution of each distance, as drawn."""

    trials: int
    mean: Column  # [m]; shape (n,)
    standard_uncertainty: Column  # standard deviation of the draws [m]; shape (n,)
    # low, high: ends of the probabilistically symmetric coverage interval [m]; shape (n,)
    low: Column
    high: Column
    drawn_again: int = 0  # draws of parameters that were beyond their bounds, and were replaced


def simulated(
    observations: Observations,
    model: Model,
    found: Itemized,
    trials: int,
    coverage: float,
    random: Random,
) -> MonteCarlo:
    """Draw every input quantity from its distribution, and compute the distances anew.

    The echo time, the influence quantities and the parameters go through the whole model. What a model or a
    tape adds to a distance (residual, term without a cause, law, tape) is added to it. `found` has the
    entries of the budget of these rows, and `coverage` is the probability of the interval.
    """
    drawn = {
        id(entry): _drawn(entry, trials, random) for entry in found.entries if entry.group != "parameters"
    }
    models, again = _models(model, found, trials, random)
    distance = _distances(
        observations, model, models, [e for e in found.entries if id(e) in drawn], drawn, trials
    )
    tail = 0.5 - 0.5 * coverage
    low, high = np.quantile(distance, [tail, 1.0 - tail], axis=0)
    spread = distance.std(axis=0, ddof=1)
    return MonteCarlo(trials, distance.mean(axis=0), spread, low, high, again)


def _drawn(entry: Entry, trials: int, random: Random) -> Column:
    """Deviations of a quantity, shape (trials, n)."""
    if entry.distribution == "rectangular":
        unit = random.uniform(-(3.0**0.5), 3.0**0.5, trials)
    elif np.isfinite(entry.degrees_of_freedom):
        unit = random.standard_t(entry.degrees_of_freedom, trials)
    else:
        unit = random.standard_normal(trials)
    return np.multiply.outer(unit, entry.standard_uncertainty)


def _models(model: Model, found: Itemized, trials: int, random: Random) -> tuple[Sequence[Model], int]:
    """A model for each trial; the same one where no parameter is uncertain."""
    own = [entry for entry in found.entries if entry.group == "parameters"]
    if not own:
        return [model], 0
    assert found.correlation is not None  # it comes with them
    scale = np.array([entry.standard_uncertainty[0] for entry in own])
    covariance = found.correlation * np.multiply.outer(scale, scale)
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    degrees = own[0].degrees_of_freedom

    def draw() -> Column:
        normal = root @ random.standard_normal(len(own))
        # 6.4.9.2 for several quantities of one fit: the multivariate t distribution
        wider = (degrees / random.chisquare(degrees)) ** 0.5 if np.isfinite(degrees) else 1.0
        return np.asarray(wider * normal)

    names, again, models = [entry.quantity for entry in own], 0, []
    for _ in range(trials):
        for attempt in range(_AGAIN):
            try:
                models.append(_moved(model, dict(zip(names, draw().tolist(), strict=True))))
            except ModelError:  # beyond the bounds of a parameter
                again += 1
                if attempt == _AGAIN - 1:
                    raise
            else:
                break
    return models, again


def _moved(model: Model, change: Mapping[str, float]) -> Model:
    effects = {
        id_: {name: value + change.get(f"{id_}.{name}", 0.0) for name, value in own.items()}
        for id_, own in model.effects.items()
    }
    return Model(model.law, effects, air=model.air, shape=model.shape, columns=model.given_columns)


def _distances(
    observations: Observations,
    model: Model,
    models: Sequence[Model],
    entries: Sequence[Entry],
    drawn: Mapping[int, Column],
    trials: int,
) -> Column:
    """Distances, shape (trials, n)."""
    rows = len(observations)
    recorded = conditions_of(observations, model)
    for quantity in {entry.quantity for entry in entries} & set(QUANTITIES):
        values = values_of(observations, model, quantity)
        assert values is not None  # else it has no entry
        recorded[quantity] = values
    echo = np.broadcast_to(observations.echo_time, (trials, rows))
    given = {name: np.broadcast_to(values, (trials, rows)) for name, values in recorded.items()}
    added = np.zeros((trials, rows))
    for entry in entries:
        deviation = drawn[id(entry)]
        if entry.quantity in QUANTITIES:
            low, high = QUANTITIES[entry.quantity].possible
            given[entry.quantity] = np.clip(given[entry.quantity] + deviation, low, high)
        elif entry.quantity in ECHOES:
            reading = observations.reading if entry.quantity == "reading" else None
            whole = observations.echo_time if reading is None else reading
            echo = echo + deviation / whole * observations.echo_time
        else:
            added = added + entry.sensitivity * deviation
    plain = {
        name: own for name, own in given.items() if name in observations.conditions or name in QUANTITIES
    }
    with warnings.catch_warnings(action="ignore", category=DomainWarning):
        indication = np.asarray(Model(model.law).distance(echo, **plain))
        if len(models) == 1:
            return np.asarray(models[0].correct(indication, **given)) + added
        found = np.empty((trials, rows))
        for i, own in enumerate(models):
            found[i] = own.correct(indication[i], **{name: values[i] for name, values in given.items()})
    return found + added
