"""One log in many dialects: what `echocal correct` takes, `echocal watch` takes, with the same results.

From a file, from a file that grows with a stop at any byte, and from a pipe.
"""

import csv
import io
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from watched import log

from echocal.correct.results import DISTANCE, STATUS, UNCERTAINTY

Run = Callable[..., tuple[int, str]]
Write = Callable[[np.random.Generator], bytes]

HEADER = ["time", "echo_us", "temperature_C", "note"]
SHARED = ["--law", "linear", "--uncertainty", "temperature_C=0.5"]
NOTES = ["", "a, b; c", 'of 12" pipe', "two\nlines", "é", "x\ty"]


def rows(random: np.random.Generator, count: int = 40) -> list[list[str]]:
    """Rows of which one has no temperature, one an echo that is no number, one an impossible one."""
    found = [[*list(row.values())[:3], str(place)] for place, row in enumerate(log(random, count))]
    places = random.choice(np.arange(5, count - 5), 3, replace=False).tolist()
    for place, (column, text) in zip(places, ((2, ""), (1, "far"), (2, "900.0")), strict=True):
        found[place][column] = text
    return found


def text(
    random: np.random.Generator,
    cut: str = ",",
    *,
    header: list[str] = HEADER,
    below: str = "",
    end: str = "\n",
    comma: bool = False,
) -> str:
    """Plain lines."""
    own = [[field.replace(".", ",") if comma else field for field in row] for row in rows(random)]
    return "".join([cut.join(header) + end + below, *(cut.join(row) + end for row in own)])


def lines_of(random: np.random.Generator) -> list[str]:
    return text(random).splitlines(keepends=True)


def quoted(random: np.random.Generator) -> bytes:
    """Fields with separators, quotation marks, letters of other languages and ends of lines."""
    file = io.StringIO()
    writer = csv.writer(file, quoting=csv.QUOTE_ALL, lineterminator="\n")
    writer.writerow(HEADER)
    writer.writerows([*row[:3], NOTES[place % len(NOTES)]] for place, row in enumerate(rows(random)))
    return file.getvalue().encode()


def again(random: np.random.Generator) -> bytes:
    """A logger that starts again: comments, blank lines, and the header once more."""
    head, *others = lines_of(random)
    return "".join(["# a logger\n", head, *others[:20], "\n# again\n", head, *others[20:]]).encode()


def ragged(random: np.random.Generator) -> bytes:
    """Rows that lack their last field, or have empty ones or a value too many."""
    made = lines_of(random)
    made[11] = made[11].rpartition(",")[0] + "\n"
    made[13] = made[13].replace("\n", ",,\n")
    made[17] = made[17].replace("\n", ",9\n")
    made[19] = "1,2\n"
    return "".join(made).encode()


def cut_short(random: np.random.Generator) -> bytes:
    """A last row that is still being written: its echo may be cut."""
    return text(random).rstrip("\n").rpartition(",")[0].rpartition(",")[0][:-3].encode()


def logger(random: np.random.Generator) -> bytes:
    """Lines of a Campbell logger: names, units, and how values were made."""
    made = [f'"{row[0].replace("T", " ")}",{n},{row[1]},{row[2]}' for n, row in enumerate(rows(random))]
    head = ['"TOA5","st","CR1000","1"', '"TIMESTAMP","RECORD","echo","AirT"', '"TS","RN","us","Deg C"']
    return "\r\n".join([*head, '"","","Smp","Avg"', *made, ""]).encode()


