"""How common each cause is among sensors of a kind, and what that says of each.

docs/method/several-tables.md, section 12.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.faults import registry as faults
from echocal.diagnose.noises import registry as noises
from echocal.diagnose.settings import Settings
from echocal.fleet.verdicts import FAILED

Ids = tuple[str, ...]

_ROUNDS = 2000  # of the expectation maximization
_SETTLED = 1e-6  # change of a prevalence: one sensor in a million
Places = NDArray[np.intp]


@dataclass(frozen=True)
class Sets:
    """The sets of causes of all sensors, one after the other. An entry is a cause in a set."""

    causes: list[str]
    classes: list[list[int]]
    """Causes that some sensor cannot separate, by their places."""
    start: Places
    """First set of each sensor, and the number of all; shape (sensors + 1,)."""
    log_likelihood: Column
    # entry_set, entry_sensor, entry_cause: set, sensor and cause of each entry
    """Posterior divided by prior: docs/method/several-tables.md, Eq. 57; shape (sets,)."""
    entry_set: Places
    entry_sensor: Places
    entry_cause: Places
    entry_weight: Places
    """Column whose odds an entry has: its cause, or, after the causes, its class."""
    competes: NDArray[np.bool_]
    """shape (sensors, causes)."""
    prior: Column
    """Prior probability of each cause, the mean of the sensors where it competes; shape (causes,)."""

    def probabilities(self, posterior: Column) -> Column:
        """Probability of each cause in each sensor, shape (sensors, causes)."""
        shape = self.competes.shape
        at = self.entry_sensor * shape[1] + self.entry_cause
        summed = np.bincount(at, posterior[self.entry_set], shape[0] * shape[1])
        return np.asarray(summed, dtype=np.float64).reshape(shape)

    def posterior(self, share: Column) -> Column:
        """Probability of each set if causes are so common, shape (sensors, causes).

        docs/method/several-tables.md, Eq. 59.

        Causes that a sensor cannot separate divide the odds of their class evenly there.
        """
        most = 1 - 0.5 / (len(share) + 1)  # of sensors, all have the class: the rule of Laplace
        log_odds = np.empty((len(share), len(self.causes) + len(self.classes)))
        log_odds[:, : len(self.causes)] = np.log(share) - np.log1p(-share)
        for place, members in enumerate(self.classes, start=len(self.causes)):
            whole = np.minimum(share[:, members].sum(axis=1), most)
            log_odds[:, place] = np.log(whole) - np.log1p(-whole) - np.log(len(members))
        own = log_odds[self.entry_sensor, self.entry_weight]
        log = self.log_likelihood + np.bincount(self.entry_set, own, len(self.log_likelihood))
        counts = np.diff(self.start)
        first = self.start[:-1]
        weights = np.exp(log - np.repeat(np.maximum.reduceat(log, first), counts))
        normalized: Column = weights / np.repeat(np.add.reduceat(weights, first), counts)
        return normalized


def sets_of(sensors: Sequence[Mapping[str, Any]], settings: Settings) -> Sets:
    """Arrays of the records of some sensors, none of which failed.

    The records have ``posterior``, ``causes``, ``competing`` and ``terms``.
    """
    others = _independent(settings)
    effects = sorted({cause for one in sensors for cause in one["competing"]})
    found = {id_ for one in sensors for ids, _ in one["posterior"] for id_ in ids}
    causes = [*effects, *sorted(found - set(effects))]
    place = {cause: n for n, cause in enumerate(causes)}
    competes = np.zeros((len(sensors), len(causes)), dtype=np.bool_)
    priors = np.zeros(competes.shape)
    entries: list[tuple[int, int, int, int]] = []
    log: list[float] = []
    start = [0]
    classes: dict[Ids, int] = {}
    for number, one in enumerate(sensors):
        of_count, mean = _priors(len(one["competing"]), settings)
        able = [c for c in causes[len(effects) :] if c != UNKNOWN or one["terms"]]
        for cause in (*one["competing"], *able):
            competes[number, place[cause]] = True
            priors[number, place[cause]] = others.get(cause, mean)
        tied = _tied(one, classes, len(causes))
        for ids, p in one["posterior"]:
            known = [others[id_] for id_ in ids if id_ in others]
            prior = of_count[len(ids) - len(known)] + sum(np.log(q) - np.log1p(-q) for q in known)
            entries += [(len(log), number, place[id_], tied.get(id_, place[id_])) for id_ in ids]
            log.append(np.log(p) - prior)
        start.append(len(log))
    columns = np.array(entries, dtype=np.intp).reshape(-1, 4).T
    members = [[place[cause] for cause in ids] for ids in classes]
    prior_of = priors.sum(axis=0) / competes.sum(axis=0)
    return Sets(
        causes,
        members,
        np.array(start),
        np.array(log),
        entry_set=columns[0],
        entry_sensor=columns[1],
        entry_cause=columns[2],
        entry_weight=columns[3],
        competes=competes,
        prior=prior_of,
    )


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


def _priors(competing: int, settings: Settings) -> tuple[list[float], float]:
    """Log prior of one set of each number of effects, and the prior of one effect: Eq. 7 and 8."""
    counts = settings.priors.of_counts(competing)
    of_set = [settings.priors.log_of_set(k, competing) for k in range(competing + 1)]
    mean = sum(k * p for k, p in enumerate(counts)) / sum(counts)
    return of_set, mean / max(competing, 1)


@dataclass(frozen=True)
class Prevalence:
    """Causes of a kind of sensors."""

    share: Mapping[str, float]
    """Part of the sensors that have a cause, among those where it competes."""
    uncertainty: Mapping[str, float]
    """Standard uncertainty of it."""
    prior: Mapping[str, float]
    """What it is without the fleet."""
    posteriors: list[list[tuple[Ids, float]]]
    """Of each sensor, given the others: sets of causes and their probabilities."""

    def probability(self, place: int, causes: Sequence[str]) -> float:
        """Probability that a sensor has at least one of these causes, given the others."""
        return sum(p for ids, p in self.posteriors[place] if not set(causes).isdisjoint(ids))


def prevalence(sensors: Sequence[Mapping[str, Any]], settings: Settings) -> Prevalence:
    """Estimate how common each cause is among sensors of a kind, and weigh each sensor's posterior again."""
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


