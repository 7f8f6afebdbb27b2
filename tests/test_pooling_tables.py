"""The tables of a pool: files, mappings, rows divided by a column; and the command."""

import io
import json
import pickle
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from pooled_tables import unit
from rich.console import Console

import echocal
from echocal.diagnose.pooling.source import sources_of
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.plots.several import plot_sizes
from echocal.report.several import print_pooled

Run = Callable[..., tuple[int, str]]


@pytest.fixture
def fleet(random: np.random.Generator) -> pd.DataFrame:
    """Three units, the rows of which alternate; two rows of a fourth, and one row without a label."""
    units = [pd.DataFrame(unit(random, 300.0, visible=8.0, rows=80)) for _ in range(3)]
    for number, table in zip((30, 7, 12), units, strict=True):
        table["sensor_id"] = number
    small = units[0].iloc[:2].assign(sensor_id=5)
    nobody = units[0].iloc[:1].assign(sensor_id=np.nan)
    return pd.concat([*units, small, nobody], ignore_index=True)


@pytest.mark.parametrize(
    "labels", [[3, 1, 3, 1], ["b", "a", "b", "a"], [3.5, 1.0, 3.5, 1.0], [True, False] * 2]
)
def test_labels_of_any_type_divide_the_rows_in_their_order(labels: list[object]) -> None:
    table = {"unit": labels, "reading_m": [1.0, 2.0, 3.0, 4.0]}
    found = sources_of(table, "unit", {"columns": None})
    assert [part["reading_m"].tolist() for part in found.tables.values()] == [[1.0, 3.0], [2.0, 4.0]]
    assert len(set(found.tables)) == 2
    assert found.how["columns"] == {"unit": "ignore"}


def test_numbers_with_gaps_are_whole(fleet: pd.DataFrame) -> None:
    found = sources_of(fleet, "sensor_id", {"columns": None})
    assert list(found.tables) == ["30", "7", "12", "5"]
    assert found.unlabeled == 1


def test_tables_that_are_too_small_are_listed_and_the_rest_proceeds(fleet: pd.DataFrame) -> None:
    found = echocal.diagnose_many(fleet, by="sensor_id")
    assert list(found.tables) == ["30", "7", "12"]
    small, nobody = found.skipped
    assert (small.name, small.rows) == ("5", 2)
    assert "at least 8 usable rows" in small.reason
    assert (nobody.name, nobody.rows) == ("(no label)", 1)
    assert "sensor_id" in nobody.reason


def test_an_absent_column_is_named_with_those_that_there_are(fleet: pd.DataFrame) -> None:
    with pytest.raises(DataError, match=r"no column 'sensor'.*It has reading_m, temperature_C.*sensor_id"):
        echocal.diagnose_many(fleet, by="sensor")
    with pytest.raises(DataError, match="'sensor_id' is empty in every row"):
        echocal.diagnose_many(fleet.assign(sensor_id=None), by="sensor_id")


def test_fewer_than_two_tables_are_no_pool(fleet: pd.DataFrame) -> None:
    one = fleet[fleet["sensor_id"].isin([30, 5])]
    with pytest.raises(DataError, match=r"at least 2 tables .* it has 1 \(5: a diagnosis needs at least 8"):
        echocal.diagnose_many(one, by="sensor_id")


def test_a_single_table_is_refused_with_the_way_out(fleet: pd.DataFrame) -> None:
    columns = {name: fleet[name].to_numpy() for name in fleet}
    with pytest.raises(UsageError, match=r"'reading_m' is a column, not a table.*by='COLUMN'"):
        echocal.diagnose_many(columns)
    with pytest.raises(UsageError, match="by= divides one table"):
        echocal.diagnose_many(fleet)


