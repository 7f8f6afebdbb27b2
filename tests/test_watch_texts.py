"""Texts that are watched: what is no row, headers, encodings, decimal commas."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from test_watch_command import Run, lines, table
from watched import csv, log


def test_what_is_no_row_can_be_kept_with_its_reason(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    rows = log(random, 6)
    text = csv(rows[:3]) + "1,2\n" + csv(rows[3:]) + '{"echo_us": 1, "echo_us": 2}\n'
    (tmp_path / "log.csv").write_bytes(text.encode() + b"\xff\xfe,1,2\n")
    words = ["log.csv", "--law", "linear", "--once", "-o", "out.csv", "--dead-letters", "aside.jsonl"]
    code, said = run("watch", *words)
    assert (code, "7 rows, 6 corrected" in said, "2 set aside in aside.jsonl" in said) == (0, True, True)
    assert table(tmp_path / "out.csv")[4] == ["1", "2", "", "", "", "", "temperature_C missing"]
    letters = lines(tmp_path / "aside.jsonl")
    assert [letter["source"] for letter in letters] == ["log.csv"] * 2
    assert "twice" in letters[0]["reason"]
    assert "base64" in letters[1]


def test_texts_are_written_as_they_are_or_set_aside(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    """A carriage return stays within its field; what is no UTF-8, or has a stray mark, is no row."""
    first, *rest = (row | {"note": "n"} for row in log(random, 5))
    whole = csv([first, *rest])
    head, *rows = whole.encode().splitlines()
    notes = [b'"a\rb"', b'12" pipe', b"caf\xe9", b'"abc"x', b'"cut']
    spoiled = b"\n".join([head, *(row[: -len(b"n")] + note for row, note in zip(rows, notes, strict=True))])
    (tmp_path / "log.csv").write_bytes(spoiled)
    words = ["log.csv", "--law", "linear", "--once", "-o", "out.csv", "--dead-letters", "aside.jsonl"]
    code, said = run("watch", *words)
    assert (code, "3 rows, 2 corrected" in said, "2 set aside in aside.jsonl" in said) == (0, True, True)
    made = pd.read_csv(tmp_path / "out.csv", lineterminator="\n")
    assert made["note"].tolist() == ["a\rb", '12" pipe', "cut"]
    assert made["status"].tolist()[2] == "cut line"
    reasons = [letter["reason"] for letter in lines(tmp_path / "aside.jsonl")]
    assert ["no UTF-8" in reason for reason in reasons] == [True, False]
    assert ["--encoding" in reason for reason in reasons] == [True, False]


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16", "utf-16-le"])
def test_a_header_in_another_encoding_is_refused(encoding: str, run: Run, tmp_path: Path) -> None:
    """With the option that reads it."""
    text = "time,échos_us,temperature_C\n2026-01-01T00:00:00Z,11660,20\n"
    (tmp_path / "log.csv").write_bytes(text.encode(encoding))
    words = ["watch", "log.csv", "--law", "linear", "--once", "--correct-only"]
    code, said = run(*words)
    assert (code, "--encoding" in said) == (3, True)
    options = ["--encoding", encoding, "--column", "échos_us=echo_us"]
    assert run(*words, *options) == (0, "1 rows, 1 corrected; 0 changes told\n")


@pytest.mark.parametrize("blank", ["", " "])
def test_a_header_that_comes_again_is_no_row(
    blank: str, run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    rows = log(random, 30)
    header = f",{blank}".join(rows[0])
    text = "".join(csv(rows[at : at + 10]).replace(",".join(rows[0]), header) for at in (0, 10, 20))
    (tmp_path / "log.csv").write_text(text)
    words = ["log.csv", "--law", "linear", "--once", "-o", "out.csv"]
    assert run("watch", *words) == (0, "30 rows, 30 corrected; 0 changes told\n")


def test_another_header_in_the_middle_is_one(run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    """A logger that starts again writes its columns in another order, and one more."""
    rows = log(random, 30)
    names = [*random.permutation(list(rows[0])).tolist(), "battery_V"]
    later = [{name: {**row, "battery_V": "3.3"}[name] for name in names} for row in rows[15:]]
    (tmp_path / "log.csv").write_text(csv(rows[:15]) + csv(later))
    (tmp_path / "plain.csv").write_text(csv(rows))
    for name in ("log", "plain"):
        words = [f"{name}.csv", "--law", "linear", "--once", "-o", f"{name}.jsonl"]
        assert run("watch", *words) == (0, "30 rows, 30 corrected; 0 changes told\n")
    found = [row.pop("corrected_distance_m") for row in lines(tmp_path / "log.jsonl")]
    assert found == [row["corrected_distance_m"] for row in lines(tmp_path / "plain.jsonl")]
    assert lines(tmp_path / "log.jsonl")[-1]["battery_V"] == "3.3"


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_commas(separator: str, run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    """As `echocal correct` reads them: seen where the separator is another one, else by --decimal."""
    rows = log(random, 20)
    (tmp_path / "plain.csv").write_text(csv(rows))
    suffix = ".tsv" if separator == "\t" else ".csv"
    (tmp_path / f"log{suffix}").write_text(csv(rows).replace(",", separator).replace(".", ","))
    texts = [{name: text.replace(".", ",") for name, text in row.items()} for row in rows]
    (tmp_path / "log.jsonl").write_text("".join(json.dumps(row) + "\n" for row in texts))
    shared = ["--law", "linear", "--once"]
    assert run("watch", "plain.csv", *shared, "-o", "plain-out.csv")[0] == 0
    wanted = [row[4:] for row in table(tmp_path / "plain-out.csv")[1:]]
    assert all(row[0] for row in wanted)
    for source, options in ((f"log{suffix}", []), ("log.jsonl", ["--decimal", ","])):
        assert run("watch", source, *shared, *options, "-o", "out.jsonl")[0] == 0
        for row, own in zip(lines(tmp_path / "out.jsonl"), wanted, strict=True):
            assert [str(row["corrected_distance_m"]), row["status"]] == [own[0], own[2]]
    code, said = run("watch", "log.jsonl", *shared, "-o", "out.jsonl")
    assert (code, "no row could be corrected: 20 x echo_us is no number" in said) == (3, True)
    assert "pass --decimal ," in said
    assert {row["status"] for row in lines(tmp_path / "out.jsonl")} == {"echo_us is no number"}


def test_a_file_that_has_a_header_only(run: Run, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time,echo_us,temperature_C,distance_m\n")
    assert run("watch", "log.csv", "--once")[1].startswith("0 rows")


def test_a_field_that_goes_on_hides_nothing(run: Run, tmp_path: Path) -> None:
    """The rows before it are corrected at once, with the comma that they show; it waits for its end."""
    first = 'time;echo_us;temperature_C;note\n2026-01-01;11660,5;20;a\n2026-01-02;11660,5;20;"two\n'
    words = ["log.csv", "--law", "linear", "--correct-only", "--once", "--state", "s.db", "-o", "out.jsonl"]
    (tmp_path / "log.csv").write_text(first)
    code, said = run("watch", *words)
    assert (code, "ends within a line" in said, "1 rows, 1 corrected" in said) == (0, True, True)
    (tmp_path / "log.csv").write_text(first + 'lines"\n2026-01-03;11660;20;"stray\n2026-01-04;11660;20;\n')
    assert "line 5" in run("watch", *words)[1]
    found = lines(tmp_path / "out.jsonl")
    assert [row["note"] for row in found] == ["a", "two\nlines", ""]
    assert all(row["corrected_distance_m"] > 2.0 for row in found)


def test_a_watch_that_corrects_nothing_says_so(run: Run, tmp_path: Path) -> None:
    """Not so once a row was corrected, by an earlier watch with the same state, too."""
    words = ["log.csv", "--law", "linear", "--correct-only", "--once", "--state", "s.db"]
    text = "echo_us,temperature_C\nfar,20\n11660\n"
    for more, wanted, says in (
        (
            "",
            3,
            "no row could be corrected: 1 x echo_us is no number, first 'far'; 1 x temperature_C missing",
        ),
        ("11660,20\n", 0, "1 rows, 1 corrected"),
        ("near,20\n", 0, "1 rows, 0 corrected"),
    ):
        text += more
        (tmp_path / "log.csv").write_text(text)
        code, said = run("watch", *words)
        assert (code, says in said) == (wanted, True), said
