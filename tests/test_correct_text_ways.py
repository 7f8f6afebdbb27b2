"""A text is corrected in blocks or as a whole, with or without Arrow: the same bytes each time."""

import csv
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import echocal
from echocal import _core
from echocal.correct import correct_files
from echocal.correct.text import file as text_file
from echocal.observations import scanner
from echocal.observations.layout import Layout
from echocal.observations.numbers import NO_NUMBER, number_of

WHOLE = 1 << 23
PLAIN = (
    "20",
    "20.5",
    "-3.25",
    "19.999999",
    "21.0000000000000001",
    "1e1",
    "2.5E+02",
    "0.30000000000000004",
    "15.",
    "7.0",
    "0012",
)
ODD = (
    *("", " ", " 5", "5 ", "\t7", "nan", "NaN", "NA", "nan ", "null", "-", "--", "unknown", "error"),
    *("+5", ".5", "5.", ".", "-0", "-.5", "1E2", "1e", "1e22", "1e23", "1e400", "-1e400", "1e-400", "4e-320"),
    *("12345678901234567890123", "0.1234567890123456789012345", "9007199254740993", "99999999", "123456789"),
    *(
        "inf",
        "-INF",
        "abc",
        "1_0",
        "5,5",
        "5.5.5",
        "0x10",
        '"7"',
        '"a, ""b"""',
        '"',
        "ä",
        "5\u00a0",
        "\ufeff",
    ),
    *("#c", "٣"),
)
SPOILED: Sequence[Callable[[str, str], str]] = (
    lambda line, separator: line + separator,
    lambda line, separator: f"{line}{separator}x",
    lambda line, separator: line.rpartition(separator)[0],
    lambda line, separator: f'"{line}"',
    lambda line, separator: f"# {line}",
    lambda line, separator: f"{line} ",
    lambda line, separator: f"{line}\r",
    lambda line, separator: "",
)


@st.composite
def tables(draw: st.DrawFn) -> tuple[str, Layout]:
    separator = draw(st.sampled_from(",,;\t|"))
    decimal = draw(st.sampled_from(".," if separator != "," else "."))
    end = draw(st.sampled_from(["\n", "\n", "\r\n"]))
    odd = draw(st.lists(st.sampled_from(ODD), min_size=1, max_size=3))
    fields = {
        "echo_us": st.sampled_from(["11660", "5000.5", "2.5e3", "12000", "8000.25", "11660.123456789"]),
        "temperature_C": st.sampled_from(PLAIN),
        "humidity_percent": st.sampled_from(["50", "40.5", "99.9", "7"]),
        "remark": st.sampled_from(["a", "long enough for several words", "", "ü", "007"]),
    }
    names = draw(st.permutations(list(fields)))
    share = draw(st.sampled_from([0, 0, 1, 5]))  # fields of a hundred that are odd, and a fifth of the lines
    lines = [separator.join(names)]
    for _ in range(draw(st.integers(1, 30))):
        own = [draw(fields[name]).replace(".", decimal) for name in names]
        if draw(st.integers(0, 99)) < 4 * share:
            own[draw(st.integers(0, len(own) - 1))] = draw(st.sampled_from(odd))
        line = separator.join(own)
        if draw(st.integers(0, 99)) < share:
            line = draw(st.sampled_from(SPOILED))(line, separator)
        lines.append(line)
    last = draw(st.sampled_from([end, end, ""]))
    return end.join(lines) + last, Layout(decimal=decimal if decimal == "," else None)


@contextmanager
def way(name: str, size: int) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(text_file, "_BLOCK", (WHOLE, WHOLE) if name == "whole" else (size, size))
        if name == "without Arrow":
            patch.setattr(scanner, "has_arrow", lambda: False)
        yield


def told(source: Path, model: echocal.Model, threads: int, **options: Any) -> bytes | str:
    out = source.with_name("out.csv")
    try:
        correct_files(source, out, model, processes=threads, **options)
    except echocal.DataError as error:
        return str(error)
    return out.read_bytes()


@settings(max_examples=150, deadline=None)
@given(tables(), st.sampled_from([64, 300, 1 << 18]), st.sampled_from([(), ["error"], ["unknown", "-9999"]]))
def test_the_same_bytes_by_each_way(table: tuple[str, Layout], size: int, missing: Sequence[str]) -> None:
    text, layout = table
    model = echocal.Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    options = {"uncertainties": ["temperature_C=0.5", "echo_us=3"], "missing": missing, "layout": layout}
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "in.csv"
        source.write_bytes(text.encode())
        found = {}
        for name, threads in (("core", 1), ("core", 2), ("without Arrow", 1), ("field by field", 1)):
            with way(name, size):
                found[name, threads] = told(source, model, threads, **options)
    first, *others = found.values()
    assert all(other == first for other in others), found


@pytest.mark.parametrize("field", ["\ufeff20", "-INF", "inf", "+Infinity", "-nan", "\ufeff"])
def test_odd_numbers_at_the_start_of_a_block(field: str, tmp_path: Path) -> None:
    """A mark of UTF-8 there is a part of the field; infinities are no numbers."""
    rows = [f"{field},11660,50,a"] + ["20,11660,50,a"] * 3
    for lines in (rows, rows[::-1]):
        source = tmp_path / "in.csv"
        source.write_text("\n".join(["temperature_C,echo_us,humidity_percent,remark", *lines, ""]), "utf-8")
        found = []
        for name in ("blocks", "without Arrow", "whole"):
            with way(name, 64):
                found.append(told(source, echocal.Model("cramer"), 1))
        assert found[1:] == found[:1] * 2


@st.composite
def columns_of_fields(draw: st.DrawFn) -> tuple[list[str], str]:
    decimal = draw(st.sampled_from(".,"))
    return draw(st.lists(st.sampled_from((*PLAIN, *ODD)), min_size=1, max_size=30)), decimal


