"""How common causes are in a fleet, and how many names are false: told against drawn."""

from itertools import combinations
from math import comb
from typing import Any

import numpy as np
import pytest
from scipy.stats import hypergeom

from echocal.diagnose.settings import Settings
from echocal.fleet.prevalence import false_discoveries, judged, prevalence
from echocal.fleet.summary import together

SETTINGS = Settings()
CAUSES = ("amplitude_walk", "clock_error", "drift", "fixed_delay", "temperature_lag", "zero_error")
PLANTED = np.array([0.0, 0.02, 0.05, 0.3, 0.0, 0.1])
SETS = [ids for count in range(len(CAUSES) + 1) for ids in combinations(CAUSES, count)]
MEMBER = np.array([[cause in ids for cause in CAUSES] for ids in SETS], dtype=float)


def prior(settings: Settings = SETTINGS) -> np.ndarray:
    """Of each set, as a diagnosis has it: the priors of the numbers of causes, evenly divided."""
    counts = [*settings.priors.counts, *(settings.priors.three_causes * 0.1**n for n in (1, 2, 3))]
    whole = np.array([counts[len(ids)] / comb(len(CAUSES), len(ids)) for ids in SETS])
    return whole / whole.sum()


def sensor(random: np.random.Generator, number: int, seen: float) -> tuple[dict[str, Any], set[str]]:
    """A record whose posterior is exact: each cause that is there shows by `seen` standard deviations."""
    there = random.random(len(CAUSES)) < PLANTED
    shown = random.normal(seen * there, 1.0)
    log = MEMBER @ (seen * shown - 0.5 * seen**2) + np.log(prior())
    posterior = np.exp(log - log.max())
    posterior /= posterior.sum()
    listed = [[list(ids), float(p)] for ids, p in zip(SETS, posterior, strict=True) if p > 1e-6]
    best = max(CAUSES, key=lambda c: sum(p for ids, p in listed if c in ids))
    claim = {
        "id": best,
        "kind": "effect",
        "probability": sum(p for ids, p in listed if best in ids),
        "indistinguishable_from": [],
        "in_model": True,
        "doubt": "",
    }
    record = {
        "sensor": str(number),
        "kind": "",
        "verdict": "named",
        "causes": [claim],
        "posterior": listed,
        "competing": list(CAUSES),
        "terms": False,
        "gain": {"interval_95": [0.1, 0.2]},
    }
    return record, {cause for cause, is_there in zip(CAUSES, there, strict=True) if is_there}


@pytest.fixture
def fleet(random: np.random.Generator) -> tuple[list[dict[str, Any]], list[set[str]]]:
    drawn = [sensor(random, number, 3.0) for number in range(3000)]
    return [record for record, _ in drawn], [there for _, there in drawn]


def test_prevalences_are_those_that_were_drawn(fleet: tuple[list[dict[str, Any]], list[set[str]]]) -> None:
    found = prevalence(fleet[0], SETTINGS)
    for cause, planted in zip(CAUSES, PLANTED, strict=True):
        off = abs(found.share[cause] - planted)
        assert off < 4.5 * found.uncertainty[cause] + 1e-3, cause
    # what the data determine: sqrt(p (1 - p) / n) would be certainty about each sensor
    least = np.sqrt(0.3 * 0.7 / 3000)
    assert least < found.uncertainty["fixed_delay"] < 1.5 * least


def test_the_told_rate_of_false_names_is_the_true_one(
    fleet: tuple[list[dict[str, Any]], list[set[str]]],
) -> None:
    records, there = fleet
    names = judged(records, SETTINGS).names
    told = false_discoveries(names, 0.9, 0.05)["fleet"]
    false = sum(n.cause not in there[int(n.sensor)] for n in names if n.fleet >= 0.9)
    assert told["names"] > 500
    assert abs(false - told["expected_false"]) < 4.5 * np.sqrt(told["expected_false"]) + 1


def test_given_the_fleet_probabilities_of_each_size_are_true_as_often_as_they_say(
    fleet: tuple[list[dict[str, Any]], list[set[str]]],
) -> None:
    records, there = fleet
    names = judged(records, SETTINGS).names
    for low, high in ((0.0, 0.1), (0.1, 0.5), (0.5, 0.9), (0.9, 1.0)):
        bin_ = [n for n in names if low <= n.fleet < high]
        told = sum(n.fleet for n in bin_)
        true = sum(n.cause in there[int(n.sensor)] for n in bin_)
        spread = np.sqrt(sum(n.fleet * (1 - n.fleet) for n in bin_))
        assert abs(true - told) < 4.5 * spread + 1.5, (low, high)


def test_causes_that_no_sensor_has_become_rarer(
    fleet: tuple[list[dict[str, Any]], list[set[str]]],
) -> None:
    names = judged(fleet[0], SETTINGS).names
    absent = [n for n in names if n.cause in {"amplitude_walk", "temperature_lag"}]
    assert sum(n.own >= 0.5 for n in absent) > 20
    assert sum(n.fleet >= 0.5 for n in absent) <= 0.2 * sum(n.own >= 0.5 for n in absent)


