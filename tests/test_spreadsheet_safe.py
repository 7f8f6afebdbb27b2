"""On request, no text of a CSV file is a formula to a spreadsheet; everything else stays as it is."""

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct.results import RESULTS
from echocal.model.folder import file_name

Run = Callable[..., tuple[int, str]]

FORMULAS = [
    '=HYPERLINK("http://x","7")', "=1+1", "+1+2", "-2+3+cmd|' /C calc'!A0", "@SUM(A1)", "\t=1", " =2",
    "＝1+1", "\r=1", "=a\nb", "-inf", "+A1", "=", "=,;\t",
]  # fmt: skip
HARMLESS = [
    "tank 7",
    "-5.2",
    "+3",
    "-1e-5",
    "-,5",
    "-",
    "--",
    "a=b",
    "'=1",
    "7",
    "",
    "x-1",
    "=".join("ab"),
    "-12,5",
]


def field(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if set(text) & set('",\n\r') else text


def rows_of(path: Path) -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_bytes().decode(), newline="")))


def is_formula(text: str) -> bool:
    """As a spreadsheet has it: also behind blanks, and not a number."""
    plain = text.lstrip()
    return bool(re.match(r"[=@＝]|[-+][^\d.,\s+-]|[-+]\d.*[-+|!*/]", plain.replace("e-", "e")))


@pytest.mark.parametrize("way", ["text", "parquet"])
def test_formulas_become_texts_and_nothing_else_changes(
    way: str, random: np.random.Generator, tmp_path: Path, run: Run
) -> None:
    ids = random.permutation([*FORMULAS, *HARMLESS]).tolist()
    name = str(random.choice(["=cmd|A", "@note", "+x"]))
    table = pd.DataFrame(
        {"sensor_id": ids, name: ids[::-1], "echo_us": 11660.0, "temperature_C": np.linspace(-5, 5, len(ids))}
    )
    if way == "text":
        lines = [
            ",".join(map(field, map(str, row))) for row in [table.columns, *table.itertuples(index=False)]
        ]
        Path("in.csv").write_text("\n".join([*lines, "# =a comment", ""]), "utf-8", newline="")
    else:
        table.to_parquet("in.parquet")
    source = "in.csv" if way == "text" else "in.parquet"
    for words in ((), ("--spreadsheet-safe",)):
        assert run("correct", source, "-o", f"out{len(words)}.csv", "--law", "linear", "-q", *words) == (
            0,
            "",
        )
    plain, safe = rows_of(Path("out0.csv")), rows_of(Path("out1.csv"))
    assert len(plain) == len(safe)
    changed = set()
    for before, after in zip(plain, safe, strict=True):
        for old, new in zip(before, after, strict=True):
            if old != new:
                assert new == f"'{old}"
                changed.add(old)
    assert changed == {*FORMULAS, name}
    assert not changed & set(HARMLESS)
    assert not [text for row in safe[1:] if len(row) > 4 for text in row[:2] if is_formula(text)]
    assert safe[1][-4:] == plain[1][-4:]


def test_every_other_letter_stays(tmp_path: Path, run: Run) -> None:
    text = 'id, echo_us,temperature_C\r\n "a"",b" ,11660,-5\r\n=1,11661,20\r\n# =x\r\n\r\n"c",11662,+21\r\n'
    Path("in.csv").write_bytes(text.encode())
    assert run("correct", "in.csv", "-o", "out.csv", "--law", "linear", "-q", "--spreadsheet-safe") == (0, "")
    made = Path("out.csv").read_bytes().decode().split("\r\n")
    for old, new in zip(text.split("\r\n"), made, strict=True):
        assert new.startswith(old.replace("=1", '"\'=1"') if not old.startswith("#") else old)


def test_the_key_of_a_row_is_what_stands_in_the_file(tmp_path: Path, run: Run) -> None:
    """The apostrophe is written; the model is that of the sensor."""
    Path("models").mkdir()
    echocal.Model("linear").save(Path("models") / file_name("=1+1"))
    Path("in.csv").write_text("sensor_id,echo_us,temperature_C\n=1+1,11660,20\n")
    words = ["--models", "models", "--by", "sensor_id", "--spreadsheet-safe", "-q"]
    assert run("correct", "in.csv", "-o", "out.csv", *words) == (0, "")
    header, row = rows_of(Path("out.csv"))
    assert header[-4:] == list(RESULTS)
    assert row[0] == "'=1+1"
    assert float(row[3]) > 1.9


def test_verdicts_and_tables_of_an_inspection(random: np.random.Generator, tmp_path: Path, run: Run) -> None:
    rows = ["sensor_id,echo_us,temperature_C,distance_m"]
    rows += [f"{key},{random.normal(11660, 3):.1f},20,2.0" for key in ("=1+1", "7") for _ in range(30)]
    Path("in.csv").write_text("\n".join([*rows, ""]))
    words = ["diagnose", "in.csv", "--by", "sensor_id", "-o", "verdicts.csv", "--spreadsheet-safe", "-q"]
    assert run(*words) == (0, "")
    assert {row[0] for row in rows_of(Path("verdicts.csv"))} == {"sensor", "'=1+1", "7"}
    assert run("inspect", "in.csv", "--write", "table.csv", "--spreadsheet-safe", "-q") == (0, "")
    assert {row[0] for row in rows_of(Path("table.csv"))} == {"sensor_id", "'=1+1", "7"}
    code, told = run("diagnose", "in.csv", "--spreadsheet-safe")
    assert (code, told.count("\n")) == (2, 1)
    code, told = run("correct", "in.csv", "-o", "out.parquet", "--spreadsheet-safe")
    assert (code, told.count("\n")) == (2, 1)
