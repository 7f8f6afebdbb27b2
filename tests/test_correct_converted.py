"""From text to Parquet and back: the same file however much is held in memory at a time."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.parquet import file as parquet_file
from echocal.correct.text import file as text_file
from echocal.correct.text_to_parquet import KINDS, kind_of, possible

MODEL = echocal.Model("cramer", {"zero_error": {"offset": 2e-3}})
LAG = echocal.Model("cramer", {"temperature_lag": {"time_constant": 600.0}})
ROWS = 3000
START = np.datetime64("2025-03-01T00:00", "ms")


@pytest.fixture
def table(random: np.random.Generator) -> pa.Table:
    """Columns whose first rows look like another type than the whole column."""
    count = np.arange(ROWS)
    days = START + np.where(count < 900, count, 0).astype("timedelta64[D]")
    return pa.table(
        {
            "time": START + (count * 600_000).astype("timedelta64[ms]"),
            "echo_us": np.round(random.uniform(2000, 20_000, ROWS), 1),
            "temperature_C": pa.array(np.round(random.uniform(0, 30, ROWS), 2), mask=count % 7 == 3),
            "serial": [str(n) if n < 2000 else f"{n:06}" for n in count],
            "fraction": pa.array(np.where(count < 1500, count, count + 0.5)),
            "late": [None if n < 2500 else n for n in count],
            "word": ["dry, so to say" if n == 2999 else 'a "b"' if n % 2 else "" for n in count],
            "installed": days + np.where(count == 2990, 1, 0).astype("timedelta64[ms]"),
            "truth": [n % 3 == 0 for n in count],
        }
    )


def write_text(table: pa.Table, path: Path) -> None:
    """As text; whole numbers have no fraction where some are absent."""
    frame = table.to_pandas()
    frame.assign(late=frame["late"].astype("Int64")).to_csv(path, index=False)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, random: np.random.Generator) -> None:
    """Pieces of some hundred rows."""
    least = int(random.integers(3000, 30_000))
    monkeypatch.setattr(text_file, "_BLOCK", (least, least))
    monkeypatch.setattr(parquet_file, "_PIECE", (least // 100, least // 100))


@pytest.mark.parametrize("model", [MODEL, LAG], ids=["each row", "rows before"])
@pytest.mark.parametrize("ends", [(".csv", ".parquet"), (".parquet", ".csv"), (".parquet", ".tsv.gz")])
def test_the_same_bytes_in_small_pieces(
    ends: tuple[str, str],
    model: echocal.Model,
    table: pa.Table,
    tmp_path: Path,
    request: pytest.FixtureRequest,
) -> None:
    source = tmp_path / f"in{ends[0]}"
    if ends[0] == ".csv":
        write_text(table, source)
    else:
        pq.write_table(table, source, row_group_size=800)
    whole, pieces = tmp_path / f"whole{ends[1]}", tmp_path / f"pieces{ends[1]}"
    correct_files(source, whole, model, memory="2GB", processes=1)
    request.getfixturevalue("small")
    told: list[int] = []
    summary = correct_files(
        source, pieces, model, memory="256MB", progress=lambda state: told.append(state.rows)
    )
    assert summary.rows == ROWS == told[-1]
    assert pieces.read_bytes() == whole.read_bytes()


def test_the_values_are_those_of_text_and_of_parquet(table: pa.Table, tmp_path: Path, small: None) -> None:
    pq.write_table(table, tmp_path / "in.parquet")
    write_text(table, tmp_path / "in.csv")
    for kinds in ("csv.parquet", "parquet.parquet", "csv.csv", "parquet.csv"):
        source, out = kinds.split(".")
        correct_files(tmp_path / f"in.{source}", tmp_path / f"{source}.{out}", MODEL)
    one, two = pq.read_table(tmp_path / "csv.parquet"), pq.read_table(tmp_path / "parquet.parquet")
    for name in ("corrected_distance_m", "distance_standard_uncertainty_m", "status", "echo_us", "fraction"):
        assert one[name].combine_chunks().equals(two[name].combine_chunks()), name
    assert one["late"].to_pylist() == table["late"].to_pylist()
    assert one["serial"].to_pylist() == table["serial"].to_pylist()
    assert one["truth"].to_pylist() == table["truth"].to_pylist()
    assert one["word"].to_pylist() == [text or None for text in table["word"].to_pylist()]
    plain = pd.read_csv(tmp_path / "csv.csv", dtype=str, keep_default_na=False)
    back = pd.read_csv(tmp_path / "parquet.csv", dtype=str, keep_default_na=False)
    pd.testing.assert_frame_equal(back, plain)
    assert back["installed"][2990] == "2025-03-01 00:00:00.001"


def test_row_groups_and_metadata(table: pa.Table, tmp_path: Path) -> None:
    write_text(table, tmp_path / "in.csv")
    correct_files(tmp_path / "in.csv", tmp_path / "out.parquet", MODEL)
    facts = pq.ParquetFile(tmp_path / "out.parquet").metadata
    assert facts.num_rows == ROWS
    assert facts.metadata[b"echocal.model_hash"] == MODEL.hash.encode()
    place = {facts.schema.column(n).name: n for n in range(facts.num_columns)}
    assert "BYTE_STREAM_SPLIT" in facts.row_group(0).column(place["corrected_distance_m"]).encodings


@pytest.mark.parametrize(
    ("pieces", "kind"),
    [
        ([["1", "2"], ["3"]], "integer"),
        ([["1", ""], ["1.5"]], "float"),
        ([["", "NA"], ["7"]], "integer"),
        ([["-1"], [str(2**63)]], "float"),
        ([["-1"], [str(2**63 + 1)]], "text"),
        ([["1"], [str(2**64 - 1)]], "positive"),
        ([["True"], ["1"]], "text"),
        ([["12"], ["007"]], "text"),
        ([["1.5"], [str(2**53 + 1)]], "text"),
        ([["", ""], ["", "NA"]], "text"),
    ],
)
def test_a_type_holds_for_the_whole_column(pieces: list[list[str]], kind: str) -> None:
    said = [possible(pa.array(piece), ".", KINDS) for piece in pieces]
    known = [own for own in said if own is not None]
    assert kind_of(frozenset.intersection(*known) if known else None) == kind


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("finest", ["days", "seconds", "finest"])
def test_times_in_pieces_are_written_as_in_one(unit: str, finest: str, tmp_path: Path, small: None) -> None:
    """How pandas writes a column of times depends on all of them."""
    ticks = {"days": 86_400, "seconds": 1, "finest": 1}[finest]
    scale = 1 if finest == "finest" else {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    values = np.zeros(ROWS, np.int64)
    values[2000] = ticks * scale
    kinds = {"time stamp": pa.timestamp(unit), "wait": pa.duration(unit), "zone": pa.timestamp(unit, "UTC")}
    columns = {name: pa.array(values).cast(kind) for name, kind in kinds.items()}
    table = pa.table({"reading_m": np.full(ROWS, 1.5), "temperature_C": np.full(ROWS, 20.0), **columns})
    pq.write_table(table, tmp_path / "in.parquet")
    correct_files(
        tmp_path / "in.parquet", tmp_path / "out.csv", MODEL, columns=dict.fromkeys(kinds, "ignore")
    )
    expected = table.to_pandas()[list(kinds)].to_csv(index=False).splitlines()
    back = pd.read_csv(tmp_path / "out.csv", dtype=str)[list(kinds)].to_csv(index=False).splitlines()
    assert back == expected


def test_a_separator_at_the_end_of_lines_makes_no_column(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("echo_us,temperature_C,\n11660,20,\n11660,21,\n")
    correct_files(tmp_path / "in.csv", tmp_path / "out.parquet", MODEL)
    assert pq.read_table(tmp_path / "out.parquet").column_names[:3] == [
        "echo_us",
        "temperature_C",
        "corrected_distance_m",
    ]


def test_spaces_short_rows_and_marks(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text(
        'echo_us, temperature_C, note\n11660, 20, "a, b"\n11660, 21\n11660, 22, c\n'
    )
    correct_files(tmp_path / "in.csv", tmp_path / "out.parquet", MODEL)
    found = pq.read_table(tmp_path / "out.parquet")
    assert found["note"].to_pylist() == ["a, b", None, "c"]
    assert found["temperature_C"].to_pylist() == [20, 21, 22]
    (tmp_path / "in.csv").write_text("echo_us, temperature_C\n11660, 20\n11660, 21, 3\n")
    with pytest.raises(echocal.DataError, match="1 of 2 rows have more, first row 2"):
        correct_files(tmp_path / "in.csv", tmp_path / "long.parquet", MODEL)
    assert not (tmp_path / "long.parquet").exists()


def test_a_file_without_rows(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("echo_us,temperature_C\n")
    pq.write_table(pa.table({"echo_us": [], "temperature_C": []}), tmp_path / "in.parquet")
    with pytest.raises(echocal.DataError, match="and no rows, so its columns have no types"):
        correct_files(tmp_path / "in.csv", tmp_path / "out.parquet", MODEL)
    assert not (tmp_path / "out.parquet").exists()
    correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", MODEL)
    assert pq.read_table(tmp_path / "out.parquet").num_rows == 0
    correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", MODEL)
    assert (
        (tmp_path / "out.csv")
        .read_text()
        .splitlines()[0]
        .startswith("echo_us,temperature_C,corrected_distance_m,")
    )
