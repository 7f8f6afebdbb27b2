"""Every column that a correction does not append comes back as it was."""

import base64
import json
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.results import RESULTS
from echocal.observations.source import load

DEVICE = echocal.Model("linear")
LONG = 2**60 + 1
TABLE = {"reading_m": pa.array([1.0, 2.0, 1.5]), "temperature_C": pa.array([20.0, None, 21.0])}
WORDS = pa.array(["b", None, "a"])
WHOLE = (pa.int8(), pa.int16(), pa.int32(), pa.int64(), pa.uint8(), pa.uint16(), pa.uint32(), pa.uint64())
ZONES = (None, "UTC", "Europe/Berlin", "+05:30", "Mars/Olympus")
UNITS = ("s", "ms", "us", "ns")

COLUMNS: dict[str, pa.Array] = {
    **{f"{kind} with nulls": pa.array([1, None, 100], kind) for kind in WHOLE},
    "long": pa.array([LONG, None, -(2**63)]),
    "longest": pa.array([2**64 - 1, None, 1], pa.uint64()),
    **{
        f"decimal{bits}": pa.array([Decimal("1.50"), None, Decimal("-2.00")], kind)
        for bits, kind in ((128, pa.decimal128(38, 2)), (256, pa.decimal256(60, 2)))
    },
    "date": pa.array([1, None, 20_000], pa.date32()),
    "date64": pa.array([86_400_000, None, 0], pa.date64()),
    **{f"time of {unit}": pa.array([1, None, 3], pa.time32(unit)) for unit in ("s", "ms")},
    **{f"time of {unit}": pa.array([1, None, 3], pa.time64(unit)) for unit in ("us", "ns")},
    **{
        f"timestamp of {unit} in {zone}": pa.array([1, None, 3], pa.timestamp(unit, zone))
        for unit in UNITS
        for zone in ZONES
    },
    "far timestamp": pa.array([2**60, None, -(2**60)], pa.timestamp("us")),
    **{f"duration of {unit}": pa.array([1, None, 3], pa.duration(unit)) for unit in UNITS},
    **{
        f"categories by {kind}": WORDS.dictionary_encode().cast(pa.dictionary(kind, pa.string()))
        for kind in (pa.int8(), pa.int16(), pa.int32(), pa.int64())
    },
    "ordered": pa.DictionaryArray.from_arrays(
        pa.array([0, None, 1], pa.int8()), WORDS.drop_null(), ordered=True
    ),
    "categories of integers": pa.DictionaryArray.from_arrays(
        pa.array([0, None, 1], pa.int16()), pa.array([LONG, 7])
    ),
    "binary": pa.array([b"\xff\x00", None, b""]),
    "large binary": pa.array([b"\xff\x00", None, b""], pa.large_binary()),
    "view of bytes": pa.array([b"\xff\x00", None, b""], pa.binary_view()),
    "bytes of one length": pa.array([b"ab", None, b"cd"], pa.binary(2)),
    "list": pa.array([[LONG, None], None, []]),
    "list of one length": pa.array([[1.0, 2.0], None, [3.0, 4.0]], pa.list_(pa.float64(), 2)),
    "struct": pa.array([{"a": LONG, "b": "x"}, None, {"a": None, "b": None}]),
    "map": pa.array([[("a", 1)], None, []], pa.map_(pa.string(), pa.int64())),
    "truth": pa.array([True, None, False]),
    "text": pa.array(["a", None, ""]),
    "large text": pa.array(["a", None, ""], pa.large_string()),
    "nothing": pa.nulls(3),
}


def stored_types(path: Path) -> list[pa.DataType]:
    """Types as the writer had them, which pyarrow does not always give when it reads."""
    schema = pq.ParquetFile(path).metadata.metadata[b"ARROW:schema"]
    return pa.ipc.read_schema(pa.py_buffer(base64.b64decode(schema))).types


