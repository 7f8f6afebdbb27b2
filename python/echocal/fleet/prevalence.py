"""How common each cause is among sensors of a kind, and what that says of each: method.md, section 11."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.faults import registry as faults
from echocal.diagnose.noises import registry as noises
from echocal.diagnose.settings import Settings

__all__ = ["Prevalence", "prevalence"]

Column = NDArray[np.float64]
Ids = tuple[str, ...]


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
        Of each sensor, given the fleet: sets of causes and their probabilities.
    """

    share: Mapping[str, float]
    uncertainty: Mapping[str, float]
    prior: Mapping[str, float]
    posteriors: list[list[tuple[Ids, float]]]

    def probability(self, place: int, causes: Sequence[str]) -> float:
        """Probability that a sensor has at least one of these causes, given the fleet."""
        return sum(p for ids, p in self.posteriors[place] if not set(causes).isdisjoint(ids))


@dataclass(frozen=True)
class _Sets:
    """The sets of all sensors, one after the other."""

    causes: list[str]
    member: Any
    """Sparse, sets by causes: 1 where a set has a cause."""
    weighing: Any
    """Sparse, sets by causes and classes: a cause that a sensor cannot separate counts as its class."""
    classes: list[list[int]]
    """Causes of each class, by their places."""
    may: Any
    """Sparse, sensors by causes: 1 where a cause competes."""
    log_likelihood: Column
    """Posterior divided by prior: docs/method.md, Eq. 57."""
    start: NDArray[np.intp]
    """First set of each sensor, and the number of all."""
    prior: Column


def prevalence(sensors: Sequence[Mapping[str, Any]], settings: Settings) -> Prevalence:
    """Estimate how common each cause is among sensors of a kind, and weigh each sensor's posterior again.

    Parameters
    ----------
    sensors : sequence of mapping
        Records with ``posterior``, ``competing`` and ``terms``.
    settings : Settings

    Returns
    -------
    Prevalence
    """
    sets = _sets(sensors, settings)
    weight = settings.fleet.prior_sensors
    competing = np.asarray(sets.may.sum(axis=0)).ravel()
    share = sets.prior.copy()
    posterior = _weighed(sets, share)
    for _ in range(settings.fleet.rounds):
        before = share
        expected = sets.member.T @ posterior
        share = (expected + weight * sets.prior) / (competing + weight)
        posterior = _weighed(sets, share)
        if np.max(np.abs(share - before), initial=0.0) < settings.fleet.settled:
            break
    deviation = _uncertainty(sets, share, posterior, weight)
    names = sets.causes
    ends = sets.start
    listed = [
        [
            (tuple(ids), float(p))
            for (ids, _), p in zip(one["posterior"], posterior[a:b].tolist(), strict=True)
        ]
        for one, a, b in zip(sensors, ends[:-1], ends[1:], strict=True)
    ]
    return Prevalence(
        dict(zip(names, share.tolist(), strict=True)),
        dict(zip(names, deviation.tolist(), strict=True)),
        dict(zip(names, sets.prior.tolist(), strict=True)),
        listed,
    )


def _weighed(sets: _Sets, share: Column) -> Column:
    """Posterior of each set under these prevalences: docs/method.md, Eq. 58 and 59."""
    odds = share / (1 - share)
    of_classes = [float(np.mean(odds[members])) for members in sets.classes]
    log: Column = sets.log_likelihood + sets.weighing @ np.log([*odds, *of_classes])
    counts = np.diff(sets.start)
    if not len(log):
        return sets.log_likelihood
    highest = np.maximum.reduceat(log, sets.start[:-1])
    weights = np.exp(log - np.repeat(highest, counts))
    whole: Column = weights / np.repeat(np.add.reduceat(weights, sets.start[:-1]), counts)
    return whole


def _uncertainty(sets: _Sets, share: Column, posterior: Column, weight: float) -> Column:
    """From the scores of the sensors, and that of the prior: docs/method.md, Eq. 61."""
    sensor = np.repeat(np.arange(len(sets.start) - 1), np.diff(sets.start))
    have = csr_array(
        (posterior, (sensor, np.arange(len(posterior)))), shape=(len(sets.start) - 1, len(posterior))
    )
    probability = have @ sets.member
    variance = share * (1 - share)
    # the sum over sensors of (P - share)^2 where the cause competes, without a dense table
    squares = np.asarray(probability.multiply(probability).sum(axis=0)).ravel()
    sums = np.asarray(probability.sum(axis=0)).ravel()
    competing = np.asarray(sets.may.sum(axis=0)).ravel()
    spread = squares - 2 * share * sums + share**2 * competing
    information = np.maximum(spread, 0.0) / variance**2 + weight / variance
    result: Column = 1.0 / np.sqrt(information)
    return result


