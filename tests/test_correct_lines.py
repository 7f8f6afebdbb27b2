"""Lines of a text end at LF, CR and CRLF, and nowhere else; each row keeps its own results."""

import csv
import io
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.results import RESULTS
from echocal.observations.layout import Layout

MODEL = echocal.Model("linear", {"fixed_delay": {"delay": 31e-6}})
NO_ENDS = ["\x0b", "\x0c", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029"]
"""Where `str.splitlines` cuts, beside the ends of lines."""

WAYS = {
    "plain": lambda sign: f"a{sign}b",
    "in marks": lambda sign: f'"a{sign}b, c"',
    "in marks over lines": lambda sign: f'"a{sign}b\nc"',
    "a row without the last field": lambda sign: f"a{sign}b,11660",
    "alone": lambda sign: sign,
}


def rows_of(path: Path) -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_bytes().decode(), newline="")))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("sign", NO_ENDS, ids=ascii)
def test_no_other_sign_ends_a_line(
    sign: str, way: str, end: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """The row has the fields and the results that it has with a letter in place of the sign."""
    count, odd = 8, int(random.integers(8))
    echoes, degrees = random.integers(3000, 20_000, count), random.uniform(0, 30, count).round(1)
    for name, own in (("sign", sign), ("letter", "x")):
        lines = [f"r,{echo},{degree}" for echo, degree in zip(echoes, degrees, strict=True)]
        lines[odd] = lines[odd].replace("r", WAYS[way](own), 1)
        if "without" in way:
            lines[odd] = WAYS[way](own)
        text = end.join([f"remark{own},echo_us,temperature_C", *lines, ""])
        (tmp_path / f"{name}.csv").write_bytes(text.encode())
        correct_files(tmp_path / f"{name}.csv", tmp_path / f"{name}_out.csv", MODEL)
    found, wanted = rows_of(tmp_path / "sign_out.csv"), rows_of(tmp_path / "letter_out.csv")
    assert len(found) == len(wanted) == count + 1
    assert [[field.replace(sign, "x") for field in row] for row in found] == wanted
    assert found[0] == [f"remark{sign}", "echo_us", "temperature_C", *RESULTS]
    assert sum(bool(row[3]) for row in found[1:]) == count - ("without" in way)


@pytest.mark.parametrize("to", ["csv", "parquet"])
@pytest.mark.parametrize("cell", ["m\n", "us\ndry", "min\r\n", "-\n1", "°C\n\n"])
def test_a_first_cell_over_two_lines_is_no_row_of_units(cell: str, to: str, tmp_path: Path) -> None:
    """Its first line alone could be a unit."""
    rows = [f'"{cell}",11660,20', "dry,11670,21", "dry,11680,22"]
    (tmp_path / "log.csv").write_text("\n".join(["remark,echo_us,temperature_C", *rows, ""]), newline="")
    summary = correct_files(tmp_path / "log.csv", tmp_path / f"out.{to}", MODEL)
    assert (summary.rows, summary.unusable) == (3, 0)
    read = pd.read_csv if to == "csv" else pd.read_parquet
    found = read(tmp_path / f"out.{to}")
    assert found["echo_us"].tolist() == [11660, 11670, 11680]
    assert found["remark"][0].replace("\r", "") == cell.replace("\r", "")
    assert (found["corrected_distance_m"] > 1.9).all()


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_distance_below_zero_is_none(kind: str, random: np.random.Generator, tmp_path: Path) -> None:
    """A number solves the equation there: no sensor sees a target behind itself."""
    offset = random.uniform(0.05, 0.1)
    model = echocal.Model("linear", {"zero_error": {"offset": offset}})
    distance = np.concatenate([random.uniform(0.02, 3.0, 200), offset + random.uniform(-1e-3, 1e-3, 40)])
    degrees = np.full(len(distance), 20.0)
    table = pd.DataFrame(
        {"echo_us": 1e6 * echocal.time_of_flight(distance, degrees, law="linear"), "temperature_C": degrees}
    )
    source = tmp_path / f"in.{kind}"
    table.to_csv(source, index=False) if kind == "csv" else table.to_parquet(source)
    summary = correct_files(source, tmp_path / f"out.{kind}", model)
    found = (pd.read_csv if kind == "csv" else pd.read_parquet)(tmp_path / f"out.{kind}")
    below = distance < offset
    assert 0 < below.sum() == summary.unusable < 150
    assert (found["status"].astype(object).fillna("") == np.where(below, "no distance fits", "")).all()
    assert (found["corrected_distance_m"].isna() == below).all()
    assert (found["corrected_distance_m"][~below] >= 0).all()


CUT_CELLS = ['"calm, dry', '"', '"calm\nand, dry', '"a ""b""', '"calm\n', '"20, 21\n22', '"calm\r\n\r\n']


@pytest.mark.parametrize("to", ["csv", "parquet"])
@pytest.mark.parametrize("place", [0, 2])
@pytest.mark.parametrize("cell", CUT_CELLS, ids=ascii)
def test_a_file_cut_within_a_quoted_cell_keeps_its_rows(
    cell: str, place: int, to: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """The row that is cut has a status, and stands outside of the marks that it left open."""
    pytest.importorskip("pyarrow")
    count = int(random.integers(1, 40))
    lines = ["remark,echo_us,temperature_C"] if not place else ["echo_us,temperature_C,remark"]
    for echo in random.integers(3000, 20_000, count + 1):
        fields = [str(echo), "20.5"]
        fields.insert(place, '"dry, calm"')
        lines.append(",".join(fields))
    whole = "\n".join(lines)
    last = whole.rindex('"dry')
    (tmp_path / "whole.csv").write_text(whole, newline="")
    (tmp_path / "cut.csv").write_text(whole[:last] + cell, newline="")
    for name in ("whole", "cut"):
        correct_files(tmp_path / f"{name}.csv", tmp_path / f"{name}_out.{to}", MODEL)
    read = pd.read_csv if to == "csv" else pd.read_parquet
    wanted, found = (read(tmp_path / f"{name}_out.{to}") for name in ("whole", "cut"))
    assert len(found) == count + 1
    pd.testing.assert_frame_equal(
        found[:count].astype(object), wanted[:count].astype(object), check_dtype=False
    )
    assert found["status"].tolist()[-1] == "cut line"
    assert np.isnan(found["corrected_distance_m"].to_numpy()[-1])


def test_any_cut_keeps_the_rows_above(random: np.random.Generator, tmp_path: Path) -> None:
    """Wherever it falls: the rows above have the results that they have in the whole file."""
    lines = ["time,remark,echo_us,temperature_C"]
    for row in range(12):
        remark = random.choice(['"wet,\n""cold"""', '"a, b"', "dry", '""', '"moved\nto 5\r\n6, 7"'])
        lines.append(f"2026-01-02 03:04:{row:02},{remark},{random.integers(3000, 20_000)},{20 + row / 8}")
    whole = ("\n".join(lines) + "\n").encode()
    (tmp_path / "whole.csv").write_bytes(whole)
    correct_files(tmp_path / "whole.csv", tmp_path / "whole_out.csv", MODEL)
    wanted = (tmp_path / "whole_out.csv").read_bytes()
    results = rows_of(tmp_path / "whole_out.csv")
    for cut in random.choice(np.arange(whole.index(b"\n2026") + 60, len(whole)), 60, replace=False):
        (tmp_path / "cut.csv").write_bytes(whole[:cut])
        correct_files(tmp_path / "cut.csv", tmp_path / "out.csv", MODEL, force=True)
        rows = rows_of(tmp_path / "out.csv")
        assert rows[:-1] == results[: len(rows) - 1], cut
        assert len(rows[-1]) == len(results[0]), cut
        above = wanted.index(results[len(rows) - 1][0].encode())
        assert (tmp_path / "out.csv").read_bytes()[:above] == wanted[:above]


def test_a_stray_mark_that_swallows_rows_is_no_cut(tmp_path: Path) -> None:
    for stray in ('"11662,20', '11662,"20', '"', '"\n'):
        rows = ["11660,20", "11661,20", stray, "11663,20", "11664,20"]
        (tmp_path / "log.csv").write_text("\n".join(["echo_us,temperature_C", *rows, ""]))
        with pytest.raises(echocal.DataError, match="nothing closes the quotation mark of line 4"):
            correct_files(tmp_path / "log.csv", tmp_path / "out.csv", MODEL)


def test_a_text_of_parquet_that_ends_a_line_stays_in_its_row(
    random: np.random.Generator, tmp_path: Path
) -> None:
    """A carriage return without a line feed was not quoted, so readers cut the row there."""
    signs = ["\r", "\n", "\r\n", "\r\r\n", ",", '"', "x", *NO_ENDS]
    texts = ["".join(random.choice(signs, random.integers(1, 6))) for _ in range(200)]
    table = pd.DataFrame({"remark": texts, "echo_us": 11660.0, "temperature_C": 20.0, "last": texts[::-1]})
    table.to_parquet(tmp_path / "in.parquet")
    correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", MODEL)
    header, *rows = rows_of(tmp_path / "out.csv")
    assert [row[0] for row in rows] == texts
    assert [row[3] for row in rows] == texts[::-1]
    assert {len(row) for row in rows} == {len(header)} == {8}
    assert all(float(row[4]) > 1.9 for row in rows)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-8-sig", "gb18030"])
@pytest.mark.parametrize("to", ["csv", "parquet"])
def test_a_file_cut_within_a_sign_keeps_its_rows(
    to: str, encoding: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """The sign is shown as one that cannot be read; anything else that is no text is refused as before."""
    rows = [f"{echo},20.5,kühl 𝄞" for echo in random.integers(3000, 20_000, int(random.integers(2, 300)))]
    text = "\n".join(["echo_us,temperature_C,remark", *rows])
    whole = text.encode(encoding)
    layout = Layout(encoding=encoding)
    for cut in (1, 2, 3):
        (tmp_path / "cut.csv").write_bytes(whole[:-cut])
        out = tmp_path / f"out.{to}"
        summary = correct_files(tmp_path / "cut.csv", out, MODEL, layout=layout, force=True)
        assert summary.rows == len(rows)
        found = (pd.read_csv if to == "csv" else pd.read_parquet)(out)
        status = found["status"].astype(object).fillna("").tolist()
        assert status[:-1] == [""] * (len(rows) - 1)
        assert status[-1] == "cut line"
    if encoding.startswith("utf-8"):
        (tmp_path / "bad.csv").write_bytes(whole.replace("ü".encode(), b"\xc3", 1))
        with pytest.raises(echocal.DataError, match="is not text in utf-8"):
            correct_files(tmp_path / "bad.csv", tmp_path / f"of bad.{to}", MODEL, layout=layout)


@pytest.mark.parametrize("above", [0, 1, 500])
def test_a_line_that_never_ends_is_refused_at_once(above: int, tmp_path: Path) -> None:
    """It took a minute for 100 MB of it, in each run again."""
    rows = "11660,20\n" * max(above - 1, 0)
    head = "echo_us,temperature_C\n" if above else ""
    (tmp_path / "log.csv").write_text(head + rows + "1" * 20_000_000)
    begun = time.process_time()
    with pytest.raises(echocal.DataError, match=rf"line {above + 1} has more than 4,194,304 bytes"):
        correct_files(tmp_path / "log.csv", tmp_path / "out.csv", MODEL)
    assert time.process_time() - begun < 3