def test_files_have_their_names(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "log.csv").write_text("reading_m\n1\n")
    (tmp_path / "c.csv").write_text("reading_m\n1\n")
    one, other, third = (tmp_path / name for name in ("a/log.csv", "b/log.csv", "c.csv"))
    assert list(sources_of([one, third], None, {}).tables) == ["log", "c"]
    assert list(sources_of([one, other], None, {}).tables) == [str(one), str(other)]
    with pytest.raises(UsageError, match="given twice"):
        sources_of([one, one], None, {})
    with pytest.raises(DataError, match=r"no file .*nope\.csv"):
        sources_of([one, tmp_path / "nope.csv"], None, {})


def test_progress_counts_tables(fleet: pd.DataFrame) -> None:
    seen: list[tuple[str, int, int]] = []
    echocal.diagnose_many(fleet, by="sensor_id", progress=lambda *state: seen.append(state))
    assert [name for name, *_ in seen] == ["30", "7", "12", "5", "comparing tables"]
    assert [done for _, done, _ in seen] == [0, 1, 2, 3, 4]


def test_the_command_writes_models_plot_and_json(run: Run, fleet: pd.DataFrame) -> None:
    fleet.to_csv("fleet.csv", index=False)
    words = (
        "diagnose",
        "fleet.csv",
        "--by",
        "sensor_id",
        "--models",
        "models",
        "--plots",
        "plots",
        "--quiet",
    )
    assert run(*words, "--json", "found.json") == (0, "")
    assert sorted(file.name for file in Path("models").iterdir()) == [
        "12.json",
        "30.json",
        "7.json",
        "index.json",
        "shared.json",
    ]
    index = json.loads(Path("models/index.json").read_text())["models"]
    assert index == {key: f"{key}.json" for key in ("12", "30", "7")}
    code, said = run("correct", "fleet.csv", "-o", "out.csv", "--models", "models", "--by", "sensor_id")
    assert code == 3, "the models are found, by the ids 7.0 and 12.0 too"
    assert re.search(r"their models have temperature_(lag|timestamp_shift)", " ".join(said.split()))
    assert "which depends on the other rows of a log" in " ".join(said.split())
    found = json.loads(Path("found.json").read_text())
    assert found["schema"] == "echocal.pooled_diagnosis/1"
    shared = Model.load("models/shared.json")
    assert set(shared.effects) == {cause["id"] for cause in found["causes"] if cause["in_model"]}
    assert Path("plots/sizes.png").read_bytes().startswith(b"\x89PNG")
    assert run(*words)[0] == 0, "its own files are replaced"
    Path("models/7.json").write_text("{}")
    code, said = run(*words)
    assert code != 0
    assert "models/7.json exists" in said
    assert "--force" in said


def test_the_command_reads_several_files(run: Run, fleet: pd.DataFrame) -> None:
    for number, rows in list(fleet.groupby("sensor_id"))[1:3]:
        rows.drop(columns="sensor_id").to_csv(f"unit {number:.0f}.csv", index=False)
    assert run("diagnose", "unit 7.csv", "unit 12.csv", "--json", "found.json")[0] == 0
    names = [table["name"] for table in json.loads(Path("found.json").read_text())["tables"]]
    assert names == ["unit 7", "unit 12"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("--save-model", "m.json"),
            "--save-model is for one table, and several are given; give --models DIR",
        ),
        (("--models", "m", "--with-shape"), "--with-shape is for one table"),
        (("--rows", "rows.csv"), "--rows is for one table"),
        (("--hold-out-after", "2024"), "tables left out in turn"),
        (("--can-vary", "distance=1:2"), "--can-vary is for one table"),
        (("--by", "sensor_id"), "--by divides one table, and 2 are given"),
        (("--json", "a.csv"), "--json a.csv is an input of this command"),
    ],
)
def test_options_for_one_table_are_refused(
    run: Run, fleet: pd.DataFrame, words: tuple[str, ...], said: str
) -> None:
    for name in ("a.csv", "b.csv"):
        fleet.to_csv(name, index=False)
    code, told = run("diagnose", "a.csv", "b.csv", *words)
    assert code != 0
    assert said in told


