"""A line with more fields than the header costs one row, not the file, and its text is not lost."""

import io
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files

MODELS = {
    "one row alone": echocal.Model("linear", {"fixed_delay": {"delay": 31e-6}}),
    "rows before": echocal.Model(
        "linear", {"temperature_lag": {"time_constant": 600.0}, "fixed_delay": {"delay": 31e-6}}
    ),
}
HEADER = "time,echo_us,temperature_C,remark"
BAD = '2026-03-01 00:00:05,11660,20.0,5,"a ""b"""'


def log(random: np.random.Generator, bad: dict[int, str], rows: int = 12) -> str:
    """Air that warms slowly: with steps of 10 K in a second, a lag of 600 s tells of air that cannot be."""
    first, slope = random.uniform(5, 25), random.uniform(-2e-3, 2e-3)
    lines = [
        f"2026-03-01 00:00:{row:02d},{random.uniform(3000, 15000):.0f},{first + slope * row:.4f},r{row}"
        for row in range(rows)
    ]
    for row, text in bad.items():
        lines[row] = text
    return "\r\n".join([HEADER, *lines]) + "\r\n"


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_the_row_is_marked_and_the_others_are_corrected(
    model: echocal.Model, random: np.random.Generator, tmp_path: Path
) -> None:
    """They have the distances that they have where the line has empty fields in their place."""
    text = log(random, {5: BAD})
    (tmp_path / "bad.csv").write_bytes(text.encode())
    (tmp_path / "empty.csv").write_bytes(text.replace(BAD, ",,,").encode())
    for name in ("bad", "empty"):
        correct_files(tmp_path / f"{name}.csv", tmp_path / f"{name}_out.csv", model, force=True)
    bad, empty = (pd.read_csv(tmp_path / f"{name}_out.csv") for name in ("bad", "empty"))
    assert bad["status"].fillna("").tolist() == ["corrupt line" if row == 5 else "" for row in range(12)]
    np.testing.assert_array_equal(bad["corrected_distance_m"], empty["corrected_distance_m"])
    assert np.isfinite(bad["corrected_distance_m"].drop(5)).all()
    assert bad["time"][5] == BAD
    lines = (tmp_path / "bad_out.csv").read_bytes().decode().split("\r\n")
    for row, own in enumerate(text.split("\r\n")):
        assert row == 6 or lines[row].startswith(own)


def test_empty_fields_beyond_the_header_are_no_fields(random: np.random.Generator, tmp_path: Path) -> None:
    text = log(random, {})
    more = text.replace("r3\r\n", "r3,, \r\n")
    assert more != text
    (tmp_path / "log.csv").write_bytes(more.encode())
    model = MODELS["one row alone"]
    corrected = correct_files(tmp_path / "log.csv", tmp_path / "out.csv", model)
    assert corrected.unusable == 0
    found = pd.read_csv(tmp_path / "out.csv")
    assert found["remark"].tolist() == pd.read_csv(io.StringIO(text))["remark"].tolist()
    assert found["corrected_distance_m"].notna().all()


def test_to_parquet(random: np.random.Generator, tmp_path: Path) -> None:
    """Columns keep their types: the row has no value, and a reason."""
    pytest.importorskip("pyarrow")
    (tmp_path / "log.csv").write_text(log(random, {5: BAD}))
    corrected = correct_files(tmp_path / "log.csv", tmp_path / "out.parquet", MODELS["one row alone"])
    assert corrected.unusable == 1
    found = pd.read_parquet(tmp_path / "out.parquet")
    assert found["temperature_C"].dtype == np.float64
    assert found["temperature_C"].isna().tolist() == [row == 5 for row in range(12)]
    assert found["status"][5] == "corrupt line"


def test_half_of_the_lines_are_something_else(random: np.random.Generator, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(log(random, dict.fromkeys(range(3, 9), BAD)))
    with pytest.raises(echocal.DataError, match=r"rows of 4 fields .* 6 of 12 rows have more, first row 4"):
        correct_files(tmp_path / "log.csv", tmp_path / "out.csv", MODELS["one row alone"])
    assert not (tmp_path / "out.csv").exists()