def without_ours(table: pa.Table) -> pa.Table:
    """Without what a correction says in the metadata of itself."""
    metadata = {k: v for k, v in (table.schema.metadata or {}).items() if not k.startswith(b"echocal.")}
    return table.replace_schema_metadata(metadata or None)


def corrected(table: pa.Table, folder: Path, **written: Any) -> tuple[pa.Table, pa.Table]:
    """The input's columns after a correction, compared with what they were."""
    source, out = folder / "in.parquet", folder / "out.parquet"
    pq.write_table(table, source, **written)
    correct_files(source, out, DEVICE)
    before, after = pq.ParquetFile(source).read(), pq.ParquetFile(out).read()
    assert after.column_names == [*before.column_names, *RESULTS]
    kept = without_ours(after.select(before.column_names))
    assert kept.schema.equals(before.schema, check_metadata=True)
    assert stored_types(out)[: -len(RESULTS)] == stored_types(source)
    return kept, before


@pytest.mark.parametrize("kind", COLUMNS)
def test_no_column_of_parquet_changes(kind: str, tmp_path: Path) -> None:
    after, before = corrected(pa.table({**TABLE, "x": COLUMNS[kind]}), tmp_path)
    assert after.equals(before, check_metadata=True)


def test_not_a_number_and_null_stay_apart(tmp_path: Path) -> None:
    for kind in (np.float16, np.float32, np.float64):
        values = pa.array(np.array([0.1, 0.0, np.nan], kind), mask=np.array([False, True, False]))
        after, before = corrected(pa.table({**TABLE, "x": values}), tmp_path)
        assert after["x"].is_null().to_pylist() == [False, True, False]
        bits = [column.combine_chunks().buffers()[1].to_pybytes() for column in (after["x"], before["x"])]
        assert bits[0] == bits[1]


def test_order_notes_and_compression_stay(tmp_path: Path) -> None:
    schema = pa.schema(
        [
            pa.field("temperature_C", pa.float64(), metadata={"sensor": "DS18B20"}),
            pa.field("id", pa.int64(), nullable=False, metadata={"of": "logger"}),
            pa.field("reading_m", pa.float64()),
        ],
        metadata={"campaign": "roof"},
    )
    table = pa.table({**TABLE, "id": [1, 2, 3]}).select(schema.names).cast(schema)
    for compression in ("none", "zstd"):
        after, before = corrected(table, tmp_path, compression=compression)
        assert after.equals(before, check_metadata=True)
        used = pq.ParquetFile(tmp_path / "out.parquet").metadata.row_group(0).column(0).compression
        assert used == pq.ParquetFile(tmp_path / "in.parquet").metadata.row_group(0).column(0).compression


INDICES: dict[str, pd.Index] = {
    "of rows": pd.RangeIndex(3),
    "of numbers": pd.Index([5, 6, 9]),
    "of long numbers": pd.Index([LONG, None, 3], dtype="Int64", name="id"),
    "of times": pd.date_range("2024-01-01", periods=3, freq="h"),
    "of two levels": pd.MultiIndex.from_tuples([(1, "a"), (1, "b"), (2, "a")], names=["stack", None]),
}


@pytest.mark.parametrize("index", INDICES)
def test_an_index_of_pandas_stays_one(index: str, tmp_path: Path) -> None:
    frame = pa.table(TABLE).to_pandas().set_axis(INDICES[index])
    frame["kind"] = pd.Categorical([2, 1, 2])
    after, before = corrected(pa.Table.from_pandas(frame), tmp_path)
    assert after.equals(before, check_metadata=True)
    back = pd.read_parquet(tmp_path / "out.parquet")
    pd.testing.assert_frame_equal(back[frame.columns], pd.read_parquet(tmp_path / "in.parquet"))


