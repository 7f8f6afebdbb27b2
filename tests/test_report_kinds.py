"""The pages of several tables, a fleet, a calibration, a verification and an inspection."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browsed import CLEAN, Text, browsed, drawn_in

Run = Callable[..., tuple[int, str]]

COMMANDS = {
    "several tables": ("diagnose", "a.csv", "b.csv", "--base", "linear"),
    "fleet": ("diagnose", "a.csv", "--by", "sensor_id", "-o", "verdicts.csv", "--base", "linear"),
    "calibrate": ("calibrate", "a.csv", "--fit", "zero_error", "--law", "linear"),
    "verify": ("verify", "a.csv", "--maximum-permissible-error-mm", "3"),
    "inspect": ("inspect", "a.csv"),
}


@pytest.fixture
def tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator) -> None:
    """Two tables with an offset of 10 mm; two sensors in each."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        true = np.tile([0.5, 1.5, 3.0], 60)
        pd.DataFrame(
            {
                "reading_m": true + 10e-3 + random.normal(0.0, 1e-3, true.size),
                "temperature_C": random.uniform(5.0, 35.0, true.size),
                "distance_m": true,
                "sensor_id": np.repeat(["<i>left", "right"], true.size // 2),
            }
        ).to_csv(name, index=False)


def written(run: Run, kind: str) -> str:
    code, said = run(*COMMANDS[kind], "--quiet", "--report", f"{kind}.html")
    assert code == (kind == "verify"), said  # 10 mm exceed 3 mm
    return Path(f"{kind}.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("tables")
@pytest.mark.parametrize("kind", COMMANDS)
def test_a_page_needs_nothing_says_how_and_replaces_only_its_own(run: Run, kind: str) -> None:
    page = written(run, kind)
    text = Text(page)
    assert text.fetched == ["data:,"]
    assert text.links
    assert set(text.links) <= set(text.ids)
    assert "<i>left" not in page  # a name is no markup
    assert f"echocal {COMMANDS[kind][0]} a.csv" in text.seen
    assert len(page) < 200_000
    assert written(run, kind)  # again, over its own page
    Path("notes.html").write_text("<p>mine</p>")
    code, said = run(*COMMANDS[kind], "--quiet", "--report", "notes.html")
    assert (code, "notes.html" in said) == (2, True)
    assert Path("notes.html").read_text() == "<p>mine</p>"


@pytest.mark.usefixtures("tables")
def test_pages_say_the_result(run: Run) -> None:
    said = {kind: Text(written(run, kind)).seen for kind in COMMANDS}
    for kind in ("several tables", "fleet"):
        assert "zero_error" in said[kind]
    assert "2 named" in said["fleet"]
    assert "tables 2 rows used 360" in said["several tables"]
    assert "zero_error.offset" in said["calibrate"]
    assert "does not conform : 180 of 180 errors exceed 3 mm" in said["verify"]
    assert "reading_m its name" in said["inspect"]
    assert "180 of 180 rows can be used" in said["inspect"]


@pytest.mark.usefixtures("tables")
def test_drawn_values_are_those_of_the_table(run: Run) -> None:
    reading = pd.read_csv("a.csv")["reading_m"]
    (drawn, *_) = drawn_in(written(run, "inspect"), 0)
    assert drawn.x == list(range(1, 181))
    assert drawn.y == pytest.approx(reading, rel=1e-5)
    (alone, *_) = [one for one in drawn_in(written(run, "several tables"), 0) if one.name == "a, alone"]
    offset = 1e3 * (reading - pd.read_csv("a.csv")["distance_m"]).mean()
    delay = 2e3 * offset / 343.0  # us: which of the two is named is a draw
    assert alone.y == pytest.approx([offset], abs=1.0) or alone.y == pytest.approx([delay], abs=6.0)


@pytest.mark.slow
@pytest.mark.usefixtures("tables")
@pytest.mark.parametrize("kind", COMMANDS)
def test_a_browser_shows_them(run: Run, kind: str, tmp_path: Path) -> None:
    assert browsed(written(run, kind), tmp_path) == CLEAN
