"""Files that cannot be read, and the one line that says so."""

import gzip
import re
from pathlib import Path
from typing import Any

import pytest

import echocal
from echocal import DataError, UsageError

FILES: dict[str, tuple[bytes, dict[str, Any], type[Exception], str]] = {
    "empty": (b"", {}, DataError, "is empty"),
    "blank": (b"\n\n", {}, DataError, "has no header after 2 skipped lines"),
    "header only": (
        b"echo_us,temperature_C\n",
        {},
        DataError,
        "has a header (echo_us, temperature_C) and no rows",
    ),
    "repeated header": (b"echo_us,echo_us\n1,2\n", {}, DataError, "has more than one column 'echo_us'"),
    "ragged": (
        b"echo_us,x\n11660,1\n11660,2,3\n",
        {},
        DataError,
        "cannot be read as rows of 2 fields like its header",
    ),
    "ragged from the start": (
        b"echo_us,x\n11660,1,4\n",
        {},
        DataError,
        "cannot be read as rows of 2 fields like its header",
    ),
    "logger id": (
        b"Lib = 0.3.0 SN = 77\necho_us,temperature_C\n11660,20\n",
        {},
        DataError,
        "line 1 ('Lib = 0.3.0 SN = 77') is one field and the next line has more; "
        "if it is a logger's own line, skip it: --skip-lines 1",
    ),
    "all skipped": (b"echo_us\n1\n", {"skip_lines": 5}, DataError, "has no header after 5 skipped lines"),
    "binary garbage": (bytes(range(256)) * 4, {}, DataError, "is not text"),
    "NUL bytes": (b"ab\0\0cd\0\n" * 9, {}, DataError, "is not text: its first line has NUL bytes"),
    "latin-1": (
        "echo_us,température\n1,2\n".encode("latin-1"),
        {},
        DataError,
        "is not text in utf-8: a binary",
    ),
    "latin-1 further down": (
        b"echo_us,remark\n" + b"11660,good\n" * 9000 + "11660,\xe9t\xe9\n".encode("latin-1"),
        {},
        DataError,
        "is not text in utf-8: a binary file, or name the encoding",
    ),
    "utf-16": (
        "echo_us\n1\n".encode("utf-16"),
        {},
        DataError,
        "is not text in utf-8: a binary file, or name the encoding: --encoding utf-16",
    ),
    "thousands, German": (
        b"reading_mm;temperature_C\n514,9;20,5\n1.025,4;20,5\n",
        {"decimal": ","},
        DataError,
        "'1.025,4' has separators of thousands: write such numbers without, as 1025,4",
    ),
    "thousands, English": (
        b'reading_mm\n"514.9"\n"1,025.4"\n',
        {},
        DataError,
        "'1,025.4' has separators of thousands: write such numbers without, as 1025.4",
    ),
    "decimal comma": (
        b"reading_m;temperature_C\n1,025;20\n",
        {},
        DataError,
        "first at row 1: '1,025'; a decimal comma? pass --decimal ,",
    ),
    "temperature misspelled": (
        b"reading_m,temprature_C\n1.025,20\n",
        {},
        DataError,
        'map one (--column "temprature_C=temperature_C")',
    ),
    "echo in words": (
        b"distance (m),Reading in cm\n1,102.5\n",
        {},
        DataError,
        'Did you mean: --column "Reading in cm=reading_cm"',
    ),
    "echo misspelled, with a unit": (
        b"Time [UTC],Distace [mm]\n2019/03/09,1611\n",
        {},
        DataError,
        'Say which it is: --column "Distace [mm]=reading_mm"',
    ),
    "unknown encoding": (b"echo_us\n1\n", {"encoding": "utf-9"}, UsageError, "unknown encoding 'utf-9'"),
    "spreadsheet": (
        b"PK\x03\x04....",
        {},
        DataError,
        "is a zip archive or a spreadsheet; save the table as CSV",
    ),
    "broken Parquet": (b"PAR1 and no more", {}, DataError, "begins like Parquet and cannot be read"),
    "broken gzip": (gzip.compress(b"echo_us\n1\n")[:15], {}, DataError, "cannot be unpacked"),
    "unclosed quote": (
        b'echo_us,x\n1,"2\n3,4\n',
        {},
        DataError,
        "cannot be read as rows of 2 fields like its header: EOF inside",
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_files(case: str, tmp_path: Path) -> None:
    content, options, error, message = FILES[case]
    path = tmp_path / "log.csv"
    path.write_bytes(content)
    with pytest.raises(error, match=re.escape(message)):
        echocal.read_observations(path, **options)


def test_no_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no file .*log.csv"):
        echocal.read_observations(tmp_path / "log.csv")
    with pytest.raises(DataError, match="is a folder; name one file of it"):
        echocal.read_observations(tmp_path)


def test_one_row_is_read_and_is_too_few_for_more(tmp_path: Path) -> None:
    path = tmp_path / "one.csv"
    path.write_text("echo_us,temperature_C\n11660,20\n")
    data = echocal.read_observations(path)
    with pytest.raises(DataError, match="calibration needs at least 3 usable rows; the table has 1 of 1 row"):
        data.require("calibration", rows=3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('"SR_U" = 3\n', '"SR_U" is no text; a line is "SR_U" = "reading_m"'),
        ("SR_U: reading_m\n", "is not TOML"),
        (None, "cannot be read: No such file"),
    ],
)
def test_column_files(text: str | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / "columns.toml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(UsageError, match=re.escape(message)):
        echocal.read_observations({"SR_U": [2.0]}, path)
