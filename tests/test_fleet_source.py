"""The logs of sensors are gathered from files of any kind and any order."""

import gzip
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fleet_logs
import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

from echocal.errors import DataError
from echocal.fleet.gather import Log, logs
from echocal.fleet.index import Index, files_of, indexed
from echocal.fleet.store import is_spilled, plan_spills, run_spill
from echocal.fleet.task import tasks_of
from echocal.model.folder import named
from echocal.observations.layout import Layout

LAYOUT = Layout()


@pytest.fixture
def table(random: np.random.Generator) -> pl.DataFrame:
    return fleet_logs.fleet(random, [0.0, 0.0, 0.0], rows=30)


def index_of(folder: Path, by: str | None = "sensor_id", kind: str | None = None) -> Index:
    return indexed(files_of([folder]).sources, by, kind, LAYOUT)


def gathered(
    folder: Path,
    by: str | None = "sensor_id",
    requests: Mapping[str, str] | None = None,
    kind: str | None = None,
) -> dict[str, Log]:
    sensors = index_of(folder, by, kind).sensors
    found = {}
    for task in tasks_of(sensors, named(sensor.key for sensor in sensors), by, {}, 1 << 30):
        for sensor, log in logs(task["sensors"], by, kind, requests or {}, LAYOUT, "UTC"):
            found[sensor["key"]] = log
    return found


def own(table: pl.DataFrame, key: int) -> pl.DataFrame:
    return table.filter(pl.col("sensor_id") == key).drop("sensor_id")


def assert_same(found: Mapping[str, Log], table: pl.DataFrame) -> None:
    assert sorted(found) == ["1", "2", "3"]
    for key, log in found.items():
        assert not log.error
        assert_frame_equal(pl.DataFrame(log.columns), own(table, int(key)), check_dtypes=False)


def write(table: pl.DataFrame, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    table.write_parquet(path)


def test_one_file_with_all_sensors(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table, tmp_path / "all.parquet")
    found = gathered(tmp_path)
    assert_same(found, table)
    assert all(log.notes == () and log.repeated == 0 for log in found.values())


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1)])
def test_a_log_in_several_files_is_in_the_order_of_time_whatever_their_names(
    tmp_path: Path, table: pl.DataFrame, order: tuple[int, ...]
) -> None:
    for name, part in zip("abc", order, strict=True):
        write(table[30 * part : 30 * (part + 1)], tmp_path / f"{name}.parquet")
    found = gathered(tmp_path)
    assert_same(found, table)
    assert all(log.notes == () for log in found.values())


def test_a_tree_of_partitions(tmp_path: Path, table: pl.DataFrame) -> None:
    for key in (1, 2, 3):
        for part in (1, 0):
            write(
                own(table, key)[15 * part : 15 * part + 15], tmp_path / f"sensor_id={key}" / f"{part}.parquet"
            )
    assert_same(gathered(tmp_path), table)


def test_each_file_is_a_sensor_where_no_key_is_asked_for(tmp_path: Path, table: pl.DataFrame) -> None:
    for key in (1, 2, 3):
        write(own(table, key), tmp_path / f"{key}.parquet")
    assert_same(gathered(tmp_path, None), table)


def test_files_of_the_same_name_are_told_apart_by_their_folders(tmp_path: Path, table: pl.DataFrame) -> None:
    for key in (1, 2):
        write(own(table, key), tmp_path / f"tank{key}" / "log.parquet")
    assert [s.key for s in index_of(tmp_path, None).sensors] == ["tank1/log.parquet", "tank2/log.parquet"]


def test_text_files_gzipped_or_not_are_read_as_one_table_is(tmp_path: Path, table: pl.DataFrame) -> None:
    table[:45].write_csv(tmp_path / "a.csv")
    (tmp_path / "b.csv.gz").write_bytes(gzip.compress(table[45:].write_csv().encode()))
    found = gathered(tmp_path)
    assert sorted(found) == ["1", "2", "3"]
    for key, log in found.items():
        expected = own(table, int(key))["echo_us"].to_numpy()
        assert np.array_equal(np.asarray(log.columns["echo_us"], dtype=float), expected)


def test_overlapping_files_are_put_in_the_order_of_time_and_said(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table[::2], tmp_path / "even.parquet")
    write(table[1::2], tmp_path / "odd.parquet")
    found = gathered(tmp_path)
    assert_same(found, table)
    assert any("its files overlap in time" in note for note in found["1"].notes)


