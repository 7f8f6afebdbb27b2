"""The standard uncertainty of a corrected distance, against the scatter of a simulation."""

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_table
from echocal.correct.results import DISTANCE, UNCERTAINTY
from echocal.correct.uncertainty import Uncertainties

EFFECTS = {
    "fixed_delay": {"delay": 31e-6},
    "zero_error": {"offset": 2e-3},
    "temperature_gain": {"gain": 0.03},
}
COVARIANCE = np.array([[4e-12, -1.5e-9, 0.0], [-1.5e-9, 1e-6, 0.0], [0.0, 0.0, 1e-4]])
STATED = {"temperature_C": 0.4, "humidity_percent": 4.0, "pressure_hPa": 3.0, "echo_us": 4.0}
TRIALS = 40_000

pytestmark = pytest.mark.filterwarnings("ignore::echocal.DomainWarning")


def device(effects: dict[str, dict[str, float]]) -> echocal.Model:
    names = echocal.Model("cramer", effects).parameter_names
    order = ["fixed_delay.delay", "zero_error.offset", next(n for n in names if "gain" in n)]
    places = [names.index(name) for name in order]
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(places, places)] = COVARIANCE
    return echocal.Model("cramer", effects, covariance=covariance)


def effects() -> dict[str, dict[str, float]]:
    gain = [p.name for p in next(e for e in echocal.effects() if e.id == "temperature_gain").parameters]
    return {**EFFECTS, "temperature_gain": {gain[0]: 0.03}}


def drawn(model: echocal.Model, row: dict[str, float], random: np.random.Generator) -> np.ndarray:
    """Distances of one row with all that is uncertain drawn anew."""
    deviations = random.multivariate_normal(np.zeros(len(model.parameter_names)), model.covariance, 400)
    found = []
    for deviation in deviations:
        moved = {id_: dict(own) for id_, own in model.effects.items()}
        for name, value in zip(model.parameter_names, deviation, strict=True):
            id_, _, parameter = name.partition(".")
            moved[id_][parameter] += value
        some = TRIALS // 400
        table = pd.DataFrame(
            {name: value + STATED[name] * random.standard_normal(some) for name, value in row.items()}
        )
        found.append(correct_table(table, echocal.Model("cramer", moved)).table[DISTANCE].to_numpy())
    return np.concatenate(found)


@pytest.mark.slow
@pytest.mark.parametrize("echo", [1500.0, 9000.0, 24_000.0])
def test_it_is_the_scatter_of_a_simulation(echo: float, random: np.random.Generator) -> None:
    row = {"echo_us": echo, "temperature_C": 24.0, "humidity_percent": 55.0, "pressure_hPa": 1002.0}
    model = device(effects())
    stated = correct_table(pd.DataFrame([row]), model, uncertainties=STATED).table[UNCERTAINTY][0]
    scatter = drawn(model, row, random)
    # 400 drawn models: their standard deviation is known to 3.5 %; four times that
    assert stated == pytest.approx(float(np.nanstd(scatter)), rel=0.14)
    alone = correct_table(pd.DataFrame([row]), model).table[UNCERTAINTY][0]
    assert 0.0 < alone < stated


def test_each_part_is_what_a_derivation_gives() -> None:
    """A law alone: u(d) = c u(t) / 2, and d / c dc/dT u(T)."""
    table = pd.DataFrame({"echo_us": [12_000.0], "temperature_C": [20.0]})
    law = echocal.Model("linear")  # c = 331.4 + 0.6 T
    for stated, expected in (
        ({"echo_us": 10.0}, 343.4 * 10e-6 / 2),
        ({"temperature_C": 0.5}, 12e-3 / 2 * 0.6 * 0.5),
        ({"echo_us": 10.0, "temperature_C": 0.5}, np.hypot(343.4 * 5e-6, 1.8e-3)),
        ({"humidity_percent": 5.0}, 0.0),
    ):
        found = correct_table(table, law, uncertainties=stated).table[UNCERTAINTY][0]
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-12)


def test_a_reading_has_its_own() -> None:
    table = pd.DataFrame({"reading_mm": [2000.0], "temperature_C": [30.0]})
    found = correct_table(
        table, echocal.Model("linear"), reading_speed="343", uncertainties={"reading_mm": 3.0}
    )
    assert found.table[UNCERTAINTY][0] == pytest.approx(3e-3 * 349.4 / 343, rel=1e-6)


def test_an_assumed_pressure_may_be_uncertain() -> None:
    """Cramer's speed hardly depends on pressure; humidity that is not recorded does matter."""
    table = pd.DataFrame({"echo_us": [12_000.0], "temperature_C": [30.0]})
    found = correct_table(table, echocal.Model("cramer"), uncertainties={"relative_humidity": 0.2}).table
    moist = correct_table(table.assign(relative_humidity=0.2), echocal.Model("cramer")).table
    shift = moist[DISTANCE][0] - found[DISTANCE][0]
    assert found[UNCERTAINTY][0] == pytest.approx(shift, rel=1e-4)


def test_nothing_known_is_not_zero() -> None:
    table = pd.DataFrame({"echo_us": [12_000.0, -1.0], "temperature_C": [20.0, 20.0]})
    assert correct_table(table, echocal.Model("linear")).table[UNCERTAINTY].isna().all()
    held = echocal.Model("linear", {"zero_error": {"offset": 1e-3}}, covariance=[[0.0]])
    assert correct_table(table, held).table[UNCERTAINTY].isna().tolist() == [False, True]
    assert correct_table(table, held).table[UNCERTAINTY][0] == 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("temperature=0.5", "names no quantity with its unit"),
        ("temperature_C", "not of the form NAME=VALUE"),
        ("temperature_C=warm", "not of the form NAME=VALUE"),
        ("temperature_C=-1", "no standard uncertainty"),
        ("distance_mm=1", "names no quantity"),
        ("stand=1", "names no quantity"),
    ],
)
def test_mistakes_are_told(text: str, message: str) -> None:
    with pytest.raises(echocal.UsageError, match=message):
        Uncertainties.of([text])
    with pytest.raises(echocal.UsageError, match="states temperature twice"):
        Uncertainties.of(["temperature_C=1", "temperature_F=1"])
