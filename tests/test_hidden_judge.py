"""The judge is judged: its physics against others', its scores on answers made up, its page."""

import json
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from hidden_effects import echo, gas, likelihood, omniscient, thermometer
from hidden_effects.aliases import label, same_class
from hidden_effects.answers import _judged
from hidden_effects.cases import Case, Spec, build
from hidden_effects.causes import CAUSES
from hidden_effects.menu import SHARES, fits, menu
from hidden_effects.page import page
from hidden_effects.score import beyond_chance, calibration_error, part
from hidden_effects.targets import verdict
from scipy.stats import multivariate_normal, norm, t

ROOT = Path(__file__).parents[1]


def hidden(*causes: str, design: str = "b", stratum: str = "wild", noise: str = "normal") -> Case:
    return build(Spec(design, stratum, causes, noise, 0.0, 20))


def test_dry_air_agrees_with_an_equation_of_state() -> None:
    for temperature in (0.0, 20.0, 50.0):
        expected = PropsSI("A", "T", temperature + 273.15, "P", 101325.0, "Air")
        assert gas.speed(temperature) == pytest.approx(expected, abs=0.15)


def test_absorption_is_that_of_the_standard() -> None:
    # 20 degC, 50 % and 40 kHz: 1.3 dB/m in the tables and plots of ISO 9613-1
    assert gas.attenuation(20.0, 0.5) == pytest.approx(1.32, abs=0.02)


def test_the_thermometer_lags_a_ramp_by_its_time_constant() -> None:
    seconds = np.arange(0.0, 4000.0, 10.0)
    lag = 0.01 * seconds - thermometer.lagging(0.01 * seconds, seconds, 150.0)
    assert lag[-1] == pytest.approx(0.01 * 150.0, rel=1e-6)


def test_fainter_echoes_come_later() -> None:
    distance = np.linspace(0.3, 4.0, 20)
    late = echo.walk(distance, np.full(20, 20.0), np.full(20, 0.5), 0.01, 200e-6)
    assert late[0] == pytest.approx(0.0, abs=1e-12)
    assert (np.diff(late) > 0).all()


@pytest.mark.parametrize("design", ["a", "b", "c"])
def test_nothing_hidden_is_nothing(design: str) -> None:
    assert np.abs(hidden(design=design, stratum="null").shift).max() < 1e-12


@pytest.mark.parametrize("id_", list(CAUSES))
def test_every_cause_shows_in_some_design(id_: str) -> None:
    design = next(d for d in "bca" if id_ in fits(d, ("mean", "noise", "row", "gross")))
    case, without = hidden(id_, design=design), hidden(design=design, stratum="null")
    columns = ["reading_m", "distance_m", "temperature_C"]
    assert not np.allclose(case.table[columns], without.table[columns], atol=1e-6)
    assert case.table.equals(hidden(id_, design=design).table), "the same spec must be the same case"


def test_strength_is_what_was_asked_for() -> None:
    case = hidden("amplitude_walk", stratum="power8")
    assert case.snr * np.sqrt(len(case.rows)) == pytest.approx(8.0, rel=0.01)


def test_classes_follow_from_geometry() -> None:
    assert label("oblique_target") == label("clock_error")
    assert same_class(hidden("fixed_delay", design="a"), "fixed_delay", "speed_intercept")
    assert not same_class(hidden("fixed_delay", design="b"), "fixed_delay", "speed_slope")
    assert not same_class(hidden("fixed_speed"), "fixed_speed", "double_correction")


def answer(ids: list[str], p: float) -> dict[str, object]:
    cause = {"probability": p, "indistinguishable_from": [], "in_model": True}
    return {
        "verdict": "named" if ids else "nothing",
        "causes": [{"id": id_, **cause} for id_ in ids],
        "posterior": [{"ids": ids, "probability": p}, {"ids": ["unknown"], "probability": 1 - p}],
        "credible_set": [ids],
        "unexplained": None,
    }


