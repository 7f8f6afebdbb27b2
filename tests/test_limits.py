"""What a file may be at most: told where it enters, in little time and memory, with the place."""

import gzip
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct.parquet import footer, thrift
from echocal.errors import DataError
from echocal.observations import limits
from echocal.observations.limits import Guarded, from_json, refuse_cells

HEADER, ROW = "echo_us,temperature_C\n", "11680,20.5\n"
MEASURED = "Distance: 12.3 cm\n" * 5


def hostile(text: str, name: str = "log.csv") -> str:
    """What reading a file says; at once, or the test runs into the limit of time."""
    Path(name).write_text(text)
    with pytest.raises(DataError) as told:
        echocal.read_observations(name)
    return str(told.value)


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", ["a", "(", "a.", "a ", "°", "1"])
@pytest.mark.parametrize("before", ["", "temperature_"])
def test_a_long_name(name: str, before: str) -> None:
    told = hostile(f"echo_us,temperature_C,{before}{name * 60_000}x\n" + "11680,20.5,3\n" * 5)
    assert "the name of column 3 has " in told
    assert "1,000 are the most; shorten it" in told


def test_a_long_name_of_a_table_or_of_json() -> None:
    with pytest.raises(DataError, match="the table: the name of column 2 has 1,001 characters"):
        echocal.read_observations({"echo_us": [1.0], "(" * 1001: [1.0]})
    told = hostile(json.dumps([{"echo_us": 11680, "(" * 1001: 1}]), "log.json")
    assert "log.json: the name of column 2" in told


@pytest.mark.parametrize("word", [" ", "a b ", "a."])
def test_a_long_line_of_a_log(word: str) -> None:
    """It costs one row, at once."""
    Path("log.txt").write_text(f"{MEASURED}{word * 100_000}\n{MEASURED}")
    with pytest.warns(echocal.DataWarning, match="1 line without values"):
        data = echocal.read_observations("log.txt", reading_speed=343)
    assert len(data) == 11
    assert list(np.flatnonzero(~data.usable)) == [5]


def test_a_long_message_of_json_is_read() -> None:
    message = json.dumps({"echo_us": 2900.5, "temperature_C": 20.0, "wave": list(range(2000))})
    Path("log.txt").write_text(f"home/tank {message}\n" * 5)
    assert echocal.read_observations("log.txt").usable.sum() == 5


@pytest.mark.parametrize("begin", [HEADER, "", MEASURED])
def test_a_line_without_an_end_in_an_archive(begin: str, tracked: Callable[[], int]) -> None:
    with gzip.open("log.csv.gz", "wb", 1) as file:
        file.write(begin.encode())
        for _ in range(100):
            file.write(b"1" * (1 << 20))
    number = begin.count("\n") + 1
    with pytest.raises(DataError, match=f"line {number} has more than 4,194,304 bytes"):
        echocal.read_observations("log.csv.gz")
    with pytest.raises(DataError, match="has more than 4,194,304 bytes"):
        echocal.correct_files(
            "log.csv.gz", "out.csv", echocal.Model("linear", {"zero_error": {"offset": 0.001}})
        )
    assert tracked() < 60 << 20
    assert not Path("out.csv").exists()


def test_a_quotation_mark_that_nothing_closes(tracked: Callable[[], int]) -> None:
    with gzip.open("log.csv.gz", "wb", 1) as file:
        file.write(f'{HEADER}{ROW}11680,"'.encode())
        for _ in range(100):
            file.write((b"text " * 1000 + b"\n") * 50)
    for read in (
        lambda: echocal.read_observations("log.csv.gz"),
        lambda: echocal.correct_files(
            "log.csv.gz", "out.csv", echocal.Model("linear", {"zero_error": {"offset": 0.001}})
        ),
    ):
        with pytest.raises(DataError, match="quotation mark of line 3 opens a field of more than 4,194,304"):
            read()
    assert tracked() < 250 << 20


@pytest.fixture
def tracked() -> "Callable[[], int]":
    import tracemalloc

    tracemalloc.start()

    def peak() -> int:
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most

    return peak


@pytest.mark.parametrize("deep", [101, 5000, 100_000])
@pytest.mark.parametrize("kind", ["[{}]", '{{"a":{}}}'])
def test_deep_json(deep: int, kind: str) -> None:
    begin, end = kind.format("|").split("|") if "{}" in kind else ("", "")
    text = begin * deep + "1" + end * deep
    with pytest.raises(ValueError, match="nested more than 100 deep"):
        from_json(text)
    assert "nested more than 100 deep" in hostile(text, "log.json") or kind[0] == "["
    assert from_json(begin * 99 + "1" + end * 99) is not None


def test_many_keys_of_json() -> None:
    told = hostile(json.dumps([{f"k{n}": n for n in range(20_000)}] * 2), "log.json")
    assert told == "log.json has 20,000 columns, and 16,384 are the most; keep those that are needed"
    text = "".join(json.dumps({"echo_us": 11680, f"k{n}": n}) + "\n" for n in range(8000))
    assert "8,000 rows and 8,001 columns" in hostile(text, "log.jsonl")


def sheet(cells: str) -> str:
    """A spreadsheet that `openpyxl` made, with other cells."""
    import pandas as pd

    pd.DataFrame({"echo_us": [11680.0, 11690.0], "temperature_C": [20.0, 21.0]}).to_excel(
        "t.xlsx", index=False
    )
    with zipfile.ZipFile("t.xlsx") as old, zipfile.ZipFile("log.xlsx", "w", zipfile.ZIP_DEFLATED) as new:
        for part in old.namelist():
            data = old.read(part)
            if part == "xl/worksheets/sheet1.xml":
                data = data.replace(b"</sheetData>", f"{cells}</sheetData>".encode())
            new.writestr(part, data)
    return "log.xlsx"


def test_a_cell_far_from_a_table() -> None:
    pytest.importorskip("openpyxl")
    pytest.importorskip("python_calamine")
    near = sheet('<row r="5"><c r="B5"><v>1</v></c></row>')
    assert len(echocal.read_observations(near)) == 3
    far = sheet('<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>')
    with pytest.raises(DataError, match=r"sheet1.xml has 1,048,576 rows and 16,384 columns"):
        echocal.read_observations(far)


def test_a_full_table_may_have_any_size() -> None:
    refuse_cells(10_000_000, 20, 30_000_000, "log.csv")
    with pytest.raises(DataError, match="200,000,000 cells"):
        refuse_cells(10_000_000, 20, 19_000_000, "log.csv")


def test_a_footer_of_many_elements(tmp_path: Path) -> None:
    pq.write_table(pa.table({"echo_us": [11680.0], "temperature_C": [20.0]}), "log.parquet")
    raw = Path("log.parquet").read_bytes()
    length = int.from_bytes(raw[-8:-4], "little")
    struct = thrift.read(raw[-8 - length : -8])
    pair = {1: (thrift.BINARY, b"k"), 2: (thrift.BINARY, b"v")}
    struct[footer.KEY_VALUES] = footer.structs([pair] * 200_000)
    foot = thrift.write(struct)
    Path("log.parquet").write_bytes(raw[: -8 - length] + foot + len(foot).to_bytes(4, "little") + b"PAR1")
    model = echocal.Model("linear", {"zero_error": {"offset": 0.001}})
    with pytest.raises(DataError, match=r"more than 524,288 fields.*a larger memory"):
        echocal.correct_files("log.parquet", "out.parquet", model, memory="256MB")
    assert not Path("out.parquet").exists()
    echocal.correct_files("log.parquet", "out.parquet", model, memory="1GB")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("size", [1, 7, 1000])
def test_the_guard_gives_every_byte_and_counts_lines(
    end: str, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    import io

    monkeypatch.setattr(limits, "LINE", 21)
    text = end.join(["x" * 20] * 50).encode()
    guarded = Guarded(io.BufferedReader(io.BytesIO(text)), "log")  # type: ignore[arg-type, type-var]
    assert b"".join(iter(lambda: guarded.read1(size), b"")) == text
    long = Guarded(io.BufferedReader(io.BytesIO(text + b"xx")), "log")  # type: ignore[arg-type, type-var]
    with pytest.raises(DataError, match="log: line 50 has more than 21 bytes"):
        b"".join(iter(lambda: long.read(size), b""))