def test_rows_that_stand_in_two_files_are_used_once_and_said(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table[:60], tmp_path / "a.parquet")
    write(table[30:], tmp_path / "b.parquet")
    found = gathered(tmp_path)
    assert_same(found, table)
    assert [log.repeated for log in found.values()] == [10, 10, 10]
    assert "10 rows stand in two of its files and are used once" in found["2"].notes


def test_equal_rows_of_one_file_stay(tmp_path: Path, table: pl.DataFrame) -> None:
    again = pl.concat([table[:30], table[27:30], table[27:30]])
    write(again, tmp_path / "a.parquet")
    write(table[30:], tmp_path / "b.parquet")
    found = gathered(tmp_path)
    assert [log.repeated for log in found.values()] == [0, 0, 0]
    assert sum(len(log.columns["echo_us"]) for log in found.values()) == len(table) + 6


@pytest.mark.parametrize("kind", [pl.Int32, pl.Float64, pl.String, pl.Categorical])
def test_a_key_is_the_same_text_whatever_its_type_is(tmp_path: Path, table: pl.DataFrame, kind: Any) -> None:
    key = pl.col("sensor_id").cast(pl.String) if kind == pl.Categorical else pl.col("sensor_id")
    write(table.with_columns(key.cast(kind)), tmp_path / "a.parquet")
    assert [sensor.key for sensor in index_of(tmp_path).sensors] == ["1", "2", "3"]


def test_a_file_whose_keys_have_another_type_joins_the_others(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table[:45], tmp_path / "a.parquet")
    write(table[45:].with_columns(pl.col("sensor_id").cast(pl.Float64)), tmp_path / "b.parquet")
    assert_same(gathered(tmp_path), table)


def test_rows_without_a_key_are_counted(tmp_path: Path, table: pl.DataFrame) -> None:
    holed = table.with_columns(
        pl.when(pl.int_range(pl.len()) < 7).then(None).otherwise("sensor_id").alias("sensor_id")
    )
    write(holed, tmp_path / "a.parquet")
    found = index_of(tmp_path)
    assert found.unlabeled == 7
    assert "7 rows have no 'sensor_id' and belong to no sensor" in found.notes


def test_a_file_that_cannot_be_read_is_set_aside(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table, tmp_path / "a.parquet")
    (tmp_path / "b.parquet").write_bytes((tmp_path / "a.parquet").read_bytes()[:-100])
    found = index_of(tmp_path)
    assert len(found.sensors) == 3
    assert len(found.broken) == 1
    assert "b.parquet cannot be read" in found.notes[0]


def test_a_column_that_some_files_lack_is_said(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table[:45], tmp_path / "a.parquet")
    write(table[45:].drop("relative_humidity"), tmp_path / "b.parquet")
    found = gathered(tmp_path)
    assert found["1"].notes == ("some of its 2 files have no column 'relative_humidity'",)


def test_files_whose_columns_do_not_fit_fail_the_sensor(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table[:45], tmp_path / "a.parquet")
    write(table[45:].with_columns(pl.lit(True).alias("time")), tmp_path / "b.parquet")
    assert "its files have columns of different types" in gathered(tmp_path)["1"].error


def test_kinds_come_from_a_column_or_a_folder(tmp_path: Path, table: pl.DataFrame) -> None:
    named_kind = pl.when(pl.col("sensor_id") == 3).then(pl.lit("radar")).otherwise(pl.lit("tank"))
    write(table.with_columns(named_kind.alias("type")), tmp_path / "place=a" / "a.parquet")
    assert [sensor.kind for sensor in index_of(tmp_path, kind="type").sensors] == ["tank", "tank", "radar"]
    assert {sensor.kind for sensor in index_of(tmp_path, kind="place").sensors} == {"a"}
    assert "type" not in gathered(tmp_path, kind="type")["1"].columns


def test_a_sensor_of_two_kinds_is_refused(tmp_path: Path, table: pl.DataFrame) -> None:
    for part, kind in enumerate(("tank", "snow")):
        write(table[45 * part :][:45].with_columns(pl.lit(kind).alias("type")), tmp_path / f"{part}.parquet")
    with pytest.raises(DataError, match="sensor 1 has several kinds in 'type': snow, tank; give it one"):
        index_of(tmp_path, kind="type")


def test_a_key_that_is_not_there_is_refused(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table, tmp_path / "a.parquet")
    with pytest.raises(
        DataError,
        match=r"no column 'sensor', and no folder .* is named sensor=...; did you mean .* It has time",
    ):
        index_of(tmp_path, "sensor")