def test_the_right_name_is_right_under_any_alias() -> None:
    said = _judged(hidden("temperature_offset"), answer(["speed_intercept"], 0.97))
    assert said["strict"]
    assert said["class"]
    assert said["covered"]
    assert said["confident_wrong"] == []
    assert said["strict_counts"] == (1, 1, 1)


def test_a_wrong_name_is_wrong() -> None:
    said = _judged(hidden("temperature_gain"), answer(["zero_error"], 0.97))
    assert (said["strict"], said["class"], said["covered"]) == (False, False, False)
    assert said["confident_wrong"] == [("zero_error", 0.97)]
    assert said["strict_counts"] == (0, 1, 1)


def test_noise_that_is_there_may_be_named() -> None:
    remembering = hidden(design="c", stratum="null", noise="autoregressive")
    assert not _judged(remembering, answer(["correlated_noise"], 0.97))["alarm"]
    assert _judged(remembering, answer(["zero_error"], 0.97))["alarm"]
    assert not _judged(remembering, answer([], 0.97))["alarm"]


def test_perfect_probabilities_have_no_error_beyond_chance(random: np.random.Generator) -> None:
    sure = random.uniform(0.3, 1.0, 4000)
    records = [{"top_probability": p, "strict": bool(random.random() < p)} for p in sure]
    # a bin's part has a standard deviation of at most 0.5 / sqrt(500): 0.05 is far outside
    assert beyond_chance(records, 40).value < 0.05
    assert calibration_error([{**r, "strict": False} for r in records]) > 0.5


def test_a_target_is_missed_only_beyond_its_interval() -> None:
    few = part([{"hit": i < 8} for i in range(10)], lambda r: r["hit"])
    assert verdict(few, (0.9, None)) == "open"
    assert verdict(few, (0.99, None)) == "missed"
    assert verdict(few, (0.7, None)) == "met"


def test_a_menu_has_every_stratum_in_its_share() -> None:
    specs = menu("ab", 100, {"zero_error", "fixed_delay", "speed_slope"}, 5)
    assert len(specs) == len(set(specs))
    for stratum, share in SHARES.items():
        assert sum(s.stratum == stratum and s.design == "b" for s in specs) == round(100 * share)
    assert menu("ab", 100, {"zero_error", "fixed_delay", "speed_slope"}, 5) == specs


def test_the_page_is_fresh() -> None:
    made, bench = (
        json.loads((ROOT / "benches" / name).read_text())
        for name in ("diagnosis.json", "diagnosis_bench.json")
    )
    shown = (ROOT / "docs" / "diagnosis-benchmark.md").read_text()
    assert shown == page(made, bench), "run python benches/diagnosis_bench.py --read --docs"


def test_densities_are_those_of_the_draws(random: np.random.Generator) -> None:
    """Closed forms against the normal density of the whole covariance."""
    rows = hidden("zero_error", design="b").rows
    left = random.normal(0.0, 2e-3, (len(rows), 3))
    same = rows.stand[:, None] == rows.stand
    covariance = 1.5e-3**2 * np.eye(len(rows)) + 0.5e-3**2 * same
    expected = multivariate_normal(cov=covariance).logpdf(left.T)
    assert likelihood.taped(rows, left, 0.5e-3) == pytest.approx(expected)
    assert likelihood.normal(left) == pytest.approx(norm(scale=1.5e-3).logpdf(left).sum(0))
    assert likelihood.heavy(left) == pytest.approx(t(4, scale=1.5e-3 / np.sqrt(2)).logpdf(left).sum(0))


def test_a_judge_who_knows_names_what_is_plain() -> None:
    opinion = omniscient.judge(hidden("temperature_lag", design="b"))
    assert opinion.detected
    assert opinion.named == "temperature_lag"
    assert opinion.credible() == ["temperature_lag"]
    assert sum(opinion.probability.values()) == pytest.approx(1.0)
    for knows in (True, False):
        assert omniscient.detection(hidden("speed_slope", design="a"), 8.0, knows_noise=knows) > 0