def test_pandas_reads_what_had_numbers_for_names(tmp_path: Path) -> None:
    pd.DataFrame({0: [1.0, 2.0], 1: [20.0, 21.0]}).to_parquet(tmp_path / "in.parquet")
    columns = {"0": "reading_m", "1": "temperature_C"}
    correct_files(tmp_path / "in.parquet", tmp_path / "out.parquet", DEVICE, columns=columns)
    names = pd.read_parquet(tmp_path / "out.parquet").columns
    assert names.tolist() == ["0", "1", *RESULTS]


def test_a_name_of_a_folder_makes_no_column(tmp_path: Path) -> None:
    source = tmp_path / "station=7" / "a.parquet"
    source.parent.mkdir()
    pq.write_table(pa.table({**TABLE, "id": [LONG, None, 3]}), source)
    correct_files(tmp_path, tmp_path.parent / f"{tmp_path.name}_out", DEVICE)
    out = pq.ParquetFile(tmp_path.parent / f"{tmp_path.name}_out" / "station=7" / "a.parquet").read()
    assert without_ours(out.select([0, 1, 2])).equals(pq.ParquetFile(source).read(), check_metadata=True)


def test_a_thousand_long_numbers_stay(tmp_path: Path) -> None:
    ids = [None if n % 10 == 3 else 2**60 + n for n in range(1000)]
    table = pa.table({"reading_m": [1.5] * 1000, "temperature_C": [20.0] * 1000, "id": pa.array(ids)})
    after, before = corrected(table, tmp_path)
    assert after.equals(before, check_metadata=True)
    correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", DEVICE)
    written = [line.split(",")[2] for line in (tmp_path / "out.csv").read_text().splitlines()[1:]]
    assert written == ["" if number is None else str(number) for number in ids]


AS_TEXT = {
    "long": [str(LONG), "", str(-(2**63))],
    "longest": [str(2**64 - 1), "", "1"],
    "decimal128": ["1.50", "", "-2.00"],
    "date": ["1970-01-02", "", "2024-10-04"],
    "time of ns": ["00:00:00.000000001", "", "00:00:00.000000003"],
    "timestamp of ns in +05:30": [
        "1970-01-01 05:30:00.000000001+05:30",
        "",
        "1970-01-01 05:30:00.000000003+05:30",
    ],
    "timestamp of us in Mars/Olympus": ["1970-01-01 00:00:00.000001Z", "", "1970-01-01 00:00:00.000003Z"],
    "categories of integers": [str(LONG), "", "7"],
    "binary": ["ff00", "", ""],
    "view of bytes": ["ff00", "", ""],
    "list": [json.dumps([LONG, None]), "", "[]"],
    "struct": [json.dumps({"a": LONG, "b": "x"}), "", json.dumps({"a": None, "b": None})],
    "map": [json.dumps([["a", 1]]), "", "[]"],
    "truth": ["True", "", "False"],
}


@pytest.mark.parametrize("kind", AS_TEXT)
def test_parquet_to_text_keeps_every_digit(kind: str, tmp_path: Path) -> None:
    pq.write_table(pa.table({**TABLE, "x": COLUMNS[kind]}), tmp_path / "in.parquet")
    summary = correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", DEVICE)
    assert load(tmp_path / "out.csv", verbatim=True)["x"].tolist() == AS_TEXT[kind]
    told = [note for note in summary.results["in.parquet"]["notes"] if "column 'x'" in note]
    assert bool(told) == (kind in {"binary", "view of bytes", "list", "struct", "map"})


NO_TEXT = {
    "far times in a list": pa.array([[2**60], None, []], pa.list_(pa.timestamp("us"))),
    "far dates in a list": pa.array([[2**30], None, []], pa.list_(pa.date32())),
    "an unknown zone in a list": pa.array([[1], None, []], pa.list_(pa.timestamp("us", "Mars/Olympus"))),
}


