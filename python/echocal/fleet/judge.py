"""What a fleet says of its sensors: probabilities given the others, verdicts, false names to expect."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from echocal.diagnose.settings import Settings
from echocal.fleet.prevalence import Prevalence, prevalence
from echocal.fleet.verdicts import FAILED

__all__ = ["Judged", "Name", "false_discoveries", "judged"]


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

    Parameters
    ----------
    named : float
        Probability from which on a cause is named.
    accepted : float
        Part of false names that is accepted, for the longest list that has no more.
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