@dataclass(frozen=True)
class Name:
    """A cause that is named in a sensor."""

    sensor: str
    cause: str
    # own, fleet: probability of its class, from the sensor alone and given the fleet
    own: float
    fleet: float


@dataclass(frozen=True)
class Judged:
    """All sensors, given the fleet."""

    sensors: list[dict[str, Any]]  # for each record: ``verdict`` and ``causes``, with two probabilities each
    kinds: Mapping[str, Prevalence]
    names: list[Name]  # causes that may be named, whatever their probability is


def judged(records: Sequence[Mapping[str, Any]], settings: Settings) -> Judged:
    """Estimate how common causes are in each kind, and judge each sensor with it."""
    sensors: list[dict[str, Any]] = [{"verdict": one["verdict"], "causes": []} for one in records]
    kinds: dict[str, Prevalence] = {}
    names: list[Name] = []
    for kind in sorted({one["kind"] for one in records}):
        places = [n for n, one in enumerate(records) if one["kind"] == kind and one["verdict"] != FAILED]
        if not places:
            continue
        found = kinds[kind] = prevalence([records[n] for n in places], settings)
        for position, n in enumerate(places):
            sensors[n], own = _sensor(records[n], found, position, settings.claims.named)
            names += own
    return Judged(sensors, kinds, names)


def _sensor(
    record: Mapping[str, Any], found: Prevalence, place: int, named: float
) -> tuple[dict[str, Any], list[Name]]:
    causes = []
    names = []
    for cause in record["causes"]:
        members = [cause["id"], *cause["indistinguishable_from"]]
        listed = sum(p for ids, p in record["posterior"] if not set(members).isdisjoint(ids))
        # a claim beside an unexplained term is held below the sum of its sets
        most = 1.0 if cause["probability"] > listed - 1e-6 else cause["probability"]
        fleet = min(found.probability(place, members), most)
        causes.append(
            {
                "fleet_probability": fleet,
                "fleet_probability_alone": min(found.probability(place, [cause["id"]]), most),
            }
        )
        if _may_be_named(cause, record):
            names.append(Name(record["sensor"], cause["id"], cause["probability"], fleet))
    verdict = record["verdict"]
    if verdict in {"named", "ambiguous"}:
        certain = any(name.fleet >= named for name in names)
        verdict = "named" if certain else "ambiguous"
    return {"verdict": verdict, "causes": causes}, names


def _may_be_named(cause: Mapping[str, Any], record: Mapping[str, Any]) -> bool:
    """Whether nothing but its probability can stand against a name."""
    if cause["kind"] == "effect":
        gain = record["gain"]
        earned = gain is not None and gain["interval_95"][0] > 0.0
        return bool(cause["in_model"] and not cause["doubt"] and earned)
    return bool(record["verdict"] == "named")


def false_discoveries(names: Sequence[Name], named: float, accepted: float) -> dict[str, Any]:
    """False names to expect among those that are named: docs/method/several-tables.md, Eq. 62.

    `named` is the probability from which on a cause is named, and `accepted` the part of false names of the
    longest list that is accepted.
    """

    def of(probabilities: list[float]) -> dict[str, Any]:
        false = sum(1 - p for p in probabilities)
        return {
            "names": len(probabilities),
            "expected_false": false,
            "rate": false / len(probabilities) if probabilities else None,
        }

    ordered = sorted((name.fleet for name in names), reverse=True)
    false, longest = 0.0, 0
    for count, p in enumerate(ordered, start=1):
        false += 1 - p
        if false <= accepted * count:
            longest = count
    return {
        "named_from": named,
        "own": of([name.own for name in names if name.own >= named]),
        "fleet": of([name.fleet for name in names if name.fleet >= named]),
        "at_rate": {
            "rate": accepted,
            "names": longest,
            "probability_from": ordered[longest - 1] if longest else None,
        },
    }
