"""A file of a table is looked at once, and each command reads it the same way."""

import codecs
import csv
import gzip
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_watch_dialects import corrected, text, watched

import echocal
from echocal.correct import correct_files

Run = Callable[..., tuple[int, str]]
DELAY = 31e-6
MODEL = echocal.Model("linear", {"fixed_delay": {"delay": DELAY}})
opened: dict[str, int] = {}


def count(event: str, details: tuple[object, ...]) -> None:
    name = details[0] if event == "open" else None
    if isinstance(name, str) and name in opened:
        opened[name] += 1


sys.addaudithook(count)  # which nothing removes


@contextmanager
def counted(path: Path) -> Iterator[Callable[[], int]]:
    opened[str(path)] = 0
    try:
        yield lambda: opened[str(path)]
    finally:
        del opened[str(path)]


def marked(plain: str) -> str:
    """The same with a quoted field over two lines in its last row but one."""
    lines = plain.splitlines(keepends=True)
    return "".join([*lines[:-2], lines[-2].rpartition(",")[0] + ',"two\nlines"\n', lines[-1]])


def blanks(plain: str) -> str:
    """Columns with blanks between them have no empty field."""
    return plain.replace(",,", ",NaN,").replace(",", "  ")


FORMS: dict[str, Callable[[str], bytes]] = {
    "comma": str.encode,
    "a quoted field over two lines": lambda plain: marked(plain).encode(),
    "a comment": lambda plain: (plain + "# the end\n").encode(),
    "a row too wide": lambda plain: (plain + "1,2,3,4,5,6\n").encode(),
    "long integers": lambda plain: (plain + "2026-01-03T00:00:00,12000,20,12345678901234567890\n").encode(),
    "blanks": lambda plain: blanks(plain).encode(),
    "JSON": lambda plain: "".join(
        f'{{"echo_us": {line.split(",")[1]}}}\n' for line in plain.splitlines()[1:6]
    ).encode(),
    "gzip": lambda plain: gzip.compress(plain.encode()),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_file_is_opened_twice_at_most(form: str, tmp_path: Path, random: np.random.Generator) -> None:
    """Once to see how it is written, and once for its rows."""
    path = tmp_path / "log.txt"
    path.write_bytes(FORMS[form](text(random)))
    with counted(path) as opens, warnings.catch_warnings(action="ignore"):
        echocal.read_observations(path)
        assert opens() <= 2


@pytest.mark.parametrize(("end", "most"), [("csv", 3), ("parquet", 4)])
def test_a_correction_opens_a_file_three_times(
    end: str, most: int, tmp_path: Path, random: np.random.Generator
) -> None:
    """Its digest is the third, and the types of the columns of Parquet take one more."""
    path = tmp_path / "log.csv"
    path.write_text(text(random))
    with counted(path) as opens:
        correct_files(path, tmp_path / f"out.{end}", MODEL)
        assert opens() <= most


def quoted(plain: str) -> str:
    file = io.StringIO()
    csv.writer(file, quoting=csv.QUOTE_ALL, lineterminator="\n").writerows(
        line.split(",") for line in plain.splitlines()
    )
    return file.getvalue()


def semicolons(plain: str) -> str:
    return plain.replace(",", ";").replace(".", ",")


DIALECTS: dict[str, tuple[Callable[[str], bytes], dict[str, Any]]] = {
    "comma": (str.encode, {}),
    "semicolon, decimal comma": (lambda plain: semicolons(plain).encode(), {}),
    "tab": (lambda plain: plain.replace(",", "\t").encode(), {}),
    "blanks": (lambda plain: blanks(plain).encode(), {}),
    "quoted": (lambda plain: quoted(plain).encode(), {}),
    "mark of UTF-8": (lambda plain: plain.encode("utf-8-sig"), {}),
    "mark of UTF-8, zipped": (lambda plain: gzip.compress(plain.encode("utf-8-sig")), {}),
    "UTF-16": (lambda plain: plain.encode("utf-16"), {"encoding": "utf-16"}),
    "lines above": (lambda plain: f"# a logger\nStation 7\n{plain}".encode(), {"skip_lines": 2}),
    "comments": (
        lambda plain: plain.replace("\n", "\n# later\n", 5).replace("\n# later\n", "\n", 1).encode(),
        {},
    ),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_one_log_in_each_dialect(dialect: str, run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    """The reader of the diagnosis, inspect, correct and watch: the same numbers and the same reasons."""
    plain = text(random).replace(",far,", ",,")  # a word among numbers is an error for a reader of tables
    write, said = DIALECTS[dialect]
    name = "log.csv.gz" if "zipped" in dialect else "log.csv"
    (tmp_path / name).write_bytes(write(plain))
    options = [word for own, value in said.items() for word in (f"--{own.replace('_', '-')}", str(value))]
    with warnings.catch_warnings(action="ignore"):
        read = echocal.read_observations(tmp_path / name, **said)
    wanted = plain.splitlines()[1:]
    assert len(read) == len(wanted)
    echoes = [float(line.split(",")[1] or "nan") * 1e-6 for line in wanted]
    np.testing.assert_allclose(read.echo_time, echoes, rtol=1e-15)
    distance = (331.4 + 0.6 * read.conditions["temperature"]) * (read.echo_time - DELAY) / 2.0

    MODEL.save(tmp_path / "model.json")
    assert run("inspect", name, *options, "--write", "table.csv")[0] == 0
    with warnings.catch_warnings(action="ignore"):
        again = echocal.read_observations(tmp_path / "table.csv")
    np.testing.assert_array_equal(again.echo_time, read.echo_time)
    assert again.unusable.tolist() == read.unusable.tolist()

    streamed = name if dialect != "blanks" else "table.csv"  # which correct asks for in its place
    own = options if streamed == name else []
    words = ["--model", "model.json", *own]
    assert run("correct", streamed, *words, "-o", "corrected.csv", "--quiet") == (0, "")
    out = (tmp_path / "corrected.csv").read_bytes()
    assert out.startswith(codecs.BOM_UTF8) == ("mark" in dialect)
    rows = corrected(tmp_path / "corrected.csv")
    assert [reason for *_, reason in rows] == [str(reason) for reason in read.unusable]
    found = np.array([np.nan if own is None else own for own, *_ in rows])
    np.testing.assert_allclose(found, np.where(read.usable, distance, np.nan), atol=6e-10)
    if "zipped" not in dialect:
        assert run("watch", streamed, *words, "--correct-only", "--once", "-o", "whole.jsonl")[0] == 0
        assert watched(tmp_path / "whole.jsonl") == rows


@pytest.mark.parametrize("end", ["20.1", '20.1,"two\nlin'])
def test_a_last_row_that_is_cut_is_one_for_each(
    end: str, run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    """It is still being written: its last field may go on, and the others are whole."""
    plain = text(random) + f"2026-01-03T00:00:00,12000,{end}"
    (tmp_path / "log.csv").write_text(plain)
    with pytest.warns(echocal.DataWarning, match="1 cut line"):
        read = echocal.read_observations(tmp_path / "log.csv")
    assert (read.unusable[-1], round(1e6 * read.echo_time[-1])) == ("cut line", 12000)
    assert run("correct", "log.csv", "--law", "linear", "-o", "out.csv", "--quiet") == (0, "")
    assert corrected(tmp_path / "out.csv")[-1] == (None, None, "cut line")
    words = ["--law", "linear", "--correct-only", "--once", "-o", "out.jsonl"]
    assert run("watch", "log.csv", *words)[0] == 0
    assert watched(tmp_path / "out.jsonl")[-1] == (None, None, "cut line")


def test_a_pipe_is_refused_with_the_way_out(tmp_path: Path) -> None:
    """It gives its bytes once, and a file is opened twice."""
    reads, writes = os.pipe()
    with os.fdopen(reads, "rb"), os.fdopen(writes, "wb") as pipe:
        pipe.write(b"echo_us,temperature_C\n5000,20\n")
        pipe.flush()
        with pytest.raises(echocal.DataError, match=f"/dev/fd/{reads} gives its bytes once"):
            echocal.read_observations(f"/dev/fd/{reads}")
