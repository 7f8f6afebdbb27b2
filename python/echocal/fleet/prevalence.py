"""How common each cause is among sensors of a kind, and what that says of each.

docs/method/several-tables.md, section 12.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.settings import Settings
from echocal.fleet.sets import Sets, sets_of

__all__ = ["Prevalence", "prevalence"]

Column = NDArray[np.float64]
Ids = tuple[str, ...]

_ROUNDS = 2000  # of the expectation maximization
_SETTLED = 1e-6  # change of a prevalence: one sensor in a million


@dataclass(frozen=True)
class Prevalence:
    """Causes of a kind of sensors.

    Attributes
    ----------
    share : mapping of str to float
        Part of the sensors that have a cause, among those where it competes.
    uncertainty : mapping of str to float
        Standard uncertainty of it.
    prior : mapping of str to float
        What it is without the fleet.
    posteriors : list of list of (tuple of str, float)
        Of each sensor, given the others: sets of causes and their probabilities.
    """

    share: Mapping[str, float]
    uncertainty: Mapping[str, float]
    prior: Mapping[str, float]
    posteriors: list[list[tuple[Ids, float]]]

    def probability(self, place: int, causes: Sequence[str]) -> float:
        """Probability that a sensor has at least one of these causes, given the others."""
        return sum(p for ids, p in self.posteriors[place] if not set(causes).isdisjoint(ids))


def prevalence(sensors: Sequence[Mapping[str, Any]], settings: Settings) -> Prevalence:
    """Estimate how common each cause is among sensors of a kind, and weigh each sensor's posterior again.

    Parameters
    ----------
    sensors : sequence of mapping
        Records with ``posterior``, ``causes``, ``competing`` and ``terms``.
    settings : Settings

    Returns
    -------
    Prevalence
    """
    sets = sets_of(sensors, settings)
    weight = settings.fleet.prior_sensors
    number = sets.competes.sum(axis=0)
    share = sets.prior
    posterior = sets.posterior(np.tile(share, (len(sensors), 1)))
    for _ in range(_ROUNDS):
        before = share
        probability = sets.probabilities(posterior)
        share = _share(probability.sum(axis=0), number, sets.prior, weight)
        # of each sensor from the others alone: else it would count twice (Eq. 58)
        others = _share(probability.sum(axis=0) - probability, number - sets.competes, sets.prior, weight)
        posterior = sets.posterior(others)
        if np.max(np.abs(share - before), initial=0.0) < _SETTLED:
            break
    deviation = _uncertainty(sets, share, sets.probabilities(posterior), weight)
    ends = zip(sets.start[:-1], sets.start[1:], strict=True)
    listed = [
        [(tuple(ids), p) for (ids, _), p in zip(one["posterior"], posterior[a:b].tolist(), strict=True)]
        for one, (a, b) in zip(sensors, ends, strict=True)
    ]

    def named(values: Column) -> dict[str, float]:
        return dict(zip(sets.causes, values.tolist(), strict=True))

    return Prevalence(named(share), named(deviation), named(sets.prior), listed)


def _share(expected: Any, number: Any, prior: Column, weight: float) -> Column:
    """Prevalence of causes that so many sensors are expected to have.

    docs/method/several-tables.md, Eq. 60.
    """
    share: Column = (np.maximum(expected, 0.0) + weight * prior) / (number + weight)
    return share


def _uncertainty(sets: Sets, share: Column, probability: Column, weight: float) -> Column:
    """From the scores of the sensors, and from the prior: docs/method/several-tables.md, Eq. 61."""
    variance = share * (1 - share)
    scores = np.where(sets.competes, (probability - share) / variance, 0.0)
    result: Column = 1.0 / np.sqrt((scores**2).sum(axis=0) + (weight + 1) / variance)
    return result
