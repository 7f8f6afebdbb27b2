"""What to measure next, and predicting with everything that is possible."""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from hidden_effects.planting import EFFECTS, bench, noise, table

import echocal
from echocal import Model
from echocal.cli._ranges import parsed_ranges
from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.experiment_design.design import planned
from echocal.diagnose.experiment_design.prospect import Prospect
from echocal.diagnose.experiment_design.ranges import corners_and_middle
from echocal.diagnose.inference.noise import Noise

RANGES = {"distance": (0.2, 4.0), "temperature": (5.0, 40.0)}


def one_distance(random: np.random.Generator, shift: float = 6e-3) -> echocal.Diagnosis:
    """Twenty-six rows at two meters: many causes look the same."""
    data = {"temperature_C": np.linspace(0, 50, 26), "reading_m": 2.0 + shift + random.normal(0, 1e-3, 26)}
    return echocal.diagnose(data, reference_distance=2.0, can_vary=RANGES)


@pytest.fixture(scope="module")
def open_case(
    request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]
) -> echocal.Diagnosis:
    return one_distance(seeded(request))


def test_rows_lie_within_what_can_be_varied(open_case: echocal.Diagnosis) -> None:
    (plan,) = [p for p in open_case.next_measurements if p.expected_probability is not None]
    for name, (low, high) in RANGES.items():
        assert all(low <= value <= high for value in plan.conditions[name])
    assert sum(plan.conditions["rows"]) == 10
    assert plan.probability_now is not None
    assert plan.expected_probability is not None
    assert plan.probability_now + 0.05 <= plan.expected_probability <= 1.0


def test_every_corner_of_what_can_be_varied_gets_rows(open_case: echocal.Diagnosis) -> None:
    (plan,) = [p for p in open_case.next_measurements if p.expected_probability is not None]
    places = set(zip(plan.conditions["distance"], plan.conditions["temperature"], strict=True))
    assert set(product(*RANGES.values())) <= places
    assert sum(plan.conditions["rows"]) == 10


def test_another_distance_tells_an_offset_from_a_scale(open_case: echocal.Diagnosis) -> None:
    (plan,) = [p for p in open_case.next_measurements if p.expected_probability is not None]
    assert max(abs(distance - 2.0) for distance in plan.conditions["distance"]) > 0.5


@pytest.mark.statistical
def test_without_another_distance_less_can_be_told(
    open_case: echocal.Diagnosis, random: np.random.Generator
) -> None:
    data = {"temperature_C": np.linspace(0, 50, 26), "reading_m": 2.006 + random.normal(0, 1e-3, 26)}
    fixed = echocal.diagnose(data, reference_distance=2.0, can_vary={"temperature": (5.0, 40.0)})
    plans = [p for p in fixed.next_measurements if p.expected_probability is not None]
    (free,) = [p for p in open_case.next_measurements if p.expected_probability is not None]
    assert free.expected_probability is not None
    assert len(free.separates) > max((len(p.separates) for p in plans), default=0)


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ({"humidity": (0, 1)}, r"does not record; it can name distance \(in m\), temperature \(in degC\)\."),
        ({"temperature_rate": (0, 1)}, "does not record"),
        ({"distance": (4.0, 0.2)}, "lower one first"),
        ({"distance": (0.0, 2.0)}, "give a positive distance"),
        ({"temperature": (1.0,)}, "two ends"),
        ({"temperature": 3.0}, "two ends"),
        ({"temperature": ("a", "b")}, "two ends"),
        ({"temperature": (-400.0, 5.0)}, "a table can have -95 to 100 degC"),
        ({"distance": (0.2, 400.0)}, "a table can have 0 to 100 m"),
        ({"temperature": (1.0, float("nan"))}, "two ends"),
    ],
)
def test_bad_ranges(ranges: dict[str, Any], words: str) -> None:
    data = {"temperature_C": np.linspace(0, 50, 26), "reading_m": np.full(26, 2.0)}
    with pytest.raises(echocal.UsageError, match=words):
        echocal.diagnose(data, reference_distance=2.0, can_vary=ranges)


def prospect(effects: list[dict[str, Any]], at: dict[str, np.ndarray], variance: float) -> Prospect:
    members = [Member(tuple(e), 1 / len(effects), Model("linear", e)) for e in effects]
    still = Noise(0.0, 0.0, 0.0, 1.0)
    return Prospect.of(members, Model("linear"), at, still, variance, True, np.empty(0))


def test_a_condition_is_given_one_range() -> None:
    assert parsed_ranges(["distance=0.2:4", "temperature=5:40"]) == RANGES
    with pytest.raises(echocal.UsageError, match=r"distance twice: 0.2:4 and 1:2"):
        parsed_ranges(["distance=0.2:4", "distance=1:2"])


NINE = {"distance": np.repeat([0.3, 1.0, 3.0], 3), "temperature": np.tile([5.0, 20.0, 35.0], 3)}


def test_a_prospect_without_noise_can_be_planned() -> None:
    seen = prospect([{}, {"zero_error": {"offset": 1e-3}}], NINE, 0.0)
    assert planned(seen, np.array([0.5, 0.5]), np.arange(2), 10, 0).expected > 0.5


