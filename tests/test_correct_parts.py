"""The same rows, in the same order, with the same bits: for any chunks, threads, files and kinds of files."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files, correct_table, stream
from echocal.correct.parquet import file as parquet_file
from echocal.correct.results import RESULTS
from echocal.correct.text import file as text_file
from echocal.observations.marks import MARKS, RowRule

ROWS = 700
PLAIN = echocal.Model(
    "cramer",
    {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": 2e-3}},
    covariance=np.diag([1e-12, 1e-8]),
)
LAG = echocal.Model("linear", {"temperature_lag": {"time_constant": 120.0}, "drift": {"rate": 1e-8}})
SHIFT = echocal.Model("linear", {"temperature_timestamp_shift": {"weight": 1.0, "rows": 2.5}})
MARKED = echocal.Model(
    "linear",
    provenance={
        MARKS: {
            "rules": [
                RowRule(reason="stuck_reading", kind="run", quantity="echo_time", length=4).to_dict(),
                RowRule(reason="crosstalk", kind="far from neighbors", sign=-1, deviation=0.2).to_dict(),
            ]
        }
    },
)
MODELS = {"plain": PLAIN, "lag": LAG, "shift": SHIFT, "marks": MARKED}

pytestmark = pytest.mark.filterwarnings("ignore::echocal.DomainWarning")


@pytest.fixture
def table(random: np.random.Generator) -> pd.DataFrame:
    """A log with gaps, odd values, ghosts, and runs: one begins before row 100, where a file may end."""
    echo = np.round(11_000 + 200 * np.sin(np.arange(ROWS) / 40) + random.normal(0, 5, ROWS), 1)
    echo[random.choice(ROWS, 12, replace=False)] *= 0.5
    echo[97:109] = echo[100]
    echo[[5, 340]] = -9999.0, np.nan
    celsius = np.round(15 + 8 * np.sin(np.arange(ROWS) / 90) + random.normal(0, 0.1, ROWS), 2)
    celsius[[0, 41, 350, 351, ROWS - 1]] = np.nan
    celsius[200] = 900.0
    seconds = np.cumsum(random.choice([1.0, 5.0, 60.0], ROWS))
    return pd.DataFrame(
        {
            "time": pd.Timestamp("2026-03-01") + pd.to_timedelta(seconds, unit="s"),
            "id": np.arange(ROWS) + 2**60,
            "echo_us": echo,
            "temperature_C": celsius,
            "humidity_percent": np.where(np.arange(ROWS) % 50 == 7, 143.0, 40.0),
            "remark": np.where(np.arange(ROWS) % 9 == 0, "a, b", "dry"),
        }
    )


def expected(table: pd.DataFrame, model: echocal.Model, **options: Any) -> pd.DataFrame:
    return correct_table(table, model, **options).table[list(RESULTS)].reset_index(drop=True)


def results(path: Path) -> pd.DataFrame:
    back = pq.ParquetFile(path).read().select(list(RESULTS)).to_pandas()
    return back.assign(status=back["status"].astype(object), unusable=back["unusable"].astype(object))


def same(found: pd.DataFrame, wanted: pd.DataFrame) -> None:
    for name in RESULTS[:2]:
        np.testing.assert_array_equal(found[name].to_numpy(), wanted[name].to_numpy())
    for name in RESULTS[2:]:
        assert found[name].tolist() == wanted[name].tolist()


@pytest.mark.parametrize(
    ("group", "piece", "threads"), [(1, 90, 3), (50, 7, 2), (700, 64, 1), (50, 10_000, 1)]
)
@pytest.mark.parametrize("name", MODELS)
def test_pieces_of_parquet(
    name: str,
    group: int,
    piece: int,
    threads: int,
    table: pd.DataFrame,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(parquet_file, "_PIECE", (piece, piece))
    table.to_parquet(tmp_path / "in.parquet", row_group_size=group, index=False)
    options = {"uncertainties": ["temperature_C=0.5", "echo_us=3"]}
    correct_files(
        tmp_path / "in.parquet", tmp_path / "out.parquet", MODELS[name], processes=threads, **options
    )
    same(results(tmp_path / "out.parquet"), expected(table, MODELS[name], **options))
    before, after = (pq.ParquetFile(tmp_path / f"{side}.parquet") for side in ("in", "out"))
    assert after.read().select(before.schema_arrow.names).equals(before.read())
    assert after.metadata.num_row_groups == before.metadata.num_row_groups


def test_a_piece_has_its_marks(table: pd.DataFrame) -> None:
    """The tables of this file do have what the pieces must agree on."""
    reasons = set(expected(table, MARKED)["status"])
    assert {"stuck_reading", "crosstalk", "echo_us out of range", "temperature_C missing"} <= reasons
    assert np.nanmax(np.abs(expected(table, LAG).iloc[:, 0] - expected(table, MARKED).iloc[:, 0])) > 1e-4


@pytest.mark.parametrize("cuts", [[350], [1, 2, 340, 351, 699], list(range(10, 700, 10))])
@pytest.mark.parametrize("name", MODELS)
def test_a_log_in_several_files_is_one_log(
    name: str, cuts: list[int], table: pd.DataFrame, tmp_path: Path
) -> None:
    (tmp_path / "in").mkdir()
    places = np.split(np.arange(ROWS), cuts)
    for number, rows in enumerate(places):
        # names that are not in the order of time
        table.iloc[rows].to_parquet(tmp_path / "in" / f"{(number * 7) % 101:03}.parquet", index=False)
    summary = correct_files(tmp_path / "in", tmp_path / "out", MODELS[name], logs="all")
    assert not summary.set_aside
    found = [results(tmp_path / "out" / f"{(number * 7) % 101:03}.parquet") for number in range(len(places))]
    same(pd.concat(found, ignore_index=True), expected(table, MODELS[name]))


@pytest.mark.parametrize("name", ["lag", "marks"])
def test_files_of_a_model_that_depends_on_rows_must_be_told(
    name: str, table: pd.DataFrame, tmp_path: Path
) -> None:
    (tmp_path / "in").mkdir()
    for part, rows in enumerate(np.split(np.arange(ROWS), 2)):
        table.iloc[rows].to_parquet(tmp_path / "in" / f"{part}.parquet")
    with pytest.raises(echocal.UsageError, match=r"depends on the other rows.*logs='all', logs='file'"):
        correct_files(tmp_path / "in", tmp_path / "out", MODELS[name])
    correct_files(tmp_path / "in", tmp_path / "out", MODELS[name], logs="file")
    same(results(tmp_path / "out" / "1.parquet"), expected(table.iloc[350:], MODELS[name]))


def test_files_that_overlap_in_time_are_no_log(table: pd.DataFrame, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for part in range(2):
        table.iloc[part::2].to_parquet(tmp_path / "in" / f"{part}.parquet")
    summary = correct_files(tmp_path / "in", tmp_path / "out", LAG, logs="all")
    assert len(summary.set_aside) == 2
    assert all("begins before" in why and "logs='file'" in why for why in summary.set_aside.values())


@pytest.mark.parametrize(("ending", "size", "threads"), [("\n", 3000, 3), ("\r\n", 300, 1), ("\n", 10**7, 1)])
@pytest.mark.parametrize("name", MODELS)
def test_blocks_of_text(
    ending: str,
    name: str,
    size: int,
    threads: int,
    table: pd.DataFrame,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(text_file, "_BLOCK", (size, size))
    (tmp_path / "in.csv").write_text(table.to_csv(index=False, lineterminator=ending), newline="")
    correct_files(tmp_path / "in.csv", tmp_path / "out.csv", MODELS[name], processes=threads)
    before = (tmp_path / "in.csv").read_bytes().decode().split(ending)
    after = (tmp_path / "out.csv").read_bytes().decode().split(ending)
    assert len(before) == len(after)
    wanted = expected(table, MODELS[name])
    assert after[0] == ",".join([before[0], *RESULTS])
    for row, (old, new) in enumerate(zip(before[1:-1], after[1:-1], strict=True)):
        assert new.startswith(f"{old},")
        distance, uncertainty, status, unusable = new[len(old) + 1 :].split(",")
        value = wanted.iloc[row, 0]
        assert (float(distance) == round(value, 9)) if distance else np.isnan(value)
        assert uncertainty == "" or name == "plain"
        assert status == unusable == wanted["status"][row]


def test_neighbors_are_those_of_the_whole() -> None:
    whole = pd.DataFrame({"x": np.arange(20)})
    for size in (1, 2, 3, 7, 20):
        for around in (0, 1, 4, 30):
            tables = (whole.iloc[at : at + size] for at in range(0, 20, size))
            at = 0
            for table, lead, count, begin in stream.with_neighbors(tables, around, None, None):
                first, last = max(at - around, 0), min(at + count + around, 20)
                assert table["x"].tolist() == list(range(first, last))
                assert (lead, begin) == (at - first, first)
                at += count
            assert at == 20


@pytest.mark.parametrize("rows", [300, 200])
def test_a_file_that_is_written_anew_is_read_anew(
    rows: int, tmp_path: Path, random: np.random.Generator
) -> None:
    """The log that was read last is kept, but not for another file at the same place."""
    model = echocal.Model("linear", {"temperature_lag": {"time_constant": 900.0}})
    source = tmp_path / "log.csv"
    for count in (300, rows):
        temperature = np.cumsum(random.normal(0, 0.5, count)) + 15
        table = pd.DataFrame(
            {
                "time_s": 60.0 * np.arange(count),
                "echo_us": np.full(count, 11_600.0),
                "temperature_C": temperature,
            }
        )
        table.to_csv(source, index=False)
        correct_files(source, tmp_path / "out.csv", model, force=True)
        expected = correct_table(table, model).table["corrected_distance_m"]
        np.testing.assert_allclose(
            pd.read_csv(tmp_path / "out.csv")["corrected_distance_m"], expected, atol=2e-9
        )
