"""``echocal diagnose FOLDER --by KEY -o TABLE``: verdicts, models, what is wrong, and what is refused."""

import json
from collections.abc import Callable
from pathlib import Path

import fleet_logs
import numpy as np
import polars as pl
import pytest

import echocal
from echocal.fleet.verdicts import COLUMNS
from echocal.model import Model
from echocal.model.folder import ModelFolder

Run = Callable[..., tuple[int, str]]
DELAYED = (1, 3, 5)


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> pl.DataFrame:
    """Two files with five sensors: three have a delay."""
    delays = [fleet_logs.DELAY if key in DELAYED else 0.0 for key in range(1, 6)]
    whole = fleet_logs.fleet(random, delays)
    (tmp_path / "logs").mkdir()
    whole[: len(whole) // 2].write_parquet(tmp_path / "logs" / "b.parquet")
    whole[len(whole) // 2 :].write_parquet(tmp_path / "logs" / "a.parquet")
    return whole


def spoil(folder: Path) -> None:
    """A sensor with too few rows, and one without a distance."""
    few = pl.read_parquet(folder / "a.parquet")[:3].with_columns(pl.lit(9, pl.Int64).alias("sensor_id"))
    few.write_parquet(folder / "c.parquet")
    bare = pl.read_parquet(folder / "a.parquet").filter(pl.col("sensor_id") == 1).drop("distance_m")
    bare.with_columns(pl.lit(10, pl.Int64).alias("sensor_id")).write_parquet(folder / "d.parquet")


@pytest.mark.slow
@pytest.mark.statistical  # a sensor may have a lag by chance: its log in two files is then not corrected
def test_each_sensor_has_its_verdict_and_the_line_closes(
    run: Run, tmp_path: Path, logs: pl.DataFrame
) -> None:
    code, said = run(
        "diagnose", "logs", "--by", "sensor_id", "--base", "cramer", "-o", "v.parquet", "--models", "models",
        "--results", "results", "--plots", "plots", "--json", "fleet.json", "--workers", "2", "--quiet",
    )  # fmt: skip
    assert (code, said) == (0, "")
    table = pl.read_parquet("v.parquet")
    assert table.columns == list(COLUMNS)
    assert table["sensor"].to_list() == ["1", "2", "3", "4", "5"]
    assert table["rows_used"].to_list() == [120] * 5
    assert table["files"].to_list() == [2] * 5
    for row in table.iter_rows(named=True):
        delayed = int(row["sensor"]) in DELAYED
        alone = echocal.diagnose(
            logs.filter(pl.col("sensor_id") == int(row["sensor"])).drop("sensor_id"), base="cramer"
        )
        assert row["verdict"] == alone.verdict
        assert row["model_hash"] == alone.model.hash == Model.load(f"models/{row['model']}").hash
        if delayed:
            first = alone.causes[0]
            assert row["cause"] == first.id
            assert set(row["class"]) == {first.id, *first.indistinguishable_from}
            assert row["class_probability"] == pytest.approx(first.probability, abs=1e-9)
            assert row["size"] == pytest.approx(first.parameters[0].value, rel=1e-9)
            assert row["rms_after_mm"] < row["rms_before_mm"]
            assert 0.0 <= row["fleet_probability"] <= row["fleet_class_probability"] <= 1.0
        saved = json.loads(Path("results", row["model"]).read_text())
        assert saved["schema"] == "echocal.diagnosis/1"
        assert saved["verdict"] == row["verdict"]
    whole = json.loads(Path("fleet.json").read_text())
    assert whole["schema"] == "echocal.fleet/1"
    assert sum(whole["verdicts"].values()) == whole["sensors"] == 5
    assert Path("plots/fleet.png").read_bytes().startswith(b"\x89PNG")
    assert not Path("v.parquet.parts").exists()
    folder = ModelFolder(Path("models"))
    assert folder.model("3") == Model.load("models/3.json")

    code, said = run(
        "correct", "logs", "-o", "corrected", "--models", "models", "--by", "sensor_id", "--quiet"
    )
    assert code == 0, said
    corrected = pl.read_parquet("corrected/*.parquet")
    off = corrected["corrected_distance_m"] - corrected["distance_m"]
    assert len(off) == len(logs)
    assert off.abs().mean() < 2e-3  # of 40 us, 7 mm


@pytest.mark.slow
def test_a_sensor_that_fails_is_a_row_and_the_exit_code_says_so(run: Run, logs: pl.DataFrame) -> None:
    spoil(Path("logs"))
    code, said = run("diagnose", "logs", "--by", "sensor_id", "--base", "cramer", "-o", "v.csv", "--quiet")
    assert code == 3
    assert "2 of 7 sensors could not be diagnosed, the others were; the first: 9: " in said
    assert len(said.splitlines()) == 1
    table = pl.read_csv("v.csv", schema_overrides={"sensor": pl.String})
    failed = table.filter(pl.col("verdict") == "failed")
    assert failed["sensor"].to_list() == ["9", "10"]
    few, bare = failed["reason"].to_list()
    assert "rows" in few
    assert "distance" in bare
    assert json.loads(table["causes"][0])[0]["parameters"]
    assert table.filter(pl.col("verdict") != "failed").height == 5


@pytest.mark.slow
def test_a_folder_needs_no_table_of_verdicts(run: Run, logs: pl.DataFrame) -> None:
    code, _ = run("diagnose", "logs/*.parquet", "--by", "sensor_id", "--base", "cramer", "--json", "f.json")
    assert code == 0
    assert json.loads(Path("f.json").read_text())["sensors"] == 5
    assert not list(Path().glob("*.parts"))


@pytest.mark.slow
def test_the_base_may_be_a_model_and_one_file_a_sensor(run: Run, logs: pl.DataFrame) -> None:
    Path("apart").mkdir()
    for key in (1, 2):
        logs.filter(pl.col("sensor_id") == key).drop("sensor_id").write_csv(f"apart/{key}.csv")
    base = Model("cramer", {"fixed_delay": {"delay": fleet_logs.DELAY}})
    base.save("base.json")
    code, said = run("diagnose", "apart", "--base", "base.json", "-o", "v.csv", "--models", "m", "--quiet")
    assert code == 0, said
    table = pl.read_csv("v.csv")
    assert table["sensor"].to_list() == [1, 2]
    assert table["rms_before_mm"][0] < 2.0  # its delay is in the base
    assert table["rms_before_mm"][1] > 5.0
    assert "fixed_delay" in Model.load("m/1.json").effects


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["-o", "v.txt"], "--output v.txt must end in .parquet or .csv"),
        (["-o", "v.csv", "--memory", "lots"], "--memory lots is no amount of memory"),
        (["-o", "v.csv", "--save-model", "m.json"], "--save-model is for one table, and this is a fleet"),
        (["-o", "v.csv", "--rows", "r.csv"], "--rows is for one table, and this is a fleet"),
        (["-o", "v.csv", "--can-vary", "distance=1:2"], "--can-vary is for one table, and this is a fleet"),
        (["-o", "v.csv", "--with-smooth"], "--with-smooth is for one table, and this is a fleet"),
        (["-o", "v.csv", "--with-shape"], "--with-shape is for one table, and this is a fleet"),
        (["-o", "v.csv", "--base", "warp"], "warp"),
        (["-o", "v.csv", "--reference-distance", "-1"], "-1"),
        (["-o", "absent/v.csv"], "there is no folder absent; make it first"),
        (["-o", "logs/a.parquet"], "is an input of this command"),
        (["-o", "mine.csv"], "--output mine.csv exists, and this command did not make it"),
        (["-o", "v.csv", "--models", "mine"], "--models mine/other.json exists, and this command did"),
        (["-o", "v.csv", "--json", "v.csv"], "both name v.csv"),
    ],
)  # fmt: skip
def test_a_bad_request_is_refused_before_the_work(
    run: Run, logs: pl.DataFrame, words: list[str], says: str
) -> None:
    Path("mine.csv").write_text("a,b\n1,2\n")
    Path("mine").mkdir()
    Path("mine/other.json").write_text('{"mine": 1}')
    code, said = run("diagnose", "logs", "--by", "sensor_id", *words)
    assert code == 2, said
    assert says in said
    assert "Traceback" not in said
    assert not list(Path().glob("*.parts"))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["absent", "--by", "sensor_id", "-o", "v.csv"], "no file absent"),
        (["empty", "--by", "sensor_id", "-o", "v.csv"], "empty has no file"),
        (["logs", "--by", "tank", "-o", "v.csv"], "has no column 'tank'"),
        (["logs", "--by", "sensor_id", "--kind", "type", "-o", "v.csv"], "has no column 'type'"),
    ],
)
def test_bad_data_are_refused(run: Run, logs: pl.DataFrame, words: list[str], says: str) -> None:
    Path("empty").mkdir()
    code, said = run("diagnose", *words)
    assert code == 3, said
    assert says in said


@pytest.mark.parametrize("option", ["--results", "--kind", "--workers"])
def test_options_of_a_fleet_are_refused_for_one_table(run: Run, logs: pl.DataFrame, option: str) -> None:
    code, said = run("diagnose", "logs/a.parquet", option, "2")
    assert code == 2
    assert f"{option} is for a fleet: give -o FILE, or a folder of logs" in said
