"""Tables of the virtual bench: the function, the command, and what they refuse."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.errors import UsageError
from echocal.virtual_bench import CAUSES, DESIGNS, Sensor, simulate
from echocal.virtual_bench.campaign.campaign import Random
from echocal.virtual_bench.campaign.designs import lay_down
from echocal.virtual_bench.campaign.simulate import offers


def run(*words: object) -> tuple[int, str]:
    told = CliRunner().invoke(app, ["simulate", *map(str, words)])
    return told.exit_code, str(told.exception or "") + told.output


@pytest.mark.parametrize("design", list(DESIGNS))
def test_a_table_of_each_design_is_read_and_diagnosed_without_a_word_more(
    design: str, tmp_path: Path, random: np.random.Generator
) -> None:
    out = tmp_path / "log.csv"
    code, told = run("--design", design, "--seed", random.integers(2**31), "-o", out)
    assert code == 0, told
    read = echocal.read_observations(out)
    assert len(read) == len(pd.read_csv(out))
    assert ("--constant-distance" in told) == (read.reference_distance is None)


@pytest.mark.parametrize("name", list(CAUSES))
def test_every_cause_is_staged_by_its_name(name: str, tmp_path: Path) -> None:
    out, size = tmp_path / "log.csv", CAUSES[name].high
    design = next(d for d in DESIGNS if CAUSES[name].needs <= offers(simulate(d).campaign))
    code, told = run(
        "--design", design, "--cause", f"{name}={size}", "-o", out, "--json", tmp_path / "truth.json"
    )
    assert code == 0, told
    (staged,) = json.loads((tmp_path / "truth.json").read_text())["causes"]
    assert (staged["id"], staged["size"]) == (name, size)
    assert not simulate(design, {name: size}).table.equals(simulate(design).table)


def test_the_seed_is_the_table_and_a_replicate_has_other_noise(random: np.random.Generator) -> None:
    seed = int(random.integers(2**31))
    first, again = (simulate("quick", {"fixed_delay": 5e-5}, seed=seed) for _ in range(2))
    assert first.table.equals(again.table)
    other = simulate("quick", {"fixed_delay": 5e-5}, seed=seed, replicate=1)
    assert not first.table.equals(other.table)
    assert np.ptp(first.campaign.distance - other.campaign.distance) < 2e-3, "the same places"


def test_another_sensor_may_measure() -> None:
    deaf = simulate("bench", sensor=Sensor().but(threshold=10.0))
    assert np.isnan(deaf.echoes.time).mean() > 0.9
    assert np.isnan(simulate("bench").echoes.time).mean() < 0.1


def test_a_cause_that_needs_days_is_staged_in_an_evening_and_a_note_says_so(tmp_path: Path) -> None:
    code, told = run("--design", "bench", "--cause", "temperature_lag=600", "-o", tmp_path / "log.csv")
    assert code == 0
    assert "temperature_lag hardly shows in the design 'bench'" in told
    code, told = run("--design", "warehouse", "--cause", "temperature_lag=600", "-o", tmp_path / "other.csv")
    assert code == 0
    assert "hardly" not in told


def test_a_reading_of_the_device_gets_stuck_as_an_echo_time_does() -> None:
    table = simulate("quick", {"fixed_speed": None, "stuck_reading": None}).table
    assert table["reading_cm"].value_counts().max() >= 8


def test_a_waveform_is_drawn_and_a_parquet_file_holds_the_table(tmp_path: Path) -> None:
    picture, out = tmp_path / "heard.png", tmp_path / "log.parquet"
    code, told = run("--design", "quick", "--row", 7, "--waveform", picture, "-o", out)
    assert code == 0, told
    assert picture.read_bytes().startswith(b"\x89PNG")
    pd.testing.assert_frame_equal(pd.read_parquet(out), simulate("quick").table)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "simulate needs a design"),
        (["--design", "bnch"], "there is no design 'bnch'; there are bench"),
        (["--design", "bench", "--cause", "temprature_lag"], "cannot stage 'temprature_lag'; it stages"),
        (["--design", "bench", "--cause", "wind"], "'wind' needs open air, which the design 'bench' has not"),
        (["--design", "bench", "--cause", "drift=1cm"], "'1cm' is no number"),
        (["--design", "bench", "--cause", "drift", "--cause", "drift"], "given twice"),
        (["--design", "bench", "--detector", "perfect"], "'comparator' or 'ideal', not 'perfect'"),
        (["--design", "bench", "--row", "401", "--waveform", "x.png"], "401"),
        (["--design", "bench", "--cause", "drift=nan"], "nan"),
        (
            ["--design", "quick", "--cause", "fixed_speed", "--cause", "divisor"],
            "two causes say how the device",
        ),
        (["--design", "bench", "--cause", "divisor=1e-300"], "divisor=1e-300: its size is"),
        (["--design", "bench", "--cause", "divisor=58.4"], "divisor=58.4: its size is a whole number"),
        (["--design", "bench", "--waveform", "x.gif"], "x.gif has the ending '.gif'; a plot is .png"),
        (["--design", "bench", "--waveform", "x"], "x has no ending; a plot is .png"),
    ],
)
def test_what_is_refused(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, told = run(*words, "-o", "log.csv")
    assert code != 0
    assert said in told
    assert not list(tmp_path.iterdir()), "nothing is written"
    assert CliRunner().invoke(app, ["simulate", *words, "-o", "log.csv"]).exit_code in (1, 2)


def test_a_file_of_another_kind_is_not_replaced(tmp_path: Path) -> None:
    out = tmp_path / "log.csv"
    out.write_text("mine\n")
    code, told = run("--design", "quick", "-o", out)
    assert code != 0
    assert "--force" in told
    assert out.read_text() == "mine\n"


@pytest.mark.parametrize("ending", ["CSV", "Parquet"])
def test_an_ending_in_capitals_is_the_same(ending: str, tmp_path: Path) -> None:
    code, told = run("--design", "quick", "-o", tmp_path / f"log.{ending}")
    assert code == 0, told


@pytest.mark.parametrize("wrong", [{"seed": -1}, {"seed": 1.5}, {"seed": "a"}, {"replicate": -1}])
def test_a_seed_is_a_whole_number(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="give a whole number of 0 or more"):
        simulate("quick", **wrong)


@pytest.mark.parametrize("size", ["1", [1.0], 1j, True])
def test_a_size_is_a_number(size: Any) -> None:
    with pytest.raises(UsageError, match="its size is a number"):
        simulate("quick", {"zero_error": size})


@pytest.mark.parametrize("name", sorted(CAUSES))
def test_no_size_is_too_small_to_be_computed(name: str) -> None:
    """The least size that is accepted gives a table of finite numbers or gaps."""
    design = next(one for one in DESIGNS if not CAUSES[name].refused(offers(lay_down(one, Random(0)))))
    least = 1.0 if CAUSES[name].whole else 1e-6 * CAUSES[name].high
    made = simulate(design, {name: least})
    assert not np.isinf(made.table.select_dtypes("number").to_numpy(dtype=float)).any()
    with pytest.raises(UsageError, match="its size is from"):
        simulate(design, {name: 1e-9 * CAUSES[name].high})
