"""Quantities at other times than the readings: joined in time, told, and no fault planted."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal

Rows = list[tuple[float, str, float]]
Written = Callable[[Rows, pd.Timestamp], list[str]]

LATE = {"temperature_timestamp_shift", "temperature_lag"}
START = pd.Timestamp("2024-05-14T06:00:00")
EVERY = 600.0
GAP = 8 * 3600.0


class Air:
    """Air of some days: a course of the day, and weather that wanders for hours."""

    def __init__(self, random: np.random.Generator, days: float) -> None:
        self.times = np.arange(-7200.0, days * 86400.0 + 7200.0, 60.0)
        wander = np.zeros(len(self.times))
        for n, kick in enumerate(random.normal(0.0, 0.12, len(self.times) - 1), 1):
            wander[n] = wander[n - 1] * (1 - 60.0 / 7200.0) + kick
        smooth = np.convolve(wander, np.ones(15) / 15, "same")
        daily = random.uniform(4.0, 8.0) * np.sin(2 * np.pi * (self.times / 86400.0 - random.uniform(0, 1)))
        self.values = 14.0 + daily + smooth

    def __call__(self, at: Any) -> Any:
        return np.interp(at, self.times, self.values)


def log(
    random: np.random.Generator, air: Air, *, late: float, every: float, rows: int = 400, gap: bool = False
) -> tuple[Rows, np.ndarray]:
    """Readings each ten minutes, and temperatures `late` after them; and the air at the readings."""
    at = np.arange(rows) * EVERY
    distance = random.uniform(1.5, 3.0)
    reading = distance * 343.0 / (331.4 + 0.6 * air(at)) + random.normal(0.0, 3e-4, rows)
    when = np.arange(late - every, at[-1] + 2 * every, every)
    if gap:
        begin = random.uniform(0.3, 0.6) * at[-1]
        when = when[(when < begin) | (when > begin + GAP)]
    temperature = air(when).round(2)
    said = [(t, "distance", v) for t, v in zip(at, reading.round(4), strict=True)]
    said += [(t, "temperature", v) for t, v in zip(when, temperature, strict=True)]
    return sorted(said), air(at)


def home_assistant(said: Rows, start: pd.Timestamp) -> list[str]:
    names = {"distance": "sensor.tank_distance", "temperature": "sensor.outdoor_temperature"}
    lines = [f"{names[n]},{v:.4f},{(start + pd.Timedelta(seconds=t)).isoformat()}Z" for t, n, v in said]
    return ["entity_id,state,last_changed", *lines]


def influx(said: Rows, start: pd.Timestamp) -> list[str]:
    """All values of one field, then all of the other."""
    head = ",result,table,_start,_stop,_time,_value,_field,_measurement"
    lines = [
        f",,0,,,{(start + pd.Timedelta(seconds=t)).isoformat()}Z,{v:.4f},{n},tank"
        for t, n, v in sorted(said, key=lambda row: row[1])
    ]
    return [head, *lines]


def counted(said: Rows, start: pd.Timestamp) -> list[str]:
    """Seconds since 1970, and units beside the values."""
    units = {"distance": "m", "temperature": "°C"}
    lines = [f"{start.timestamp() + t:.0f};{n};{v:.4f};{units[n]}" for t, n, v in said]
    return ["timestamp;variable;value;unit", *lines]


def serial(said: Rows, start: pd.Timestamp) -> list[str]:
    names = {"distance": ("Distance", "m"), "temperature": ("Temperature", "°C")}
    return [
        f"{(start + pd.Timedelta(seconds=t)).strftime('%Y-%m-%d %H:%M:%S')} -> "
        f"{names[n][0]}: {v:.4f} {names[n][1]}"
        for t, n, v in said
    ]


def esphome(said: Rows, start: pd.Timestamp) -> list[str]:
    lines = []
    for t, n, v in said:
        clock = (start + pd.Timedelta(seconds=t)).strftime("%H:%M:%S")
        if n == "distance":
            lines.append(f"[{clock}][D][ultrasonic.sensor:040]: 'Tank' - Got distance: {v:.4f} m")
        unit = "m" if n == "distance" else "°C"
        lines.append(
            f"[{clock}][D][sensor:094]: '{'Tank' if n == 'distance' else 'Outside Temperature'}': "
            f"Sending state {v:.5f} {unit} with 2 decimals of accuracy"
        )
    return lines


def mqtt(said: Rows, start: pd.Timestamp) -> list[str]:
    return [f"{(start + pd.Timedelta(seconds=t)).isoformat()}+0000 tank/{n} {v:.4f}" for t, n, v in said]


WAYS: dict[str, Written] = {
    way.__name__: way for way in (home_assistant, influx, counted, serial, esphome, mqtt)
}
COLUMNS = {
    "home_assistant": {"sensor.tank_distance": "reading_m", "sensor.outdoor_temperature": "temperature_C"},
    "influx": {"distance": "reading_m", "temperature": "temperature_C"},
    "mqtt": {"distance": "reading_m", "temperature": "temperature_C"},
}
"""What only their owner knows: these logs have no units."""


def read(way: str, said: Rows, folder: Path) -> dict[str, Any]:
    path = folder / "log.txt"
    path.write_text("\n".join(WAYS[way](said, START)) + "\n")
    return {"source": path, "columns": COLUMNS.get(way)}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("late", "every"), [(-300.0, 600.0), (300.0, 600.0), (590.0, 600.0), (70.0, 1500.0), (20.0, 90.0)]
)
def test_values_at_other_times_are_those_of_the_row(
    way: str, late: float, every: float, random: np.random.Generator, tmp_path: Path
) -> None:
    said, truth = log(random, Air(random, 3.0), late=late, every=every)
    given = read(way, said, tmp_path)
    data = echocal.read_observations(given["source"], given["columns"], reading_speed="343")
    assert len(data) == len(truth)
    found = data.conditions["temperature"]
    known = np.isfinite(found)
    assert known.mean() > 0.99
    at = np.arange(len(truth)) * EVERY
    inside = known & (at > late) & (at < at[-1] - every)
    # a straight line over the interval misses air that wanders so by less than half of what it changes in it
    change = np.sqrt(np.mean(np.diff(truth) ** 2))
    error = (found - truth)[inside]
    assert np.sqrt(np.mean(error**2)) < 0.5 * change * max(every / EVERY, 0.5)
    assert abs(error.mean()) < 0.03
    join = data.joined["temperature"]
    assert join.how == "interpolated"
    assert join.interval_s == pytest.approx(every, rel=0.02)
    assert any("interpolated in time" in note for note in data.notes)


@pytest.mark.statistical
@pytest.mark.parametrize("way", ["home_assistant", "serial"])
@pytest.mark.parametrize(("late", "every"), [(-200.0, 600.0), (200.0, 600.0), (400.0, 1800.0)])
def test_no_clock_is_blamed_for_the_join(
    way: str, late: float, every: float, random: np.random.Generator, tmp_path: Path
) -> None:
    said, _ = log(random, Air(random, 3.0), late=late, every=every)
    given = read(way, said, tmp_path)
    found = echocal.diagnose(
        given["source"], columns=given["columns"], reading_speed="343", constant_distance=True
    )
    named = {cause.id for cause in found.causes if cause.kind == "effect" and cause.in_model}
    assert not named & LATE, found.explain()
    assert any("interpolated in time" in note for note in found.notes)


def test_no_value_is_made_up_in_a_gap(random: np.random.Generator, tmp_path: Path) -> None:
    said, truth = log(random, Air(random, 3.0), late=120.0, every=600.0, gap=True)
    given = read("home_assistant", said, tmp_path)
    with pytest.warns(echocal.DataWarning, match="missing"):
        data = echocal.read_observations(given["source"], given["columns"], reading_speed="343")
    found = data.conditions["temperature"]
    without = np.isnan(found)
    assert GAP / EVERY - 2 <= without.sum() <= GAP / EVERY + 2
    assert np.flatnonzero(without).tolist() == list(range(without.argmax(), without.argmax() + without.sum()))
    assert set(data.unusable[without]) == {"sensor.outdoor_temperature missing"}
    assert data.joined["temperature"].without == without.sum()
    assert np.abs(found - truth)[~without].max() < 1.5


def test_a_record_of_changes_holds_its_value(random: np.random.Generator, tmp_path: Path) -> None:
    """A logger that writes a state when it changes has long intervals at night, and nothing is unknown."""
    at = np.arange(500) * 120.0
    air = 20.0 + 3.0 * np.maximum(np.sin(2 * np.pi * (at - 20000.0) / 60000.0), 0.0)  # still for hours
    air = (air + random.normal(0.0, 1e-3, len(at))).round(1)
    changes = np.flatnonzero(np.append(True, np.diff(air) != 0.0))
    said = [(t, "temperature", v) for t, v in zip(at[changes], air[changes], strict=True)]
    said += [(t + 1.0, "distance", 2.0) for t in at]
    given = read("home_assistant", sorted(said), tmp_path)
    data = echocal.read_observations(given["source"], given["columns"], reading_speed="343")
    inside = at <= at[changes[-1]]
    assert np.diff(at[changes]).max() > 3600.0
    assert np.abs(data.conditions["temperature"] - air)[inside].max() <= 0.11


def test_each_tank_has_its_own_air(random: np.random.Generator, tmp_path: Path) -> None:
    """Two hosts in one long table: the thermometer of one says nothing of the other."""
    lines = ["_time,_field,_value,host"]
    for n in range(60):
        when = pd.Timestamp("2024-05-14") + pd.Timedelta(minutes=10 * n)
        for host, air, distance in (("a", 10.0, 1.0), ("b", 30.0, 2.0)):
            later = when + pd.Timedelta(seconds=int(random.integers(1, 300)))
            lines += [
                f"{when.isoformat()}Z,distance,{distance},{host}",
                f"{later.isoformat()}Z,temperature,{air},{host}",
            ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    columns = {"distance": "reading_m", "temperature": "temperature_C"}
    data = echocal.read_observations(path, columns, reading_speed="343")
    assert set(zip(data.reading.tolist(), data.conditions["temperature"].tolist(), strict=True)) == {
        (1.0, 10.0), (2.0, 30.0),
    }  # fmt: skip


@pytest.mark.statistical
def test_a_lag_beside_a_join_has_the_other_explanation(random: np.random.Generator, tmp_path: Path) -> None:
    """A thermometer that is late is found, and the diagnosis says that its clock may differ."""
    air = Air(random, 3.0)
    said, _ = log(random, air, late=120.0, every=600.0)
    late = [(t, n, v if n == "distance" else float(air(t - 1500.0).round(2))) for t, n, v in said]
    given = read("home_assistant", late, tmp_path)
    found = echocal.diagnose(
        given["source"], columns=given["columns"], reading_speed="343", constant_distance=True
    )
    assert {cause.id for cause in found.causes if cause.in_model} & LATE, found.explain()
    assert any("has other times than the rows" in note and "Two clocks" in note for note in found.notes)