def test_models_may_not_replace_a_table_or_each_other(run: Run, fleet: pd.DataFrame) -> None:
    first = fleet[fleet["sensor_id"] == 30].drop(columns="sensor_id")
    for name in ("a b.csv", "a_b.csv", "c.json", "shared.csv"):
        first.to_csv(name, index=False)
    code, told = run("diagnose", "c.json", "a_b.csv", "--models", ".")
    assert code != 0
    assert "c.json is an input of this command" in told
    assert run("diagnose", "a b.csv", "a_b.csv", "shared.csv", "--models", "m")[0] == 0
    index = json.loads(Path("m/index.json").read_text())["models"]
    assert sorted(index) == ["a b", "a_b", "shared"]
    assert len(set(index.values()) | {"shared.json"}) == 4
    assert all(Model.load(Path("m", file)).law for file in index.values())


def test_what_is_neither_a_table_nor_a_range_is_refused(run: Run, fleet: pd.DataFrame) -> None:
    fleet.to_csv("a.csv", index=False)
    code, told = run("diagnose", "a.csv", "distance=1:2")
    assert code != 0
    assert "'distance=1:2' is neither a table nor a range of --can-vary" in told
    code, told = run("diagnose", "a.csv", "--models", "m")
    assert code != 0
    assert "for one table give --save-model" in told


def test_the_terminal_shows_each_table_and_what_is_left_out(fleet: pd.DataFrame) -> None:
    found = echocal.diagnose_many(fleet, by="sensor_id")
    console = Console(width=140, record=True, file=io.StringIO())
    print_pooled(found, console)
    said = console.export_text()
    assert f"{found.verdict}: " in said
    assert "3 tables, 240 rows used" in said
    for name in ("30", "7", "12"):
        assert f"│ {name} " in said
    assert "left out  5 (2 rows): a diagnosis needs at least 8 usable rows" in said
    for cause in found.causes:
        assert cause.id in said


def test_the_plot_shows_each_size(fleet: pd.DataFrame) -> None:
    found = echocal.diagnose_many(fleet, by="sensor_id")
    sized = [cause for cause in found.causes if any(p.standard_uncertainty for p in cause.parameters)]
    assert sized, "a lag of eight standard deviations in each table"
    ax = Figure().add_subplot()
    plot_sizes(sized[0], sized[0].parameters[0].name, ax)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["30", "7", "12"]
    spoken = [one for one in sized[0].tables if one.parameters]
    assert len(ax.containers) == 2 * len(spoken)
    assert ax.get_legend_handles_labels()[1] == ["from the table alone", "in the pool"]


def test_a_pooled_diagnosis_can_be_copied(fleet: pd.DataFrame) -> None:
    found = echocal.diagnose_many(fleet, by="sensor_id")
    again = pickle.loads(pickle.dumps(found))
    assert again.to_dict() == found.to_dict()


def test_a_shared_thermometer_is_read_from_its_column(random: np.random.Generator) -> None:
    """Two loggers whose path is as warm as the box by a third."""
    tables = {}
    for name in ("north", "south"):
        air = 15.0 + 8.0 * np.sin(np.arange(300) / 20.0) + random.normal(0.0, 0.3, 300)
        box = air + 4.0 * np.sin(np.arange(300) / 35.0) + random.normal(0.0, 0.3, 300)
        distance = np.tile([0.5, 1.0, 2.0], 100)
        echo = 2.0 * distance / (331.4 + 0.6 * (air + 0.35 * (box - air))) + random.normal(0.0, 2e-6, 300)
        tables[name] = {
            "echo_s": echo,
            "temperature_C": air,
            "temperature_box_C": box,
            "distance_m": distance,
        }
    pool = echocal.diagnose_many(tables)
    assert "thermometer_mix" in {cause.id for cause in pool.causes}
    assert pool.model.columns == {"second_temperature": "temperature_box_C"}
    assert pool.gain is not None
    assert pool.gain.rms_after_m < 0.8 * pool.gain.rms_before_m
