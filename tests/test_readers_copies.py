"""Columns that say the same, and rulers, which do not."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from test_readers_cases import CASES, inspected, read, write
from test_readers_logs import Run, shell

import echocal

__all__ = ["shell"]

COPIES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "factor": lambda cm: cm * 2,
    "counts": lambda cm: np.round(cm * 58.31),
    "inches": lambda cm: np.round(cm / 2.54, 1),
    "offset": lambda cm: np.round(250.0 - cm, 1),
    "both": lambda cm: np.round(0.3 + cm * 0.0049, 4),
    "whole": lambda cm: np.floor(cm),
}


def test_a_copy_is_left_aside() -> None:
    data = read(CASES / "copy-of-reading.csv", reading_speed=343)
    assert not data.extra
    assert any("'counts' is 2 times 'reading_cm'" in note and "copy" in note for note in data.notes)


@pytest.mark.parametrize("way", COPIES)
def test_copies_of_any_kind_are_told(way: str, random: np.random.Generator) -> None:
    cm = (random.choice([30.0, 75.0, 120.0, 210.0], 80) + random.normal(0, 0.4, 80)).round(1)
    air = (20 + random.normal(0, 2, 80)).round(1)
    other = (cm + random.normal(0, 0.6, 80)).round(1)
    table = {"reading_cm": cm, "temperature_C": air, "x": COPIES[way](cm), "second ranger": other}
    data = echocal.read_observations(table)
    assert list(data.extra) == ["second ranger"]
    assert any(note.startswith("'x' is ") and "'reading_cm'" in note for note in data.notes)
    assert list(echocal.read_observations(table, trust=["x"]).extra) == ["x", "second ranger"]


@pytest.mark.parametrize("ruler", ["tape_cm", "real_cm", "Tape measure (in)", "Actual distance (cm)"])
def test_a_ruler_is_never_to_be_the_reading(ruler: str, shell: Run) -> None:
    Path("log.csv").write_text(f"{ruler},Temp (C)\n" + "100,20.1\n120,20.2\n140,20.3\n" * 3)
    code, out, _ = shell("inspect", "log.csv", "--json", "-")
    assert code == 0
    found = json.loads(out)
    held = {column["name"]: column["proposal"]["request"] for column in found["columns"]}
    assert held[ruler].startswith("distance_")
    assert "=reading" not in found["refusal"]
    assert f"beside '{ruler}', which is the reference" in found["refusal"]
    code, _, err = shell("diagnose", "log.csv")
    assert code == 3
    assert "=reading" not in err


RULERS = ("tape_{}", "real_{}", "actual_{}", "ruler ({})")


@pytest.mark.parametrize("unit", ["cm", "mm", "in"])
@pytest.mark.parametrize("ruler", RULERS)
def test_round_places_on_a_ruler_are_no_copy(
    ruler: str, unit: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """A reading lies near a place, as a rounded copy of it would."""
    size = {"cm": 10, "mm": 100, "in": 10}[unit]
    places = np.repeat(np.arange(1, 9) * size, 3)
    reading = (places * random.uniform(1.0, 1.02) + size * random.uniform(0, 0.03, 24)).round(1)
    name = ruler.format(unit)
    lines = [f"{name},distance_{unit},temperature_c"]
    lines += [f"{p},{r},{c:.1f}" for p, r, c in zip(places, reading, random.normal(20, 2, 24), strict=True)]
    path = write(tmp_path, lines)
    found, holds = inspected(path)
    assert holds[name].startswith("distance_")
    assert holds[f"distance_{unit}"].startswith("reading_")
    assert not any("copy" in note or "left aside" in note for note in found.notes)
    data = read(path, columns=holds, reading_speed=343)
    assert data.reference_distance == pytest.approx(places * {"cm": 0.01, "mm": 0.001, "in": 0.0254}[unit])
    assert data.usable.all()


def test_a_setting_is_no_copy_of_what_follows_it(random: np.random.Generator) -> None:
    chamber = np.repeat([10.0, 15.0, 20.0, 25.0, 30.0, 35.0], 10)
    reading = (1000 - 1.7 * (chamber - 20) + random.normal(0, 0.3, 60)).round(1)
    table = {"reading_mm": reading, "temperature_C": (chamber + random.normal(0, 0.3, 60)).round(2)}
    assert list(echocal.read_observations({**table, "chamber_set": chamber}).extra) == ["chamber_set"]