@pytest.mark.parametrize("kind", NO_TEXT)
def test_what_cannot_be_text_is_told_by_name(kind: str, tmp_path: Path) -> None:
    pq.write_table(pa.table({**TABLE, "x": NO_TEXT[kind]}), tmp_path / "in.parquet")
    with pytest.raises(echocal.DataError, match=r"column 'x' \(list<.*\) cannot be text: .*; write Parquet"):
        correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", DEVICE)
    assert not (tmp_path / "out.csv").exists()


FROM_TEXT: dict[str, tuple[list[str], pa.DataType, list[Any]]] = {
    "long": ([str(LONG), "", "-3"], pa.int64(), [LONG, None, -3]),
    "longest": ([str(2**64 - 1), "NA", "1"], pa.uint64(), [2**64 - 1, None, 1]),
    "longer": (["9" * 30, "", "1"], pa.large_string(), ["9" * 30, None, "1"]),
    "long among fractions": ([str(LONG), "1.5", ""], pa.large_string(), [str(LONG), "1.5", None]),
    "the first long": ([str(2**53 + 1), "1.5", ""], pa.large_string(), [str(2**53 + 1), "1.5", None]),
    "long with a sign": (
        ["+9007199254740995", "+45", ""],
        pa.large_string(),
        ["+9007199254740995", "+45", None],
    ),
    "long but exact": ([str(2**53 + 2), "1.5", ""], pa.float64(), [2.0**53 + 2, 1.5, None]),
    "fractions": (["0.1", "", "-2e3"], pa.float64(), [0.1, None, -2000.0]),
    "beyond a float": (["1e400", "", "1"], pa.large_string(), ["1e400", None, "1"]),
    "below zero by a sign": (["-0", "", "1"], pa.float64(), [-0.0, None, 1.0]),
    "serial numbers": (["007", "", "12"], pa.large_string(), ["007", None, "12"]),
    "remarks": (["NA", "", "dry"], pa.large_string(), ["NA", None, "dry"]),
    "truth": (["True", "", "False"], pa.bool_(), [True, None, False]),
    "nothing": (["", "", ""], pa.large_string(), [None, None, None]),
}


@pytest.mark.parametrize("kind", FROM_TEXT)
def test_text_to_parquet_loses_no_letter(kind: str, tmp_path: Path) -> None:
    texts, expected, values = FROM_TEXT[kind]
    lines = ["reading_m,temperature_C,x", *(f"1.5,20.0,{text}" for text in texts)]
    (tmp_path / "in.csv").write_text("\n".join(lines))
    correct_files(tmp_path / "in.csv", tmp_path / "out.parquet", DEVICE)
    written = pq.read_table(tmp_path / "out.parquet")
    assert written.schema.field("x").type == expected
    assert written["x"].to_pylist() == values
    assert written["reading_m"].to_pylist() == [1.5] * 3


def test_the_first_long_number_is_read_to_its_last_digit(tmp_path: Path) -> None:
    """2**53 + 1 is the least integer that no float is; it was compared after it had been rounded."""
    (tmp_path / "in.csv").write_text(f"reading_m,group\n1.5,{2**53 + 1}\n1.5,{2**53}\n1.5,\n")
    data = echocal.read_observations(tmp_path / "in.csv", reading_speed=343)
    assert data.labels["group"].tolist() == [0, 1, -1]


def test_long_numbers_of_bursts_stay_apart(tmp_path: Path) -> None:
    """A burst's number may be a time in nanoseconds; as floats, neighbors would be one burst."""
    numbers = pa.array([LONG, LONG + 1, None, LONG])
    table = pa.table({"reading_m": [1.5] * 4, "group": numbers})
    pq.write_table(table, tmp_path / "in.parquet")
    lines = ["reading_m,group", *(f"1.5,{number or ''}" for number in numbers.to_pylist())]
    (tmp_path / "in.csv").write_text("\n".join(lines))
    for source in (tmp_path / "in.parquet", tmp_path / "in.csv", table, pl.from_arrow(table)):
        data = echocal.read_observations(source, reading_speed=343)
        assert data.labels["group"].tolist() == [0, 1, -1, 0]
