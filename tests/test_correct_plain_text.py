"""Text by the core, where its lines are plain: the same bytes as with care."""

from pathlib import Path

import numpy as np
import pytest

import echocal
from echocal import _core
from echocal.correct.text.parse import Parser

MODEL = echocal.Model("cramer", {"fixed_delay": {"delay": 30e-6}}).with_covariance(np.array([[1e-12]]))
WIDE = echocal.Model("cramer")
ROWS = 400

NUMBERS = ("{:.0f}", "{:.3f}", "{:e}", "{:.17g}", "{:08.2f}", "{:.1f}e0")
ODD = ("", "NA", "nan", "NaN", "null", "-", "+{:.0f}", " {:.0f}", "{:.0f} ", "{:.0f}.", "{:.0f}E+00", "1e400")
ENDS = ("\n", "\r\n")


def drawn(random: np.random.Generator, odd: float) -> list[list[str]]:
    """Rows with numbers as people write them; a part of the fields is odd, a part of the echoes negative."""

    def field(value: float) -> str:
        forms = ODD if random.random() < odd else NUMBERS
        return str(random.choice(forms)).format(value)

    echoes = random.uniform(600, 24_000, ROWS) * np.where(random.random(ROWS) < 0.02, -1, 1)
    conditions = zip(echoes, random.uniform(-20, 45, ROWS), random.uniform(0, 100, ROWS), strict=True)
    return [[*map(field, row), f"note {place}"] for place, row in enumerate(conditions)]


def written(rows: list[list[str]], separator: str, end: str, last: bool) -> bytes:
    """A table as a file."""
    lines = [["echo_us", "temperature_C", "humidity_percent", "remark"], *rows]
    return (end.join(separator.join(line) for line in lines) + (end if last else "")).encode()


def corrected(data: bytes, folder: Path, name: str, model: echocal.Model) -> bytes:
    source, out = folder / "in.csv", folder / f"{name}.csv"
    source.write_bytes(data)
    echocal.correct_files(source, out, model, uncertainties={"temperature_C": 0.5}, force=True)
    return out.read_bytes()


def outcome(data: bytes, folder: Path, name: str, model: echocal.Model) -> bytes | str:
    """The output, or the refusal."""
    try:
        return corrected(data, folder, name, model)
    except echocal.DataError as error:
        return str(error)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("odd", [0.0, 0.002, 0.1])
def test_the_same_bytes_as_with_care(
    separator: str, odd: float, tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = drawn(random, odd)
    for end in ENDS:
        for last in (True, False):
            data = written(rows, separator, end, last)
            for model in (MODEL, WIDE):
                plain = outcome(data, tmp_path, "plain", model)
                with monkeypatch.context() as patch:
                    patch.setattr(Parser, "plain", lambda *_: None)
                    assert plain == outcome(data, tmp_path, "careful", model)


def test_plain_rows_take_the_fast_way(
    tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    def careful(*_: object) -> None:
        raise AssertionError("read with care")

    monkeypatch.setattr(Parser, "table", careful)
    data = written(drawn(random, 0.0), ",", "\n", True)
    assert corrected(data, tmp_path, "out", MODEL).count(b"\n") == ROWS + 1


@pytest.mark.parametrize("spoiled", ['7,8,"9",x', "7,8,9", "7,8,9,x,1", "", "# 7,8,9,x", "7,8,9\r,x"])
def test_one_line_that_is_not_plain(
    spoiled: str, tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = written(drawn(random, 0.0), ",", "\n", True).splitlines(keepends=True)
    lines.insert(int(random.integers(1, len(lines))), f"{spoiled}\n".encode())
    plain = outcome(b"".join(lines), tmp_path, "plain", MODEL)
    with monkeypatch.context() as patch:
        patch.setattr(Parser, "plain", lambda *_: None)
        assert plain == outcome(b"".join(lines), tmp_path, "careful", MODEL)


def test_distances_have_the_digits_of_arrow(random: np.random.Generator) -> None:
    pa = pytest.importorskip("pyarrow")
    exponents = random.uniform(-10, 5, 20_000)
    values = random.choice([-1.0, 1.0], 20_000) * 10**exponents
    uncertainty = (10 ** random.uniform(-10, 3, 20_000)).astype(np.float32)
    data = b"x\n" * len(values)
    ends = np.arange(len(values), dtype=np.uint32) * 2 + 1
    codes = np.zeros(len(values), np.int16)
    found = _core.with_results(data, ends, 1, ord(","), values, uncertainty, codes, [b"\n"])
    assert found is not None
    expected = [pa.array(own).cast(pa.string()).to_pylist() for own in (np.round(values, 9), uncertainty)]
    lines = found.decode().splitlines()
    assert lines == [f"x,{one},{other}" for one, other in zip(*expected, strict=True)]


def test_a_distance_of_a_thousand_kilometers(
    tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The core writes no number of so many digits."""
    rows = drawn(random, 0.0)
    rows[7][0] = rows[-1][0] = "7e12"
    for last in (True, False):
        data = written(rows, ",", "\r\n", last)
        plain = corrected(data, tmp_path, "plain", MODEL)
        with monkeypatch.context() as patch:
            patch.setattr(Parser, "plain", lambda *_: None)
            assert plain == corrected(data, tmp_path, "careful", MODEL)


def test_keys_and_times_beside_plain_numbers(
    tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ids are text and times are times; a model with a drift reads both."""
    folder = tmp_path / "models"
    folder.mkdir()
    for key, model in {"007": MODEL, "7": WIDE, "pier 3": MODEL}.items():
        model.save(folder / f"{key}.json")
    lines = ["sensor_id,time,echo_us,temperature_C"]
    for row in range(ROWS):
        key = random.choice(["007", "7", "pier 3", "", "8"])
        lines.append(f"{key},2026-01-02T03:{row // 60:02}:{row % 60:02},{random.uniform(600, 9000):.1f},21.5")
    source = tmp_path / "in.csv"
    source.write_text("\n".join(lines))
    found = []
    for name in ("plain", "careful"):
        with monkeypatch.context() as patch:
            if name == "careful":
                patch.setattr(Parser, "plain", lambda *_: None)
            echocal.correct_files(source, tmp_path / f"{name}.csv", models=folder, by="sensor_id")
        found.append((tmp_path / f"{name}.csv").read_bytes())
    assert found[0] == found[1]
    assert found[0].count(b"no model for this key") + found[0].count(b"no key") > ROWS / 4
    drift = echocal.Model("cramer", {"drift": {"rate": 1e-6}})
    source.write_text("\n".join(line.split(",", 1)[1] for line in lines))
    for name in ("plain", "careful"):
        with monkeypatch.context() as patch:
            if name == "careful":
                patch.setattr(Parser, "plain", lambda *_: None)
            echocal.correct_files(source, tmp_path / f"{name}-drift.csv", drift)
    assert (tmp_path / "plain-drift.csv").read_bytes() == (tmp_path / "careful-drift.csv").read_bytes()