def test_exact_aliases_are_one_class_and_what_a_place_can_tell_is_not() -> None:
    alike = prospect(
        [
            {},
            {"reference_scale": {"scale": -2e-3}},
            {"clock_error": {"frequency_error": 3e-3}},
            {"zero_error": {"offset": 2e-3}},
            {"fixed_delay": {"delay": 12e-6}},
        ],
        NINE,
        1e-6,
    )
    none, scale, clock, offset, delay = alike.aliases([0, 1, 1, 1, 1]).tolist()
    assert scale == clock
    assert len({none, scale, offset, delay}) == 4
    assert len(set(alike.aliases([0, 1, 2, 1, 1]).tolist())) == 5  # two causes are not one


def test_a_promise_counts_what_is_outside_the_members_as_lost() -> None:
    seen = prospect([{}, {"zero_error": {"offset": 0.1}}], NINE, 1e-6)
    plan = planned(seen, np.array([0.5, 0.3]), np.arange(2), 10, 0)
    assert plan.now == pytest.approx(0.5)
    assert plan.expected == pytest.approx(0.8, abs=1e-3)


@pytest.mark.statistical
def test_a_promise_is_kept_by_its_own_members(random: np.random.Generator) -> None:
    """Draw the truth and readings of the plan's places, weigh the members by hand, count."""
    effects = [{}, {"zero_error": {"offset": 2e-3}}, {"reference_scale": {"scale": 1e-3}}]
    four = {"distance": np.array([0.3, 0.3, 3.0, 3.0]), "temperature": np.array([5.0, 35.0, 5.0, 35.0])}
    seen = prospect(effects, four, 9e-6)
    probability = np.array([0.5, 0.3, 0.2])
    plan = planned(seen, probability, np.arange(3), 6, 0)
    counts = np.array(plan.rows)
    trials = 20_000
    truth = random.choice(3, trials, p=probability)
    tape = 1e-6 * (1.0 + np.equal.outer(*2 * [four["distance"]]))
    spread = tape + np.diag(9e-6 / counts)
    drawn = seen.shift[truth] + random.multivariate_normal(np.zeros(4), spread, trials)
    left = drawn[:, None] - seen.shift[None]
    log = np.log(probability) - 0.5 * np.einsum("nmi,ij,nmj->nm", left, np.linalg.inv(spread), left)
    hits = int((log.argmax(axis=1) == truth).sum())
    assert plan.expected == pytest.approx(hits / trials, abs=0.03)


@pytest.mark.parametrize("names", [("distance",), ("temperature",), ("distance", "temperature")])
def test_the_guards_are_the_corners_and_the_middle(names: tuple[str, ...]) -> None:
    *corners, middle = zip(*corners_and_middle({name: RANGES[name] for name in names}).values(), strict=True)
    assert set(corners) == set(product(*(RANGES[name] for name in names)))
    center = {"distance": (0.2 * 4.0) ** 0.5, "temperature": 22.5}
    assert middle == pytest.approx([center[name] for name in names])


@pytest.mark.parametrize("count", [4, 5, 7, 9])
def test_many_conditions_share_few_corners(count: int) -> None:
    """Each condition is at each end equally often, whatever another one is: no two are confounded."""
    columns = corners_and_middle({str(name): (-1.0, 1.0) for name in range(count)})
    corners = np.array(list(columns.values()))[:, :-1]
    assert corners.shape[1] == (8 if count < 8 else 16)
    assert (corners @ corners.T == corners.shape[1] * np.eye(count)).all()
    assert not corners.sum(axis=1).any()


@pytest.mark.statistical
def test_the_average_warns_where_causes_part(random: np.random.Generator) -> None:
    closer = 0
    for _ in range(3):
        case = one_distance(random)
        with pytest.warns(echocal.DisagreementWarning, match="at [12] of 2 points"):
            reading = case.predict([2.0, 0.3], temperature=25.0)
        assert not reading.agreed[1]
        assert sum(m.probability for m in case.members) == pytest.approx(1.0)
        weights = np.array([m.probability for m in case.members])
        assert reading.value == pytest.approx(weights @ np.array(list(reading.by_cause.values())))
        near, far = reading.standard_uncertainty
        closer += reading.agreed[0] and abs(reading.value[0] - 2.006) < 1e-3 and near < far
    # one in eight such tables leaves open whether its one level is autocorrelated noise: no agreement at all
    assert closer >= 1


@pytest.mark.statistical
def test_the_average_corrects_what_it_predicts(random: np.random.Generator) -> None:
    rows = bench(random)
    data = table(rows, EFFECTS["fixed_delay"](rows, 2.0) + noise(rows, random))
    diagnosis = echocal.diagnose(data)
    air = {"temperature": 20.0, "relative_humidity": 0.5, "elapsed_time": 0.0}
    reading = diagnosis.predict(1.0, **air)
    distance = diagnosis.correct(reading.value, **air)
    assert distance.value == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("seed", [489751801, None])
def test_every_proposal_says_what_it_is_for(seed: int | None, random: np.random.Generator) -> None:
    """Also where rows help and yet tell nothing apart for sure, as in the table of this seed."""
    random = random if seed is None else np.random.default_rng(seed)
    distance = random.uniform(0.5, 3.5, 400)
    reading = distance + 8e-3 + random.normal(0.0, 1e-3, 400)
    data = {
        "reading_m": reading,
        "distance_m": distance,
        "temperature_C": random.uniform(19.9, 20.1, 400),
    }
    diagnosis = echocal.diagnose(data)
    assert diagnosis.next_measurements
    assert all(proposal.separates for proposal in diagnosis.next_measurements)
    assert "Next: to separate " in diagnosis.explain()