def test_a_key_without_a_value_is_refused(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table.with_columns(pl.lit(None, pl.Int64).alias("sensor_id")), tmp_path / "a.parquet")
    with pytest.raises(DataError, match="column 'sensor_id' is empty in every row of 1 files"):
        index_of(tmp_path)


def test_a_path_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no file .*absent"):
        files_of([tmp_path / "absent"])


@pytest.mark.parametrize("most", [7, 40, 1000])
@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_files_that_are_divided_first_give_the_same_logs(
    tmp_path: Path, table: pl.DataFrame, most: int, ending: str
) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    parts = [table[60:], table[30:70], table[:30].with_columns(pl.lit(1.0).alias("supply_V"))]
    for name, part in zip("abc", parts, strict=True):
        (part.write_parquet if ending == "parquet" else part.write_csv)(folder / f"{name}.{ending}")
    sensors = index_of(folder).sensors
    job = {"by": "sensor_id", "kind": None, "store": str(tmp_path / "store"), "layout": LAYOUT.__dict__}
    tasks = tasks_of(sensors, named(sensor.key for sensor in sensors), "sensor_id", job, 400)
    assert len(tasks) == 3
    spills = plan_spills(sensors, [*tasks, *tasks], job, most)
    assert spills
    for spill in json.loads(json.dumps(spills)):
        assert not is_spilled(tmp_path / "store", spill["number"])
        run_spill(spill)
        assert is_spilled(tmp_path / "store", spill["number"])
    direct = gathered(folder)
    for task in json.loads(json.dumps(tasks)):
        bucket = (tmp_path / "store", task["bucket"])
        for sensor, log in logs(task["sensors"], "sensor_id", None, {}, LAYOUT, "UTC", bucket):
            other = direct[sensor["key"]]
            assert (log.notes, log.repeated) == (other.notes, other.repeated)
            assert_frame_equal(pl.DataFrame(log.columns), pl.DataFrame(other.columns))


def test_a_file_that_breaks_while_it_is_divided_fails_its_sensors_only(
    tmp_path: Path, table: pl.DataFrame
) -> None:
    folder = tmp_path / "logs"
    write(table.filter(pl.col("sensor_id") != 2)[:, ::-1], folder / "a.parquet")
    write(table.filter(pl.col("sensor_id") == 2), folder / "b.parquet")
    sensors = index_of(folder).sensors
    job = {"by": "sensor_id", "kind": None, "store": str(tmp_path / "store"), "layout": LAYOUT.__dict__}
    tasks = tasks_of(sensors, named(sensor.key for sensor in sensors), "sensor_id", job, 400)
    content = bytearray((folder / "b.parquet").read_bytes())
    content[4:200] = bytes(196)
    (folder / "b.parquet").write_bytes(content)
    for spill in plan_spills(sensors, tasks * 4, job, 1000):
        run_spill(spill)
    found = {}
    for task in tasks:
        for sensor, log in logs(
            task["sensors"], "sensor_id", None, {}, LAYOUT, "UTC", (tmp_path / "store", task["bucket"])
        ):
            found[sensor["key"]] = log.error
    assert "b.parquet cannot be read" in found["2"]
    assert (found["1"], found["3"]) == ("", "")


def test_a_tree_of_partitions_is_not_divided(tmp_path: Path, table: pl.DataFrame) -> None:
    for key in (1, 2, 3):
        write(own(table, key), tmp_path / f"sensor_id={key}" / "a.parquet")
    sensors = index_of(tmp_path).sensors
    job = {"by": "sensor_id", "kind": None, "layout": LAYOUT.__dict__}
    assert (
        plan_spills(
            sensors,
            tasks_of(sensors, named(sensor.key for sensor in sensors), "sensor_id", job, 400),
            job,
            10,
        )
        == []
    )


def test_tasks_are_as_large_as_the_memory_allows(tmp_path: Path, table: pl.DataFrame) -> None:
    write(table, tmp_path / "a.parquet")
    sensors = index_of(tmp_path).sensors
    assert [
        len(t["sensors"])
        for t in tasks_of(sensors, named(sensor.key for sensor in sensors), "sensor_id", {}, 1 << 30)
    ] == [3]
    assert [
        len(t["sensors"])
        for t in tasks_of(sensors, named(sensor.key for sensor in sensors), "sensor_id", {}, 400 * 60)
    ] == [2, 1]