@settings(max_examples=300, deadline=None)
@given(columns_of_fields())
def test_a_field_is_the_number_that_a_watch_reads(column: tuple[list[str], str]) -> None:
    """Each by itself, in a plain row and in one with quotation marks."""
    fields, decimal = column
    absent = [text.encode() for text in sorted(NO_NUMBER)]
    for field in fields:
        bare = next(csv.reader([field], delimiter=";", skipinitialspace=True), [""])[0] if field else ""
        wanted = number_of(bare, NO_NUMBER, decimal)
        for row in (f"a;{field}\n", f'"a";{field}\n'):
            scan = _core.Scanner(ord(";"), 2, False, False, []).scan(row.encode(), True)
            if scan.wrong is not None:
                continue
            read = scan.numbers([1], ord(decimal), absent)[0]
            found = None if read is None else read[0]
            assert (found is None) == (wanted is None), field
            assert found is None or np.array_equal(found, [wanted], equal_nan=True), field


def texts(numbers: Any) -> list[str]:
    """As Arrow writes them, which wrote the results of the first versions."""
    column = pa.array(numbers, mask=np.isnan(numbers))
    return [text or "" for text in pa.compute.cast(column, pa.string()).to_pylist()]


def test_digits_are_those_of_arrow(random: np.random.Generator) -> None:
    count = 30_000
    sizes = [
        random.uniform(0, 20, count),
        np.exp(random.uniform(-30, 60, count)),
        random.uniform(-3e6, 3e6, count),
    ]
    exact = [0.0, -0.0, 5.0, 1e-9, -5e-10, 1e-6, 9.99e-7, 0.1, 120.0, 1e6, 999_999.999999999, 1e9, 1e10, 1e15]
    distance = np.concatenate([*sizes, exact, [np.nan, np.inf, -np.inf]])
    bits = random.integers(0, 1 << 32, len(distance), dtype=np.uint32)
    uncertainty = np.where(np.arange(len(bits)) % 2, bits.view(np.float32), distance.astype(np.float32))
    lines = scanned(b"a\n" * len(distance), 1)
    codes = np.zeros(len(distance), np.int16)
    written = lines.with_results(distance, uncertainty, codes, [b";"], ord("."))
    found = written.tobytes().decode().split("\n")
    with np.errstate(over="ignore", invalid="ignore"):
        wanted = zip(texts(np.round(distance, 9)), texts(uncertainty), strict=True)
    assert found == [*(f"a;{one};{other};;" for one, other in wanted), ""]


def scanned(data: bytes, width: int) -> _core.Lines:
    return _core.Scanner(ord(";"), width, True, False, []).scan(data, True)


def test_lines_and_results_fit_each_other() -> None:
    lines = scanned(b"5;3\r\n6;1", 2)
    assert (len(lines), lines.taken, lines.count) == (2, 8, 2)
    distance, uncertainty, codes = np.ones(2), np.ones(2, np.float32), np.zeros(2, np.int16)
    with pytest.raises(ValueError, match="columns differ in length: the text has 2 rows, distance has 3"):
        lines.with_results(np.ones(3), uncertainty, codes, [b";"], 46)
    with pytest.raises(IndexError, match="no status 1"):
        lines.with_results(distance, uncertainty, codes + np.int16(1), [b";"], 46)
    with pytest.raises(IndexError, match="no status"):
        lines.with_results(distance, uncertainty, codes - np.int16(1), [b";"], 46)
    written = lines.with_results(distance, uncertainty, codes, [b";", b"a;a"], 46)
    assert written.tobytes() == b"5;3;1;1;;\r\n6;1;1;1;;"
    for places in ([0, 2], [1, 0], [1, 1]):
        with pytest.raises(ValueError, match="do not ascend, or are beyond"):
            lines.numbers(places, 46, [b""])
    with pytest.raises(ValueError, match="a separator of ASCII"):
        _core.Scanner(ord('"'), 2, True, False, [])


@pytest.mark.parametrize("mark", ["", '"'])
def test_keys_and_times_beside_numbers(mark: str, tmp_path: Path, random: np.random.Generator) -> None:
    """Ids are text and times are times, quoted or not, beside numbers."""
    folder, source = tmp_path / "models", tmp_path / "in.csv"
    folder.mkdir()
    for key, delay in {"007": 1e-5, "7": 2e-5, "pier 3": 3e-5}.items():
        echocal.Model("cramer", {"fixed_delay": {"delay": delay}}).save(folder / f"{key}.json")
    lines = ["sensor_id,time,echo_us,temperature_C"]
    for row in range(300):
        key = random.choice(["007", "7", "pier 3", "", "8", "NA"])
        own = [key, f"2026-01-02T03:{row // 60:02}:{row % 60:02}", f"{random.uniform(600, 9000):.1f}", "21.5"]
        lines.append(",".join(mark + field + mark for field in own))
    drift = echocal.Model("cramer", {"drift": {"rate": 1e-6}})
    found: dict[str, list[bytes]] = {}
    for name in ("blocks", "without Arrow", "whole"):
        with way(name, 1 << 18):
            source.write_text("\n".join(lines))
            correct_files(source, tmp_path / f"{name}.csv", models=folder, by="sensor_id")
            source.write_text("\n".join(line.split(",", 1)[1] for line in lines))
            correct_files(source, tmp_path / f"{name}-drift.csv", drift)
        found[name] = [(tmp_path / f"{name}{end}.csv").read_bytes() for end in ("", "-drift")]
    assert found["blocks"] == found["without Arrow"] == found["whole"]
    assert found["blocks"][0].count(b"no model for this key") > 30