EUROPEAN = ["time", "echo_us", "température [°C]", "Höhe"]
DIALECTS: dict[str, tuple[Write, list[str]]] = {
    "comma": (lambda r: text(r).encode(), []),
    "semicolon and decimal comma": (lambda r: text(r, ";", comma=True).encode(), []),
    "tab and decimal comma": (lambda r: text(r, "\t", comma=True).encode(), []),
    "bar": (lambda r: text(r, "|").encode(), []),
    "blanks after commas": (lambda r: text(r, ", ").encode(), []),
    "quoted": (quoted, []),
    "mark of UTF-8": (lambda r: text(r).encode("utf-8-sig"), []),
    "UTF-16": (lambda r: text(r, ";", header=EUROPEAN).encode("utf-16"), ["--encoding", "utf-16"]),
    "Latin-1": (lambda r: text(r, header=EUROPEAN).encode("latin-1"), ["--encoding", "latin-1"]),
    "cp1252 that is seen": (
        lambda r: text(r, header=["time", "echo_us", "T [°C]", "Höhe"]).encode("cp1252"),
        [],
    ),
    "a line of units": (
        lambda r: text(r, header=["time", "echo", "temperature", "n"], below=",us,degC,\n").encode(),
        [],
    ),
    "CRLF": (lambda r: text(r, end="\r\n").encode(), []),
    "CR": (lambda r: text(r, end="\r").encode(), []),
    "comments and a header that comes again": (again, []),
    "lines that are skipped": (
        lambda r: b"Station 7\nbattery,3.3\n" + text(r).encode(),
        ["--skip-lines", "2"],
    ),
    "a logger's own line": (lambda r: b"Station 7 of the north\n" + text(r, ";").encode(), []),
    "sep=": (lambda r: b"sep=;\n" + text(r, ";").encode(), []),
    "TOA5": (logger, []),
    "ragged rows": (ragged, []),
    "a last row that is cut": (cut_short, []),
    "no end of the last line": (lambda r: text(r).rstrip("\n").encode(), []),
    "decimal comma that is said": (lambda r: text(r, ";", comma=True).encode(), ["--decimal", ","]),
}


def number(field: str) -> float | None:
    return float(field.replace(",", ".")) if field else None


UNENDED = {"a last row that is cut", "no end of the last line", "CR"}
"""Dialects whose last line may go on: after a carriage return a line feed may follow."""


def corrected(path: Path) -> list[tuple[float | None, float | None, str]]:
    """Results of `correct`: of each row, and of no line that is none."""
    content = path.read_bytes().decode("utf-8-sig")
    cut = content[content.index(DISTANCE) - 1]
    places: list[int] = []
    found = []
    for fields in csv.reader(io.StringIO(content, newline=""), delimiter=cut, skipinitialspace=True):
        if DISTANCE in fields:
            places = [fields.index(name) for name in (DISTANCE, UNCERTAINTY, STATUS)]
        elif len(fields) > max(places, default=999) and (fields[places[0]] or fields[places[2]]):
            own, spread, status = (fields[place] for place in places)
            found.append((number(own), number(spread), status))
    return found


def watched(path: Path) -> list[tuple[float | None, float | None, str]]:
    made: list[dict[str, Any]] = [json.loads(line) for line in path.read_text().splitlines()]
    return [(row[DISTANCE], row[UNCERTAINTY], row[STATUS]) for row in made]


def as_stdin(data: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    out, into = os.pipe()
    with open(into, "wb") as file:  # noqa: PTH123  (a pipe)
        file.write(data)
    monkeypatch.setattr(sys, "stdin", open(out))  # noqa: PTH123, SIM115


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_watch_reads_what_correct_reads(
    dialect: str, run: Run, tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, options = DIALECTS[dialect]
    data = write(random)
    (tmp_path / "log.csv").write_bytes(data)
    assert run("correct", "log.csv", *SHARED, *options, "-o", "corrected.csv", "--quiet") == (0, "")
    wanted = corrected(tmp_path / "corrected.csv")
    assert len(wanted) >= 39
    assert sum(distance is not None for distance, _, _ in wanted) >= 35
    words = [*SHARED, *options, "--correct-only", "--once"]
    assert run("watch", "log.csv", *words, "-o", "whole.jsonl")[0] == 0
    assert watched(tmp_path / "whole.jsonl") == wanted
    as_stdin(data, monkeypatch)
    assert run("watch", "-", *words, "-o", "pipe.jsonl")[0] == 0
    assert watched(tmp_path / "pipe.jsonl") == wanted
    cuts = sorted(random.integers(1, len(data), 4).tolist())
    for end in (*cuts, len(data)):
        (tmp_path / "growing.csv").write_bytes(data[:end])
        code, said = run("watch", "growing.csv", *words, "-o", "pieces.jsonl", "--state", "s.db")
        assert code == 0, said
    pieces = watched(tmp_path / "pieces.jsonl")
    whole_lines = len(wanted) - (dialect in UNENDED)
    assert pieces == wanted[:whole_lines]
    assert "ends within a line" in said or whole_lines == len(wanted)
