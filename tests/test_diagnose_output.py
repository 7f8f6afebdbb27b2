"""What comes out: JSON, sentences, command line, plots, and messages about bad requests."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from hidden_effects.planting import EFFECTS, bench, noise, table
from matplotlib.figure import Figure

import echocal
from echocal.charts.errors import column_chart
from echocal.diagnose.findings.sentences import Recorded, tendency
from echocal.plots.diagnosis import save_diagnosis
from echocal.plots.draw import draw_panel

TABLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"


@pytest.fixture(scope="module")
def diagnosis(
    request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]
) -> echocal.Diagnosis:
    random = seeded(request)
    rows = bench(random)
    return echocal.diagnose(table(rows, EFFECTS["humidity"](rows, 1.0) + noise(rows, random)))


def diagnosed(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "echocal", "diagnose", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def test_json_is_complete_and_plain(diagnosis: echocal.Diagnosis) -> None:
    data = json.loads(json.dumps(diagnosis.to_dict()))
    assert data["schema"] == "echocal.diagnosis/1"
    assert data["verdict"] in {"named", "ambiguous", "unknown", "nothing"}
    cause = data["causes"][0]
    assert {"id", "kind", "probability", "parameters", "indistinguishable_from", "because"} <= set(cause)
    assert {"name", "value", "standard_uncertainty", "unit"} == set(cause["parameters"][0])
    assert math.fsum(entry["probability"] for entry in data["posterior"]) == pytest.approx(1.0)
    gain = data["gain"]
    assert {"rms_before_m", "rms_after_m", "held_out_rows", "fraction_of_reachable", "scheme"} <= set(gain)
    assert gain["interval_95"][0] <= gain["rms_before_m"] - gain["rms_after_m"] <= gain["interval_95"][1]
    assert data["rows"]["used"] == data["rows"]["total"] == 400
    assert data["base"]["law"] == "linear"
    assert data["seconds"] > 0


def test_the_credible_set_is_the_smallest_with_95_percent(
    diagnosis: echocal.Diagnosis, random: np.random.Generator
) -> None:
    """Where one set is certain, and where an offset and a delay are the same: in air of one temperature."""
    distance = np.repeat([0.5, 1.0, 2.0, 3.0], 10)
    table = {
        "reading_m": distance + 0.01 + random.normal(0.0, 1e-3, 40),
        "distance_m": distance,
        "temperature_C": np.full(40, 20.0),
    }
    alike = echocal.diagnose(table)
    assert len(alike.credible_set) > 1
    for found in (diagnosis, alike):
        posterior = dict(found.posterior)
        shares = [posterior[ids] for ids in found.credible_set]
        assert sum(shares) >= 0.95
        assert sum(shares[:-1]) < 0.95
        assert shares == sorted(shares, reverse=True)


def test_same_data_same_answer() -> None:
    first, second = (echocal.diagnose(TABLE).to_dict() for _ in range(2))
    first.pop("seconds"), second.pop("seconds")
    assert first == second


def test_the_sentence_can_be_checked_in_the_data(diagnosis: echocal.Diagnosis) -> None:
    text = diagnosis.explain()
    assert "humidity" in text
    assert diagnosis.causes[0].because in text
    found, predicted = (float(part.split(" mm")[0]) for part in _figures(diagnosis.causes[0].because))
    assert found == pytest.approx(predicted, abs=1.5)  # noise of 1.5 mm, fifths of 80 rows


def test_a_shift_that_hardly_varies_is_told_as_a_shift() -> None:
    temperature = np.linspace(0.0, 40.0, 50)
    delay = 79e-6 * (331.4 + 0.6 * temperature) / 2  # 13.1 to 14.0 mm
    recorded = Recorded({"temperature": temperature})
    text = tendency(delay, delay, recorded)
    assert text.startswith("the mean residual is +13.56 mm; this cause predicts nearly the same error")
    assert tendency(10 * temperature, 10 * temperature, recorded).startswith("the fifth")


def _figures(sentence: str) -> tuple[str, str]:
    _, _, rest = sentence.partition(" mean residual of ")
    found, _, rest = rest.partition(" relative to ")
    return found, rest.partition("predicts ")[2]


def test_the_model_corrects(diagnosis: echocal.Diagnosis) -> None:
    assert set(diagnosis.model.effects) == {c.id for c in diagnosis.causes if c.in_model}
    assert np.nanstd(diagnosis.traces.after) < np.nanstd(diagnosis.traces.before)


def test_the_model_assumes_the_air_that_was_seen(diagnosis: echocal.Diagnosis) -> None:
    seen = diagnosis.traces.against["relative_humidity"]
    assert diagnosis.model.air == {"relative_humidity": pytest.approx(np.median(seen), rel=1e-5)}


def test_recorded_air_replaces_the_base_air_and_only_it(random: np.random.Generator) -> None:
    table = {
        "reading_m": 1.5 + random.normal(0, 1e-3, 40),
        "temperature_C": np.linspace(0, 30, 40),
        "pressure_hPa": np.linspace(900, 1000, 40),
    }
    base = echocal.Model("cramer", air={"relative_humidity": 0.6, "pressure": 101325.0})
    model = echocal.diagnose(table, base=base, reference_distance=1.5).model
    assert model.air == {"relative_humidity": 0.6, "pressure": 95000.0}


def test_plots_are_pictures_of_something(diagnosis: echocal.Diagnosis, tmp_path: Path) -> None:
    paths = save_diagnosis(diagnosis, tmp_path / "plots")
    assert [path.name for path in paths] == ["residuals.png", "gain.png", "posterior.png", "next.png"]
    for path in paths[:3]:  # nothing may be left to measure
        picture = matplotlib.image.imread(path)
        assert picture[..., :3].std() > 0.02


def test_command_line_writes_what_it_is_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "diagnosis.json"
    done = diagnosed(str(TABLE), "--json", str(out))
    assert done.returncode == 0, done.stderr
    assert "fixed_speed" in done.stdout
    assert json.loads(out.read_text())["causes"][0]["id"] == "fixed_speed"


@pytest.mark.slow
def test_command_line_can_be_quiet_and_pipe() -> None:
    quiet = diagnosed(str(TABLE), "--quiet")
    assert (quiet.returncode, quiet.stdout) == (0, "")
    piped = diagnosed(str(TABLE), "--json", "-")
    assert json.loads(piped.stdout)["verdict"] == "named"


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("--reference-distance", "2", "--constant-distance"), 2, "not both"),
        (("--hold-out-after", "2022-07-20"), 2, "no column of times"),
        (("--hold-out-after", "5"), 2, "no column of times"),
        (("--column", "reading_m"), 2, "neither a pair"),
        (("--base", "linaer"), 2, "linear"),
        (("--missing", "nowhere=-9", "--missing", "7"), 2, "which is not there"),
        (("--reference-distance", "0"), 2, "give 0 < distance <= 100"),
        (("--reading-speed", "banana"), 2, "unknown law 'banana'"),
        (("--base", "0"), 2, "a speed of 0 m/s; give a positive one"),
        (("--decimal", "xx"), 2, "neither '.' nor ','"),
        (("--json", "absent/x.json"), 2, "absent/x.json cannot be written: there is no folder absent"),
        (("--plots", str(TABLE)), 2, "cannot be written"),
    ],
)
def test_bad_requests_are_one_line(
    arguments: tuple[str, ...], code: int, words: str, run: Callable[..., tuple[int, str]]
) -> None:
    found, said = run("diagnose", str(TABLE), *arguments)
    assert found == code
    assert words in said
    assert said.count("\n") == 1


def test_a_table_without_reference_says_what_to_do() -> None:
    data = {"reading_m": np.ones(20), "temperature_C": np.arange(20.0)}
    with pytest.raises(echocal.UsageError, match="constant_distance=True"):
        echocal.diagnose(data)


def test_too_few_rows() -> None:
    data = {"reading_m": [1.0, 1.1], "temperature_C": [10.0, 20.0]}
    with pytest.raises(echocal.DataError, match="at least 8"):
        echocal.diagnose(data, reference_distance=1.0)


def test_far_rows_are_left_out_and_counted() -> None:
    random = np.random.default_rng(7)
    temperature = np.linspace(0, 30, 200)
    reading = 1.5 + random.normal(0, 1e-3, 200)
    reading[[20, 90]] = 3.2, 0.4
    diagnosis = echocal.diagnose({"reading_m": reading, "temperature_C": temperature}, reference_distance=1.5)
    assert diagnosis.rows["used"] == 198
    assert sum(diagnosis.rows["unusable"].values()) == 2
    assert diagnosis.verdict == "nothing"
    assert len(diagnosis.traces.row) == 198


def test_rows_outside_a_domain_are_rows_of_the_table(random: np.random.Generator) -> None:
    temperature = np.linspace(0, 30, 60)
    temperature[[1, 49]] = np.nan, 65.0
    table = {"reading_m": 1.5 + random.normal(0, 1e-3, 60), "temperature_C": temperature}
    table["humidity_percent"] = np.full(60, 10.0)
    diagnosis = echocal.diagnose(table, base="cramer", reference_distance=1.5)
    assert any("first at row 50 (row 1 is the first): 65" in note for note in diagnosis.notes), (
        diagnosis.notes
    )


def test_a_jump_of_the_level_is_a_step() -> None:
    random = np.random.default_rng(7)
    reading = 1.5 + random.normal(0, 1e-3, 300) + 0.02 * (np.arange(300) >= 170)
    temperature = 20 + 5 * np.sin(np.arange(300) / 30)
    diagnosis = echocal.diagnose({"reading_m": reading, "temperature_C": temperature}, constant_distance=True)
    assert diagnosis.rows["level_steps_at_rows"] == [171]  # row 1 is the first, as in messages
    (step,) = diagnosis.to_dict()["rows"]["level_steps"]
    assert step["row"] == 171
    assert step["time"] is None
    assert step["size_m"] == pytest.approx(0.02, abs=1.5e-3)
    assert diagnosis.verdict == "nothing"


def test_reference_distances_that_are_not_used_are_told(random: np.random.Generator) -> None:
    table = {"reading_m": 1.5 + random.normal(0, 1e-3, 80), "temperature_C": np.linspace(5, 30, 80)}
    table["distance_m"] = np.repeat([1.5, 1.6], 40)
    diagnosis = echocal.diagnose(table, constant_distance=True)
    assert any("(1.5 to 1.6 m) are not used" in note for note in diagnosis.notes)


@pytest.mark.slow
def test_command_line_writes_a_model_that_is_a_base(tmp_path: Path) -> None:
    model = tmp_path / "model.json"
    assert diagnosed(str(TABLE), "--save-model", str(model), "--quiet").returncode == 0
    loaded = echocal.Model.load(model)
    assert list(loaded.effects) == ["fixed_speed"]
    assert loaded.standard_uncertainties["fixed_speed.weight"] == 0.0  # theory fixes it
    assert loaded.standard_uncertainties["fixed_speed.speed"] == pytest.approx(0.12, abs=0.06)
    again = diagnosed(str(TABLE), "--base", str(model), "--json", "-")
    assert json.loads(again.stdout)["verdict"] == "nothing", again.stderr


def test_each_of_a_few_distances_has_its_own_mean(random: np.random.Generator) -> None:
    distance = np.repeat([0.4, 1.0, 1.8, 3.0], 15)
    table = {"reading_m": distance + random.normal(0, 1e-3, 60), "distance_m": distance}
    diagnosis = echocal.diagnose({**table, "temperature_C": np.tile(np.linspace(5, 30, 15), 4)})
    ax = Figure().add_subplot()
    chart = column_chart(diagnosis, "distance")
    draw_panel(chart.panels[0], chart.x, ax)
    means = [np.asarray(line.get_xdata()) for line in ax.lines if line.get_linestyle() == "-"]
    assert any(np.allclose(x, [0.4, 1.0, 1.8, 3.0]) for x in means if len(x) == 4)
