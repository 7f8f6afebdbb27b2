"""Files that cannot be read, and the one line that says so."""

import gzip
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import echocal
from echocal import DataError, UsageError
from echocal.cli import main
from echocal.observations.source import load

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
        "is not text in utf-8: a binary file, or name the encoding: encoding='utf-16'",
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
    "temperature misspelled": (
        b"reading_m,temprature_C\n1.025,20\n",
        {},
        DataError,
        "map one (columns={'temprature_C': 'temperature_C'})",
    ),
    "echo misspelled, with a unit": (
        b"Time [UTC],Distace [mm]\n2019/03/09,1611\n",
        {},
        DataError,
        "Say which it is: columns={'Distace [mm]': 'reading_mm'}",
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
    "a stray quote that ends at another one": (
        b'echo_us,x\n11660,1\n11660,"2\n11660,3\n11660,4\n11660,5"\n11660,6\n',
        {},
        DataError,
        "the quotation mark of line 3 would make one field of lines 3 to 6, and line 4 looks like a row "
        "(11660,3); remove it, or within a quoted field write it twice",
    ),
    "a stray quote that ends at a quoted field": (
        b'echo_us,x,remark\n11660,1,"a"\n11660,"2,\n11660,3,\n11660,4,"calm, dry"\n11660,5,\n',
        {},
        DataError,
        'line 5 has a quotation mark within a field, as if it closed the one of line 3 (11660,4,"calm, dry")',
    ),
    "a stray quote in a table of one column": (
        b'echo_us\n11660\n"11660\n11660\n11660"\n11660\n',
        {},
        DataError,
        "would make one field of lines 3 to 5, and line 4 looks like a row",
    ),
    "a stray quote on a line of its own": (
        b'echo_us,x\n11660,1\n"\n11660,3\n11660,4\n"\n11660,6\n',
        {},
        DataError,
        "would make one field of lines 3 to 6, and line 4 looks like a row",
    ),
    "a stray quote in the last lines": (
        b'echo_us,x\n11660,1\n11660,"2\n11660,3',
        {},
        DataError,
        "nothing closes the quotation mark of line 3",
    ),
    "a stray quote in the header": (
        b'echo_us,"x\n11660,1\n11660,2"\n11660,3\n',
        {},
        DataError,
        'nothing closes the quotation mark of line 1 (echo_us,"x)',
    ),
    "a quote within a quoted field": (
        b'echo_us,x\n11660,"5" pipe"\n11660,2\n',
        {},
        DataError,
        'line 2 has a quotation mark within a field (11660,"5" pipe"); remove it, or within a quoted field '
        'write it twice ("")',
    ),
    "too many fields, far below a logger's own lines": (
        b"logger 7\n# more\necho_us,x\n11660,1\n11660,2,3\n",
        {"skip_lines": 1},
        DataError,
        "cannot be read as rows of 2 fields like its header: Expected 2 fields in line 5, saw 3",
    ),
    "unclosed quote": (
        b'echo_us,x\n1,"2\n3,4\n',
        {},
        DataError,
        'nothing closes the quotation mark of line 2 (1,"2); remove it, or within a quoted field',
    ),
}


LEGAL = {
    "a remark of several lines": ('11660,1,"warm,\ncalm"', "warm,\ncalm"),
    "a remark with a number in it": ('11660,1,"moved to\n2, 5 and 7\n"', "moved to\n2, 5 and 7\n"),
    "a quote twice": ('11660,1,"a 5"" pipe"', 'a 5" pipe'),
    "a quote within a bare field": ('11660,1,5" pipe', '5" pipe'),
    "a blank beside a quote": ('11660,1, "a, b"', "a, b"),
    "nothing in quotes": ('11660,1,""', ""),
}


@pytest.mark.parametrize("ending", [b"\n", b"\r\n"])
@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("case", LEGAL)
def test_quotes_that_are_right_lose_nothing(case: str, packed: bool, ending: bytes, tmp_path: Path) -> None:
    written, remark = LEGAL[case]
    lines = ["echo_us,x,remark", "11660,0,", written, "11660,2,end"]
    content = b"".join(line.encode() + ending for line in lines)
    (tmp_path / "log").write_bytes(gzip.compress(content) if packed else content)
    assert echocal.read_observations(tmp_path / "log").extra["x"].tolist() == [0.0, 1.0, 2.0]
    assert load(tmp_path / "log")["remark"].fillna("").tolist() == ["", remark, "end"]


@pytest.mark.parametrize("remark", ["warm,\ncalm", "moved\n", "a\nb\nc", "to 5\n6, 7"])
def test_a_remark_of_several_lines_may_stand_first(remark: str, tmp_path: Path) -> None:
    """Its last line has as many fields as a row."""
    lines = ["remark,echo_us,x", "dry,11660,0", f'"{remark}",11660,1', f'"{remark}",11660,2', "end,11660,3"]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    assert echocal.read_observations(tmp_path / "log.csv").extra["x"].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert load(tmp_path / "log.csv")["remark"].tolist() == ["dry", remark, remark, "end"]


@pytest.mark.parametrize("name", ["log.tsv", "log.tsv.gz"])
@pytest.mark.parametrize("command", ["correct", "diagnose"])
def test_ten_rows_that_a_stray_quote_would_swallow(
    command: str, name: str, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    rows = [f"{11660 + n}\t20.1\tdry" for n in range(30)]
    rows[12] = '11672\t"20.1\tdry'
    rows[22] = '11682\t20.1"\tdry'
    content = "\n".join(["echo_us\ttemperature_C\tremark", *rows]).encode()
    (tmp_path / name).write_bytes(gzip.compress(content) if name.endswith("gz") else content)
    out = ["-o", str(tmp_path / "out.csv")] if command == "correct" else []
    monkeypatch.setattr(sys, "argv", ["echocal", command, str(tmp_path / name), *out])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr().err
    assert (ended.value.code, told.count("\n")) == (3, 1)
    assert "the quotation mark of line 14 would make one field of lines 14 to 24, and line 15 looks" in told
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_quote_in_a_line_above_the_header_hides_no_row(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text('"logger\n# 5" pipe\necho_us,x\n11660,1\n11661,2\n')
    assert len(echocal.read_observations(tmp_path / "log.csv", skip_lines=1)) == 2


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


WITHOUT_PYARROW = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "pyarrow":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
from echocal.cli import main

for command in (
    "correct log.csv -o out.csv --quiet",
    "correct log.csv -o out.parquet",
    "correct log.parquet -o out2.csv",
    "diagnose log.parquet",
    "verify log.parquet --maximum-permissible-error-mm 5",
    "sweep --temperature 0:50:10 -o sweep.parquet",
):
    sys.argv = ["echocal", *command.split()]
    try:
        main()
    except SystemExit as end:
        sys.stderr.write(f"{end.code or 0}\\n")
"""


def test_what_needs_pyarrow_says_so(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("reading_m,temperature_C\n1.5,20\n1.6,21\n")
    (tmp_path / "log.parquet").write_bytes(b"PAR1")
    run = [sys.executable, "-c", WITHOUT_PYARROW]
    told = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, timeout=300).stderr.splitlines()
    assert told == ["0", *["echocal: Parquet needs pyarrow: pip install 'echocal[batch]'", "2"] * 5]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "log.parquet", "out.csv"]
