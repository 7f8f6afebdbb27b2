"""The standard uncertainty of a corrected distance, against the scatter of a simulation and fresh rows."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hidden_effects import cases, designs, disturbance
from hidden_effects.cases import Case, Spec
from typer.testing import CliRunner

import echocal
from echocal.budget.stated import Uncertainties
from echocal.cli import app
from echocal.correct import correct_table
from echocal.correct.results import DISTANCE, UNCERTAINTY

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
        ("distance_mm=1", "names no quantity with its unit(?!.*distance_mm)"),
        ("stand=1", "names no quantity"),
    ],
)
def test_mistakes_are_told(text: str, message: str) -> None:
    with pytest.raises(echocal.UsageError, match=message):
        Uncertainties.of([text])
    with pytest.raises(echocal.UsageError, match="states temperature twice"):
        Uncertainties.of(["temperature_C=1", "temperature_F=1"])


def fresh(case: Case, random: np.random.Generator) -> tuple[pd.DataFrame, np.ndarray]:
    """Other noise, and in design c other rows, of the same device; the reference distances."""
    rows = designs.DESIGNS[case.spec.design](random) if case.spec.design == "c" else case.rows
    world = cases.planted(rows, case.sizes, case.spec.seed)
    reading = world.reading() + disturbance.NOISES[case.spec.noise](rows, random)
    return world.table(reading, set()), world.reference


def shares(design: str, count: int, random: np.random.Generator, path: Path) -> list[float]:
    """For each of some tables, the part of fresh rows whose error is below twice what is stated."""
    found = []
    for number in range(count):
        causes = ((), ("fixed_delay",), ("temperature_offset",), ("speed_slope",))[number % 4]
        noise = ("normal", "student_t4", "autoregressive")[number % 3]
        case = cases.build(Spec(design, "wild", causes, noise, 0.0, int(random.integers(2**60))))
        echocal.diagnose(case.table).model.save(path / "model.json")
        table, truth = fresh(case, random)
        corrected = correct_table(table, echocal.Model.load(path / "model.json")).table
        found.append(float(np.mean(np.abs(corrected[DISTANCE] - truth) < 2.0 * corrected[UNCERTAINTY])))
    return found


@pytest.mark.slow
@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore::echocal.DataWarning")
@pytest.mark.parametrize(("design", "count"), [("a", 60), ("b", 8), ("c", 8)])
def test_fresh_rows_are_within_twice_of_it(
    design: str, count: int, random: np.random.Generator, tmp_path: Path
) -> None:
    """The mean share scatters by 0.010 in these tables; docs/honesty.md has 200 tables of each design."""
    assert np.mean(shares(design, count, random, tmp_path)) == pytest.approx(0.95, abs=0.03)


@pytest.mark.slow
@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore::echocal.DataWarning")
def test_it_follows_noise_that_grows_with_the_distance(random: np.random.Generator, tmp_path: Path) -> None:
    distance = np.repeat([0.3, 1.0, 2.0, 3.8], 100)
    celsius = np.tile(np.linspace(5.0, 35.0, 100), 4)

    def table() -> pd.DataFrame:
        reading = distance + 8e-3 + random.normal(0.0, np.hypot(2e-4, 1e-3 * distance))
        return pd.DataFrame({"reading_m": reading, "temperature_C": celsius, "distance_m": distance})

    model = echocal.diagnose(table()).model
    corrected = correct_table(table(), model).table
    for at in np.unique(distance):
        own = corrected[distance == at]
        scatter = float(np.sqrt(np.mean((own[DISTANCE] - at) ** 2)))
        # 100 rows: the RMS error is known to 7 %, the fitted function to less
        assert own[UNCERTAINTY].median() == pytest.approx(scatter, rel=0.35)


@pytest.mark.slow
def test_it_is_the_same_from_every_command(random: np.random.Generator, tmp_path: Path) -> None:
    """`correct`, the array function and the report of the C state one number, and say what it has."""
    # 80 us are 14 mm, 45 times the scatter: a parameter is fitted in every draw
    celsius, distance = random.uniform(0.0, 40.0, 400), random.choice([0.4, 0.9, 1.7, 2.8], 400)
    echo_us = 1e6 * (2.0 * distance / echocal.speed_of_sound(celsius) + 80e-6) + random.normal(0.0, 1.8, 400)
    log = {"echo_us": echo_us, "temperature_C": celsius, "distance_m": distance}
    pd.DataFrame(log).to_csv(tmp_path / "log.csv", index=False)
    places = {name: str(tmp_path / name) for name in ("log.csv", "model.json", "out.csv", "c", "at.csv")}
    run = CliRunner().invoke
    assert run(app, ["diagnose", places["log.csv"], "--save-model", places["model.json"]]).exit_code == 0
    told = run(app, ["correct", places["log.csv"], "--model", places["model.json"], "-o", places["out.csv"]])
    assert told.exit_code == 0
    assert "repeatability" in told.output
    assert "fitted parameters" in told.output
    model = echocal.Model.load(places["model.json"])
    out = pd.read_csv(places["out.csv"])
    direct = model.standard_uncertainty(out[DISTANCE], temperature=out["temperature_C"])
    assert out[UNCERTAINTY].to_numpy() == pytest.approx(direct, rel=1e-6)
    words = [
        "--target",
        "c99",
        "--temperature-lsb",
        "0.5",
        "--temperature-range=-10:50",
        "--max-error-mm",
        "1",
    ]
    assert run(app, ["firmware", places["model.json"], *words, "-o", places["c"]]).exit_code == 0
    stated = json.loads((tmp_path / "c" / "report.json").read_text())["provenance"]["standard_uncertainty"]
    for at, size in stated:
        assert size == pytest.approx(model.standard_uncertainty(at, temperature=20.0), rel=1e-5)
    header = (tmp_path / "c" / "echocal_correction.h").read_text()
    size = dict(map(tuple, stated))[2.0]
    told = re.findall(r"- at 2.0 m: ([0-9.]+) mm", header)
    # the first is the standard uncertainty, rounded up to whole micrometers; the second has what the C adds
    assert 0.0 <= float(told[0]) * 1e-3 - size + 1e-12 <= 1e-6 + 1e-12


def test_a_model_of_old_says_that_it_states_no_repeatability() -> None:
    table = pd.DataFrame({"echo_us": [12_000.0], "temperature_C": [20.0]})
    held = echocal.Model("linear", {"fixed_delay": {"delay": 3e-5}}, covariance=[[1e-14]])
    (note,) = (note for note in correct_table(table, held).notes if UNCERTAINTY in note)
    assert "without it" in note


def test_a_calibrated_model_states_the_scatter_of_its_rows(random: np.random.Generator) -> None:
    distance = np.tile([0.5, 1.0, 2.0, 3.0], 200)
    reading = distance + 4e-3 + random.normal(0.0, 1.5e-3, len(distance))
    table = pd.DataFrame({"reading_m": reading, "temperature_C": 20.0, "distance_m": distance})
    found = echocal.calibrate(table, echocal.Model("linear"), fit=["zero_error"])
    stated = correct_table(table, found.model).table[UNCERTAINTY]
    assert stated.to_numpy() == pytest.approx(1.5e-3, rel=0.2)
    error = correct_table(table, found.model).table[DISTANCE] - distance
    assert np.mean(np.abs(error) < 2.0 * stated) == pytest.approx(0.95, abs=0.03)
