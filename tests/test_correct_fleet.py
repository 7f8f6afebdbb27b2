"""Folders, globs, partitions, and one model for each sensor."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files, correct_table
from echocal.correct.batch import in_bytes
from echocal.correct.inputs import find_inputs
from echocal.model.folder import file_name

OFFSETS = {"1": 0.0, "2": 5e-3, "tank 7/a": -3e-3}


def model_of(offset: float) -> echocal.Model:
    return echocal.Model("linear", {"zero_error": {"offset": offset}})


@pytest.fixture
def models(tmp_path: Path) -> Path:
    folder = tmp_path / "models"
    folder.mkdir()
    for key, offset in OFFSETS.items():
        model_of(offset).save(folder / file_name(key))
    return folder


def echoes(random: np.random.Generator, rows: int = 60) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
            "temperature_C": np.round(random.uniform(0, 30, rows), 2),
        }
    )


def distances(path: Path) -> np.ndarray:
    return pq.ParquetFile(path).read(["corrected_distance_m"])[0].to_numpy()


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_one_model_for_each_key_of_a_row(
    ending: str, models: Path, tmp_path: Path, random: np.random.Generator
) -> None:
    table = echoes(random)
    keys = random.choice([*OFFSETS, "unknown", ""], len(table))
    table["sensor_id"] = keys
    if ending == "csv":
        table.to_csv(tmp_path / "in.csv", index=False)
    else:
        table.to_parquet(tmp_path / "in.parquet", row_group_size=17)
    out = tmp_path / f"out.{ending}"
    summary = correct_files(tmp_path / f"in.{ending}", out, models=models, by="sensor_id")
    found = pd.read_csv(out) if ending == "csv" else pd.read_parquet(out)
    for key, offset in OFFSETS.items():
        own = correct_table(table[keys == key], model_of(offset)).table["corrected_distance_m"]
        np.testing.assert_allclose(found["corrected_distance_m"][keys == key], own, rtol=0, atol=6e-10)
    assert (found["status"][keys == "unknown"] == "no model for this key").all()
    assert (found["status"][keys == ""] == "no key").all()
    (result,) = summary.results.values()
    assert result["unusable"]["no model for this key"] == (keys == "unknown").sum()


def test_numbers_as_keys(models: Path, tmp_path: Path, random: np.random.Generator) -> None:
    table = echoes(random, 4).assign(sensor_id=pd.array([1, 2, None, 1], "Int64"))
    table.to_parquet(tmp_path / "in.parquet")
    table.to_csv(tmp_path / "in.csv", index=False)
    for ending in ("parquet", "csv"):
        summary = correct_files(
            tmp_path / f"in.{ending}", tmp_path / f"out.{ending}", models=models, by="sensor_id"
        )
        assert next(iter(summary.results.values()))["unusable"] == {"no key": 1}


def test_partitions_are_keys(models: Path, tmp_path: Path, random: np.random.Generator) -> None:
    table = echoes(random)
    for name in ("1", "2", "tank%207%2Fa"):
        folder = tmp_path / "in" / f"sensor_id={name}" / "year=2026"
        folder.mkdir(parents=True)
        table.to_parquet(folder / "a.PARQUET")
        table.to_parquet(folder / "b.pq")
    summary = correct_files(tmp_path / "in", tmp_path / "out", models=models, by="sensor_id")
    assert len(summary.results) == 6
    for key, name in (("1", "1"), ("2", "2"), ("tank 7/a", "tank%207%2Fa")):
        wanted = correct_table(table, model_of(OFFSETS[key])).table["corrected_distance_m"]
        for file in ("a.PARQUET", "b.pq"):
            found = distances(tmp_path / "out" / f"sensor_id={name}" / "year=2026" / file)
            np.testing.assert_array_equal(found, wanted)


def test_an_index_names_the_files(models: Path, tmp_path: Path, random: np.random.Generator) -> None:
    table = echoes(random, 5).assign(sensor_id="front door")
    table.to_parquet(tmp_path / "in.parquet")
    index = {"schema": "echocal.models/1", "models": {"front door": "2.json"}}
    (models / "index.json").write_text(json.dumps(index))
    correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", models=models, by="sensor_id")
    wanted = correct_table(table, model_of(OFFSETS["2"])).table["corrected_distance_m"]
    np.testing.assert_array_equal(distances(tmp_path / "out.parquet"), wanted)
    (models / "index.json").write_text("[]")
    with pytest.raises(echocal.ModelError, match=r"index.json is no index of models"):
        correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", models=models, by="sensor_id")


def test_two_keys_of_one_file_are_refused(models: Path, tmp_path: Path, random: np.random.Generator) -> None:
    table = echoes(random, 2).assign(sensor_id=["tank 7/a", "tank_7_a"])
    table.to_parquet(tmp_path / "in.parquet")
    with pytest.raises(echocal.DataError, match=r"would have the same model file tank_7_a\.json"):
        correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", models=models, by="sensor_id")


def test_rows_of_several_sensors_are_no_log(
    models: Path, tmp_path: Path, random: np.random.Generator
) -> None:
    echocal.Model("linear", {"drift": {"rate": 1e-8}}).save(models / "1.json")
    table = echoes(random, 4).assign(sensor_id=[1, 2, 1, 2], time_s=[0.0, 1.0, 2.0, 3.0])
    table.to_parquet(tmp_path / "in.parquet")
    with pytest.raises(echocal.DataError, match=r"several sensors.*drift.*one file for each sensor_id"):
        correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", models=models, by="sensor_id")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "give one model"),
        ({"models": "absent", "by": "sensor_id"}, "is no folder of models"),
        ({"models": "."}, "needs by='COLUMN'"),
        ({"model": model_of(0.0), "memory": "much"}, "is no amount of memory"),
        ({"model": model_of(0.0), "memory": "10MB"}, "too little"),
        ({"model": model_of(0.0), "round_mm": 0.0}, "is no step"),
        ({"model": model_of(0.0), "logs": "none"}, "is not one of file, key, all"),
        ({"model": model_of(0.0), "speed": "343"}, "unexpected keyword argument 'speed'"),
        ({"model": model_of(0.0), "append_only": ["serial"]}, "there is no column 'serial'"),
    ],
)
def test_requests_that_are_refused(
    options: dict[str, object], message: str, tmp_path: Path, random: np.random.Generator
) -> None:
    echoes(random, 3).to_parquet(tmp_path / "in.parquet")
    with pytest.raises((echocal.EchocalError, TypeError), match=message):
        correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", **options)  # type: ignore[arg-type]
    assert not (tmp_path / "out.parquet").exists()


def test_what_is_left_out_is_said_once(
    tmp_path: Path, random: np.random.Generator, run: Callable[..., tuple[int, str, str]]
) -> None:
    logs = Path("logs")
    (logs / "_temporary").mkdir(parents=True)
    echoes(random).to_parquet(logs / "a.parquet")
    echoes(random).assign(battery_V=3.0).to_parquet(logs / "b.parquet")
    echoes(random).to_csv(logs / "c.csv", index=False)
    for name in ("_SUCCESS", ".a.parquet.crc", "_temporary/x.parquet", "notes.md"):
        (logs / name).write_text("x")
    told = run("correct", "logs", "-o", "out", "--law", "cramer")
    assert told[0] == 0
    notes = told[-1].splitlines()
    assert sum("begins with . or _" in note and "3 files" in note for note in notes) == 1
    assert sum("1 file (logs/notes.md), of another kind" in note for note in notes) == 1
    assert sum("(dry air) (all 3 files)" in note for note in notes) == 1
    differ = [note for note in notes if "columns differ" in note]
    assert len(differ) == 1, "a text has no types, and is no other table than Parquet with the same names"
    assert "columns differ between files: logs/b.parquet has battery_V" in differ[0]
    echoes(random).astype({"echo_us": "float32"}).to_parquet(logs / "b.parquet")
    notes = run("correct", "logs", "-o", "out", "--law", "cramer")[-1].splitlines()
    differ = [note for note in notes if "columns differ" in note]
    assert len(differ) == 1
    assert "logs/b.parquet has echo_us (float) and lacks echo_us (double)" in differ[0]


def test_globs(tmp_path: Path, random: np.random.Generator) -> None:
    for name in ("a/1.csv", "a/2.csv", "b/1.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        echoes(random).to_csv(tmp_path / name, index=False)
    assert [str(f.place) for f in find_inputs(tmp_path / "*" / "1.csv").files] == ["a/1.csv", "b/1.csv"]
    assert [str(f.place) for f in find_inputs(f"{tmp_path}/**/*.csv").files] == [
        "a/1.csv",
        "a/2.csv",
        "b/1.csv",
    ]
    with pytest.raises(echocal.DataError, match="has no file that can be corrected"):
        find_inputs(tmp_path / "*.pq")
    with pytest.raises(echocal.UsageError, match="lies in the input itself"):
        correct_files(tmp_path, tmp_path / "a" / "out", model_of(0.0))


def test_append_only_and_rounding(tmp_path: Path, random: np.random.Generator) -> None:
    table = echoes(random).assign(id=np.arange(60) + 2**60, remark="x")
    arrow = pa.Table.from_pandas(table)
    pq.write_table(arrow, tmp_path / "in.parquet", row_group_size=7)
    correct_files(
        tmp_path / "in.parquet", tmp_path / "out.parquet", model_of(0.0), append_only=["id"], round_mm=0.5
    )
    file = pq.ParquetFile(tmp_path / "out.parquet")
    assert file.schema_arrow.names[:2] == ["id", "corrected_distance_m"]
    assert file.read(["id"]).column(0).equals(arrow["id"])
    assert file.metadata.metadata[b"echocal.rounded_to_mm"] == b"0.5"
    wanted = correct_table(table, model_of(0.0)).table["corrected_distance_m"]
    np.testing.assert_array_equal(distances(tmp_path / "out.parquet"), np.round(wanted / 5e-4) * 5e-4)


def test_amounts_of_memory() -> None:
    assert in_bytes("512MB") == in_bytes(512 << 20) == in_bytes("0.5 GiB")


def test_a_log_of_a_key_may_lie_in_several_files(
    models: Path, tmp_path: Path, random: np.random.Generator
) -> None:
    device = echocal.Model("linear", {"drift": {"rate": 1e-7}})
    device.save(models / "1.json")
    table = echoes(random).assign(time_s=np.arange(60) * 3600.0)
    wanted = correct_table(table, device).table["corrected_distance_m"]
    for part in range(3):
        for folder, more in (("keys/sensor_id=1", {}), ("rows", {"sensor_id": 1})):
            (tmp_path / folder).mkdir(parents=True, exist_ok=True)
            table.iloc[20 * part : 20 * part + 20].assign(**more).to_parquet(tmp_path / folder / f"{part}.pq")
    for name, how in (("a", {"models": models}), ("b", {"model": device})):
        assert not correct_files(tmp_path / "keys", tmp_path / name, by="sensor_id", **how).set_aside
        found = [distances(tmp_path / name / "sensor_id=1" / f"{part}.pq") for part in range(3)]
        np.testing.assert_array_equal(np.concatenate(found), wanted)
    told = correct_files(tmp_path / "rows", tmp_path / "c", models=models, by="sensor_id").set_aside
    assert len(told) == 3
    assert all("a log may have several files" in why and "logs='file'" in why for why in told.values())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "out"), [("parquet", "parquet"), ("csv", "csv"), ("csv", "parquet"), ("parquet", "csv")]
)
def test_memory_stays_below_what_is_allowed(
    ending: str, out: str, tmp_path: Path, random: np.random.Generator
) -> None:
    """One row group of 3 million rows; a table of them in memory takes as much again."""
    rows = 3_000_000
    columns = {
        "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
        "temperature_C": np.round(random.uniform(0, 30, rows), 2),
        "humidity_percent": np.round(random.uniform(0, 90, rows), 1),
        **{f"other_{n}": random.uniform(0, 1, rows) for n in range(4)},
    }
    if ending == "parquet":
        pq.write_table(pa.table(columns), tmp_path / "in.parquet", row_group_size=rows)
    else:
        from pyarrow import csv

        csv.write_csv(pa.table(columns), tmp_path / "in.csv")
    run = (
        "import sys, echocal\n"
        "echocal.correct_files(sys.argv[1], sys.argv[2], echocal.Model('cramer'), memory='320MB')\n"
        "print(next(l for l in open('/proc/self/status') if l.startswith('VmHWM')).split()[1])\n"
    )
    command = [sys.executable, "-c", run, str(tmp_path / f"in.{ending}"), str(tmp_path / f"out.{out}")]
    told = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(told.stdout) / 1024 < 320