def _sets(sensors: Sequence[Mapping[str, Any]], settings: Settings) -> _Sets:
    others = _independent(settings)
    effects = sorted({c for one in sensors for c in one["competing"]})
    found = {id_ for one in sensors for ids, _ in one["posterior"] for id_ in ids}
    causes = [*effects, *sorted((found | {UNKNOWN}) - set(effects))]
    place = {cause: n for n, cause in enumerate(causes)}
    prior_sum, prior_count = np.zeros(len(causes)), np.zeros(len(causes))
    rows: list[int] = []
    cols: list[int] = []
    may_rows: list[int] = []
    may_cols: list[int] = []
    log: list[float] = []
    start = [0]
    classes: dict[Ids, int] = {}
    weighing: list[int] = []
    for number, one in enumerate(sensors):
        competing = set(one["competing"])
        of_count = _log_prior_of_sets(len(competing), settings)
        mean = _mean_prior(len(competing), settings)
        able = [*competing, *(c for c in causes[len(effects) :] if c != UNKNOWN or one["terms"])]
        for cause in able:
            may_rows.append(number)
            may_cols.append(place[cause])
            prior_sum[place[cause]] += others.get(cause, mean)
            prior_count[place[cause]] += 1
        tied = _tied(one, classes, len(causes))
        for ids, p in one["posterior"]:
            known = [others[i] for i in ids if i in others]
            prior = of_count[len(ids) - len(known)] + sum(np.log(q) - np.log1p(-q) for q in known)
            cols += [place[i] for i in ids]
            weighing += [tied.get(i, place[i]) for i in ids]
            rows += [len(log)] * len(ids)
            log.append(np.log(p) - prior)
        start.append(len(log))
    ones = np.ones(len(cols))
    member = csr_array((ones, (rows, cols)), shape=(len(log), len(causes)))
    may = csr_array((np.ones(len(may_cols)), (may_rows, may_cols)), shape=(len(sensors), len(causes)))
    members = [[place[cause] for cause in ids] for ids in classes]
    counted = csr_array((ones, (rows, weighing)), shape=(len(log), len(causes) + len(classes)))
    prior = prior_sum / np.maximum(prior_count, 1)
    return _Sets(causes, member, counted, members, may, np.array(log), np.array(start), prior)


def _tied(sensor: Mapping[str, Any], classes: dict[Ids, int], first: int) -> dict[str, int]:
    """Column of the class of each cause that the data of a sensor cannot separate from a claim."""
    tied: dict[str, int] = {}
    able = {cause for ids, _ in sensor["posterior"] for cause in ids}
    for claim in sensor["causes"]:
        ids = tuple(sorted({claim["id"], *claim["indistinguishable_from"]} & able - set(tied)))
        if len(ids) > 1:
            tied |= dict.fromkeys(ids, first + classes.setdefault(ids, len(classes)))
    return tied


def _independent(settings: Settings) -> dict[str, float]:
    """Causes with a prior probability of their own: terms, noises and faults."""
    found = {UNKNOWN: settings.priors.unexplained_term}
    found |= {noise.facts.id: settings.noises.prior(noise.facts) for noise in noises.NOISES}
    return found | {fault.facts.id: settings.faults.prior(fault.facts) for fault in faults.FAULTS}


def _counts(competing: int, settings: Settings) -> list[float]:
    """Prior of each number of effects: docs/method.md, Eq. 7."""
    given = settings.priors.counts
    counts = [*given, *(given[-1] * 0.1**n for n in range(1, max(competing + 2 - len(given), 1)))]
    return counts[: competing + 1]


def _log_prior_of_sets(competing: int, settings: Settings) -> list[float]:
    """Log prior of one set of so many effects: docs/method.md, Eq. 8, without forms and terms."""
    counts = _counts(competing, settings)
    return [float(np.log(p) - np.log(comb(competing, k))) for k, p in enumerate(counts)]


def _mean_prior(competing: int, settings: Settings) -> float:
    """Prior that one given effect acts, whatever else does."""
    counts = _counts(competing, settings)
    return sum(k * p for k, p in enumerate(counts)) / sum(counts) / max(competing, 1)
