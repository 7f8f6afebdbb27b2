"""Clocks of logs: counts in any unit at a join, halves of a day, counts whose unit nothing tells."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import echocal

Rows = list[tuple[float, str, float]]
Written = Callable[[Rows], list[str]]

EPOCH = 1_725_400_000


def read(folder: Path, lines: list[str], **options: Any) -> echocal.Observations:
    path = folder / "log.txt"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with warnings.catch_warnings(action="ignore"):
        return echocal.read_observations(path, **options)


def long_table(name: str, per_second: float, begin: float = 0.0) -> Written:
    """A table with a row for each value."""
    return lambda said: [
        f"{name},metric,value",
        *(f"{(begin + t) * per_second:.0f},{n},{v}" for t, n, v in said),
    ]


def mqtt(said: Rows) -> list[str]:
    return [f"{(EPOCH + t) * 1000:.0f} tank/{n} {v}" for t, n, v in said]


def messages(said: Rows) -> list[str]:
    return [f'{{"ts":{(EPOCH + t) * 1000:.0f},"{n}":{v}}}' for t, n, v in said]


def microcontroller(said: Rows) -> list[str]:
    spelled = {"distance_mm": ("sonar", "Distance", "mm"), "temperature_c": ("dht", "Temperature", "C")}
    return [f"I ({t * 1000:.0f}) {s[0]}: {s[1]}: {v} {s[2]}" for t, n, v in said for s in [spelled[n]]]


COUNTS: dict[str, Written] = {
    "ms since 1970": long_table("time", 1e3, EPOCH),
    "ns since 1970": long_table("time", 1e9, EPOCH),
    "us since the start": long_table("time_us", 1e6),
    "ms since the start": long_table("time_ms", 1e3),
    "minutes": long_table("time_min", 1 / 60),
    "a unit that nothing tells": long_table("ts", 1e3),
    "MQTT": mqtt,
    "messages": messages,
    "a microcontroller": microcontroller,
}


@pytest.mark.parametrize("way", COUNTS)
def test_counts_in_any_unit_are_joined(way: str, random: np.random.Generator, tmp_path: Path) -> None:
    every = 600.0
    at, air = np.arange(40) * every, 15.0 + np.cumsum(random.normal(0.0, 0.2, 40)).round(1)
    said = [(t, "distance_mm", float(random.integers(1200, 1400))) for t in at]
    said += [(t + 240.0, "temperature_c", float(v)) for t, v in zip(at, air, strict=True)]
    named = {} if way == "a microcontroller" else {"columns": {"distance_mm": "reading_mm"}}
    data = read(tmp_path, COUNTS[way](sorted(said)), **named)
    expected = np.interp(at, at + 240.0, air)
    assert data.conditions["temperature"][1:] == pytest.approx(expected[1:], abs=1e-6)
    assert data.joined["temperature"].how == "interpolated"
    if "nothing tells" in way:
        assert not any(" apart, up to" in note for note in data.notes)
    else:
        assert data.joined["temperature"].interval_s == pytest.approx(every, rel=1e-6)


def test_whole_degrees_that_are_written_when_they_change(random: np.random.Generator, tmp_path: Path) -> None:
    """No row loses its temperature where a day turns: there a record of changes has its longest intervals."""
    seconds = np.arange(0, 4 * 86400, 60)
    phase = random.uniform(0, 2 * np.pi)
    air = np.round(15 + random.uniform(4, 8) * np.sin(2 * np.pi * seconds / 86400 + phase))
    changes = np.flatnonzero(np.append(True, np.diff(air) != 0.0))
    said = [(float(seconds[n]), "temperature_c", float(air[n])) for n in changes]
    said += [(t + 1.0, "distance_mm", 1300.0) for t in np.arange(0, 4 * 86400, 600.0)]
    data = read(tmp_path, long_table("time", 1.0, EPOCH)(sorted(said)), columns={"distance_mm": "reading_mm"})
    inside = data.conditions["elapsed_time"] < seconds[changes[-1]] - data.conditions["elapsed_time"][0]
    found = data.conditions["temperature"][inside]
    assert np.isfinite(found).all()
    assert np.abs(found - air[:: 600 // 60][inside]).max() <= 1.0


@pytest.mark.parametrize("hours", [4.0, 24.0])
def test_a_join_says_what_it_did(hours: float, random: np.random.Generator, tmp_path: Path) -> None:
    """Values each four hours are joined by lines; those of each day are not, and no note says so."""
    said = [(t, "distance_mm", 1300.0) for t in np.arange(0, 8 * 86400, 1800.0)]
    said += [
        (t + 60.0, "temperature_c", float(random.normal(15, 3)))
        for t in np.arange(0, 8 * 86400, hours * 3600)
    ]
    data = read(
        tmp_path,
        long_table("time", 1.0, EPOCH)(sorted(said)),
        columns={"distance_mm": "reading_mm", "temperature_c": "temperature_C"},
    )
    join, known = data.joined["temperature"], np.isfinite(data.conditions["temperature"])
    assert join.without == (~known).sum()
    if hours == 4.0:
        assert join.how == "interpolated"
        assert known.mean() > 0.95
    else:
        assert join.how == "nearest"
        assert known.mean() < 0.05  # none is held for longer than the air is still


HALVES = (
    "12/25/2024 11:59:05 AM",
    "12/25/2024 12:00:05 PM",
    "12/25/2024 01:15:05 PM",
    "12/25/2024 11:15:05 PM",
)


@pytest.mark.parametrize("arrow", [" -> ", "  ", ", "])
def test_halves_of_a_day(arrow: str, tmp_path: Path) -> None:
    data = read(
        tmp_path, [f"{time}{arrow}Distance: 120.{n} cm" for n, time in enumerate(HALVES)], reading_speed=343
    )
    assert data.reading == pytest.approx([1.2, 1.201, 1.202, 1.203])
    assert data.conditions["elapsed_time"] == pytest.approx([0, 60, 60 + 75 * 60, 60 + 75 * 60 + 36000])


@pytest.mark.parametrize("brackets", ["[{}]", "({})"])
@pytest.mark.parametrize("step", [1000, 60_000, 10_000_037])
def test_a_count_in_brackets_is_asked_for(
    brackets: str, step: int, random: np.random.Generator, tmp_path: Path
) -> None:
    """Milliseconds are not taken for seconds, at any rate."""
    lines = [
        f"{brackets.format(17 + step * n)} dist={random.integers(1200, 1400)}mm temp=17.0C" for n in range(30)
    ]
    data = read(tmp_path, lines)
    assert "elapsed_time" not in data.conditions
    assert any("unknown unit" in note and "time_ms" in note for note in data.notes)
    asked = read(tmp_path, lines, columns={"timestamp": "time_ms"})
    assert np.diff(asked.conditions["elapsed_time"]) == pytest.approx([step / 1000] * 29)
    said = [line.replace("]", " ms]").replace(")", " ms)") for line in lines]
    assert np.diff(read(tmp_path, said).conditions["elapsed_time"]) == pytest.approx([step / 1000] * 29)


def test_equal_steps_of_microseconds_are_asked_for() -> None:
    table = {"time_s": np.arange(50) * 10_000_037, "echo_us": [11660.0] * 50}
    with pytest.raises(echocal.DataError, match=r"columns=\{'time_s': 'time_us'\}"):
        echocal.read_observations(table)


CONFIGURATION = (
    "[23:57:02][C][ultrasonic.sensor:046]:   Pulse time: 10 µs",
    "[23:57:02][C][ultrasonic.sensor:047]:   Timeout: 11661 µs",
    "[23:57:02][C][wifi:428]:   Signal strength: -61 dB",
)


@pytest.mark.parametrize("states", [True, False])
def test_what_a_component_is_set_to_is_no_measurement(states: bool, tmp_path: Path) -> None:
    lines = list(CONFIGURATION)
    for n in range(20):
        lines.append(f"[23:57:{n + 10}][D][ultrasonic.sensor:040]: 'Tank' - Got distance: 1.3{n:02d} m")
        if states:
            said = f"Sending state 1.3{n:02d}00 m with 2 decimals of accuracy"
            lines.append(f"[23:57:{n + 10}][D][sensor:094]: 'Tank': {said}")
    data = read(tmp_path, lines, reading_speed=343)
    assert data.reading == pytest.approx([1.3 + n / 1000 for n in range(20)])
    assert data.usable.all()
    assert not data.extra


@pytest.mark.parametrize("names", ["type", "sensor", "name"])
def test_kinds_of_values_by_any_name(names: str, random: np.random.Generator, tmp_path: Path) -> None:
    """A temperature is no distance, whatever the column of kinds is called; two rangers stay two."""
    lines = [f"time,{names},value,unit"]
    for n in range(30):
        lines.append(f"2024-09-03T10:{n:02d}:00,ultrasonic,{130 + n / 10},cm")
        lines.append(f"2024-09-03T10:{n:02d}:20,air temperature,{17 + n / 10:.1f},°C")
    data = read(tmp_path, lines)
    assert data.reading == pytest.approx([1.3 + n / 1000 for n in range(30)])
    assert data.conditions["temperature"][1:] == pytest.approx([17 + (n - 1 / 3) / 10 for n in range(1, 30)])
    two = [
        f"time,{names},value",
        *(f"2024-09-03T10:{n:02d}:00,sonar {n % 2},{130 + n % 2}" for n in range(30)),
    ]
    assert len(read(tmp_path, two, columns={"value": "reading_cm"}, reading_speed=343)) == 30