def test_a_fleet_of_one_keeps_its_posterior_nearly(random: np.random.Generator) -> None:
    record, _ = sensor(random, 0, 3.0)
    record["posterior"] = [[[], 0.55], [["drift"], 0.4], [["clock_error", "drift"], 0.05]]
    (own,) = prevalence([record], SETTINGS).posteriors
    assert dict(own)[()] == pytest.approx(0.55, abs=0.15)
    assert sum(p for _, p in own) == pytest.approx(1.0)


def test_causes_that_a_sensor_cannot_separate_keep_their_odds() -> None:
    """However many sensors prefer one of them a little: that may be the prior of its size."""
    record = {
        "sensor": "1",
        "kind": "",
        "verdict": "named",
        "causes": [
            {
                "id": "fixed_delay",
                "kind": "effect",
                "probability": 0.99,
                "indistinguishable_from": ["zero_error"],
                "in_model": True,
                "doubt": "",
            }
        ],
        "posterior": [[["fixed_delay"], 0.6], [["zero_error"], 0.39], [[], 0.01]],
        "competing": list(CAUSES),
        "terms": False,
        "gain": {"interval_95": [0.1, 0.2]},
    }
    found = prevalence([record] * 500, SETTINGS)
    own = dict(found.posteriors[0])
    assert own["fixed_delay",] / own["zero_error",] == pytest.approx(0.6 / 0.39)
    assert found.probability(0, ["fixed_delay", "zero_error"]) > 0.999
    assert found.share["fixed_delay"] + found.share["zero_error"] == pytest.approx(1.0, abs=0.01)


def test_noises_and_faults_have_priors_of_their_own() -> None:
    record = {
        "causes": [],
        "posterior": [[["cycle_slip"], 0.5], [[], 0.5]],
        "competing": list(CAUSES),
        "terms": True,
    }
    found = prevalence([record] * 400, SETTINGS)
    # the posterior odds are 1 at a small prior, so the likelihood ratio is large: nearly every sensor has it
    assert found.prior["cycle_slip"] < 0.2
    assert found.share["cycle_slip"] > 0.95


def test_kinds_do_not_mix(fleet: tuple[list[dict[str, Any]], list[set[str]]]) -> None:
    records = [{**record, "kind": "a" if n < 1500 else "b"} for n, record in enumerate(fleet[0])]
    found = judged(records, SETTINGS)
    alone = judged(records[:1500], SETTINGS)
    assert set(found.kinds) == {"a", "b"}
    assert found.sensors[:1500] == alone.sensors


def test_failed_sensors_take_no_part(fleet: tuple[list[dict[str, Any]], list[set[str]]]) -> None:
    failed = {"sensor": "x", "kind": "", "verdict": "failed", "causes": [], "posterior": [], "competing": []}
    records = [*fleet[0][:200], failed]
    found = judged(records, SETTINGS)
    assert found.sensors[-1] == {"verdict": "failed", "causes": []}
    assert found.kinds[""].share == judged(records[:200], SETTINGS).kinds[""].share


def test_the_longest_list_has_no_more_false_names_than_accepted(
    fleet: tuple[list[dict[str, Any]], list[set[str]]],
) -> None:
    records, there = fleet
    names = judged(records, SETTINGS).names
    told = false_discoveries(names, 0.9, 0.05)["at_rate"]
    listed = sorted(names, key=lambda n: -n.fleet)[: told["names"]]
    false = sum(n.cause not in there[int(n.sensor)] for n in listed)
    assert told["names"] > 500
    assert false < 0.05 * len(listed) + 4.5 * np.sqrt(0.05 * len(listed))
    assert sum(1 - n.fleet for n in listed) <= 0.05 * len(listed)


def row(*causes: tuple[str, ...]) -> dict[str, Any]:
    """A row of the table that claims these classes."""
    return {
        "verdict": "named",
        "causes": [{"class": list(ids), "class_probability": 0.99} for ids in causes],
    }


def test_causes_that_come_together_are_told_and_those_of_one_class_are_not() -> None:
    rows = [row(("cycle_slip",), ("zero_error", "fixed_delay"))] * 12 + [row(("cycle_slip",))] * 2
    rows += [row(("zero_error", "fixed_delay"))] * 5 + [row()] * 181
    found = together(rows, SETTINGS)
    assert [one["ids"] for one in found] == [["cycle_slip", "fixed_delay"], ["cycle_slip", "zero_error"]]
    assert found[0]["sensors"] == 12
    assert found[0]["by_chance"] == pytest.approx(14 * 17 / 200)
    # Fisher's exact test, by the hypergeometric distribution of an independent library
    assert found[0]["p_value"] == pytest.approx(3 * hypergeom.sf(11, 200, 14, 17), rel=1e-9)


@pytest.mark.statistical  # the test's own rate of false pairs is 5 %
def test_causes_that_come_together_by_chance_are_not_told(random: np.random.Generator) -> None:
    rows = []
    for _ in range(400):
        claims = [(cause,) for cause in CAUSES if random.random() < 0.2]
        rows.append(row(*claims))
    assert together(rows, SETTINGS) == []
