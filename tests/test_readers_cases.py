"""Logs that people posted, and their kinds: read right, or asked; nothing is lost or guessed."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_readers_logs import Run, shell

import echocal
from echocal.observations.inspection import Inspection, inspect_log

__all__ = ["shell"]

CASES = Path(__file__).parent / "cases"


def inspected(path: Path) -> tuple[Inspection, dict[str, str]]:
    found = inspect_log(path)
    return found, {column.name: column.proposal.request for column in found.columns}


def read(path: Path, **options: Any) -> echocal.Observations:
    with warnings.catch_warnings(action="ignore"):
        return echocal.read_observations(path, **options)


def write(folder: Path, lines: list[str]) -> Path:
    path = folder / "log.txt"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_line_of_source_is_no_value() -> None:
    data = read(CASES / "esphome-line-number.txt")
    assert data.echo_time == pytest.approx([11e-6, 10e-6, 10e-6, 11e-6, 10e-6, 10e-6, 34e-6, 12e-6, 10e-6])
    assert data.reading[:2] == pytest.approx([0.001886, 0.001715])
    assert data.conditions["elapsed_time"].tolist() == [0, 7, 14, 21, 28, 35, 102, 109, 116]
    assert data.usable.all()
    assert not data.extra


def test_a_distance_that_timed_out_is_a_row() -> None:
    data = read(CASES / "esphome-got-distance.txt", reading_speed=343)
    assert data.unusable.tolist() == ["", "", "", "no echo", "", "", "", "no echo", "", ""]
    assert data.reading[data.usable] == pytest.approx([0.71, 0.71, 0.711, 0.709, 0.711, 0.717, 0.706, 0.711])
    assert data.conditions["elapsed_time"].tolist() == list(range(10))
    assert any("reading_speed=343" in note for note in data.notes)


def test_a_printed_tuple_has_its_lost_echoes() -> None:
    _, holds = inspected(CASES / "printed-tuple-first-line.txt")
    assert holds == {"column 1": "reading_cm"}
    data = read(CASES / "printed-tuple-first-line.txt", columns=holds, reading_speed=343)
    assert data.unusable.tolist() == ["no echo", "", "", "", "", "no echo", ""]
    assert data.reading[data.usable] == pytest.approx([0.112, 0.113, 0.112, 0.111, 0.113])


def test_units_as_names() -> None:
    found, holds = inspected(CASES / "units-as-names.csv")
    assert holds["ms"] == "echo_ms"
    assert holds["inches"] in {"reading_inch", "distance_inch"}
    assert any("agrees with 'inches'" in note for note in found.notes)


def test_a_battery_is_no_temperature() -> None:
    found, holds = inspected(CASES / "battery-is-temperature.csv")
    assert holds == {"column 1": "time_s", "column 2": "reading_cm", "column 3": "", "column 4": ""}
    assert "a temperature in degC or a voltage in V" in found.columns[2].proposal.reason


COLORS = ("", "\x1b[0;36m", "\x1b[0;35m", "\x1b[1;32m")


def _esphome(
    random: np.random.Generator, newer: bool, verbose: bool
) -> tuple[list[str], np.ndarray, np.ndarray]:
    """A log as `esphome logs` shows it: a tank, a thermometer each tenth time, and further lines."""
    tag = "ultrasonic.sensor" if newer else "sensor.ultrasonic"
    color, end = str(random.choice(COLORS)), "\x1b[0m"
    distance = np.round(random.uniform(0.4, 3.0) + random.normal(0.0, 0.01, 60), 3)
    lost = random.random(60) < 0.15
    begin = random.uniform(0.0, 86000.0)
    lines = ["INFO Reading configuration /config/tank.yaml...", "INFO Starting log output from tank.local"]
    for n in range(60):
        at = (begin + 5.0 * n) % 86400.0
        clock = (
            f"{int(at // 3600):02d}:{int(at // 60 % 60):02d}:{at % 60:06.3f}"
            if newer
            else (f"{int(at // 3600):02d}:{int(at // 60 % 60):02d}:{int(at % 60):02d}")
        )
        line = int(random.integers(20, 99))
        micros = round(distance[n] * 2e6 / 343)
        if verbose:
            lines.append(
                f"{color}[{clock}][V][{tag}:{line:03d}]: "
                f"Echo took {0 if lost[n] else micros}{'us' if newer else 'µs'}{end}"
            )
        said = "Distance measurement timed out!" if lost[n] else f"Got distance: {distance[n]:.3f} m"
        lines.append(f"{color}[{clock}][D][{tag}:{line + 3:03d}]: 'Rain barrel' - {said}{end}")
        state = "nan" if lost[n] else f"{micros * 343e-6 / 2:.5f}"
        lines.append(
            f"{color}[{clock}][D][sensor:{line:03d}]: 'Rain barrel': "
            f"Sending state {state} m with 2 decimals of accuracy{end}"
        )
        if n % 10 == 0:
            lines.append(f"[{clock}][D][dht:048]: Got Temperature=21.{n // 10}°C Humidity=48.0%")
            lines.append(
                f"[{clock}][W][component:237]: Component dht took a long time for an operation (86 ms)."
            )
    return lines, distance, lost


@pytest.mark.parametrize("newer", [True, False])
@pytest.mark.parametrize("verbose", [True, False])
def test_an_esphome_log_of_any_version(
    newer: bool, verbose: bool, random: np.random.Generator, tmp_path: Path
) -> None:
    lines, distance, lost = _esphome(random, newer, verbose)
    path = write(tmp_path, lines)
    data = read(path, reading_speed=343)
    assert len(data) == 60
    assert data.unusable.tolist() == ["no echo" if gone else "" for gone in lost]
    assert np.abs(data.echo_time * 343 / 2 - distance)[~lost].max() < 0.6e-3
    assert np.diff(data.conditions["elapsed_time"]) == pytest.approx(5.0, abs=1.01)
    assert not data.extra


def _plotter(between: str, equals: str) -> Callable[[float, float, int], str]:
    return lambda d, c, n: f"distance{equals}{d:.2f}{between}temp{equals}{c:.1f}{between}in{equals}{n}"


SEPARATED = {
    "tabs": _plotter("\t", ":"),
    "commas": _plotter(",", ":"),
    "blanks": _plotter(" ", ":"),
    "tabs and equals": _plotter("\t", "="),
    "blanks around": _plotter("  ", ": "),
    "units after": lambda d, c, n: f"distance: {d:.2f} cm\ttemp: {c:.1f} C\tin: {n}",
    "units right after": lambda d, c, n: f"distance:{d:.2f}cm,temp:{c:.1f}C,in:{n}",
    "words": lambda d, c, n: f"distance is {d:.2f} cm and temp is {c:.1f} °C and in is {n}",
}


@pytest.mark.parametrize("way", SEPARATED)
def test_no_value_of_a_line_is_lost(way: str, random: np.random.Generator, tmp_path: Path) -> None:
    """Also where a name (in) is that of a unit."""
    distance, air = random.uniform(50, 300, 40).round(2), random.uniform(5, 30, 40).round(1)
    lines = [SEPARATED[way](d, c, n) for n, (d, c) in enumerate(zip(distance, air, strict=True))]
    found, _ = inspected(write(tmp_path, lines))
    assert list(found.table.columns) == ["distance", "temp", "in"]
    np.testing.assert_allclose(found.table["distance"], distance)
    np.testing.assert_allclose(found.table["temp"], air)
    assert found.table["in"].tolist() == list(range(40))


LOST = {
    "CircuitPython, tuples": ("({:.1f},)", "Retrying!"),
    "CircuitPython, numbers": ("{:.2f}", "Retrying!"),
    "MicroPython": ("Distance: {:.2f} cm", "ERROR getting distance: Out of range"),
    "Pycom": ("Distance {:.0f} cm", "Out of range"),
    "RPi.GPIO": ("Measured Distance = {:.1f} cm", "Distance measurement timed out"),
    "gpiozero": (
        "Distance: {:.3f} cm",
        "/usr/lib/gpiozero/input_devices.py:852: DistanceSensorNoEcho: no echo received",
    ),
    "NewPing": ("Ping: {:.0f}cm", "Ping: no ping"),
    "in words": ("Distance = {:.2f} cm", "Distance = Out of range"),
}  # fmt: skip


@pytest.mark.parametrize("library", LOST)
@pytest.mark.parametrize("first", [True, False])
def test_a_lost_echo_is_a_row(library: str, first: bool, random: np.random.Generator, tmp_path: Path) -> None:
    good, silent = LOST[library]
    distance = random.uniform(120, 180, 40).round()
    lost = random.random(40) < 0.2
    lost[[0, 20]] = first, True
    path = write(
        tmp_path, [silent if gone else good.format(d) for gone, d in zip(lost, distance, strict=True)]
    )
    _, holds = inspected(path)
    requests = {name: own for name, own in holds.items() if own}
    assert list(requests.values()) == ["reading_cm"]
    data = read(path, columns=requests, reading_speed=343)
    assert data.usable.tolist() == (~lost).tolist()
    assert data.reading[data.usable] == pytest.approx(distance[~lost] / 100)


ORDERS = (
    ("time", "volts", "cm"),
    ("volts", "cm", "time"),
    ("cm", "volts"),
    ("time", "cm", "volts", "charge"),
    ("charge", "volts", "cm"),
)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("cell", [3.0, 3.3, 4.1, 5.0, 12.6])
def test_volts_are_never_taken(
    order: tuple[str, ...], cell: float, random: np.random.Generator, tmp_path: Path
) -> None:
    """Without a header: the distance is proposed, or asked for; never a battery, as what ever."""
    hours = np.arange(48)
    values = {
        "time": 1.749e9 + 3600 * hours,
        "cm": (190 + 20 * np.sin(hours / 4) + random.normal(0, 0.3, 48)).round(1),
        "volts": (cell * (1 - 0.0005 * hours) + random.normal(0, 0.002 * cell, 48)).round(2),
        "charge": (95 - 0.1 * hours).round(1),
    }
    path = write(tmp_path, [",".join(f"{values[name][n]:.10g}" for name in order) for n in range(48)])
    _, holds = inspected(path)
    for place, name in enumerate(order, 1):
        wanted = {"time": {"time_s"}, "cm": {"reading_cm"}}.get(name, {""})
        assert holds[f"column {place}"] in wanted, holds


NAMED = {"inches": ("in", "inches", "inch"), "cm": ("cm", "centimeters"), "mm": ("mm",), "ft": ("feet", "ft")}
METERS = {"inches": 0.0254, "cm": 0.01, "mm": 0.001, "ft": 0.3048}


@pytest.mark.parametrize("length", NAMED)
@pytest.mark.parametrize(("time", "factor"), [("us", 1e6), ("µs", 1e6), ("ms", 1e3), ("microseconds", 1e6)])
def test_lengths_and_times_that_agree(
    length: str, time: str, factor: float, random: np.random.Generator, tmp_path: Path
) -> None:
    meters = random.uniform(0.2, 3.0, 30)
    name = str(random.choice(NAMED[length]))
    lengths, times = (meters / METERS[length]).round(2), (meters * 2 / 344 * factor).round(2)
    rows = zip(lengths, times, random.uniform(50, 80, 30).round(1), strict=True)
    _, holds = inspected(write(tmp_path, [f"{name},{time},degF", *(f"{a},{b},{c}" for a, b, c in rows)]))
    assert holds[time].startswith("echo_")
    assert holds[name].rpartition("_")[0] in {"reading", "distance"}
    assert holds["degF"] == "temperature_F"


def test_a_level_is_told_with_the_way_out(shell: Run, random: np.random.Generator) -> None:
    height = random.uniform(2.3, 3.2)
    level = (random.uniform(0.5, 0.7) + 0.15 * np.sin(np.arange(120) / 12)).round(3)
    air = 15 + 6 * np.sin(np.arange(120) / 20)
    reading = (height - level) * 343 / (331.4 + 0.6 * air) + random.normal(0, 2e-3, 120)
    rows = [
        f"{600 * n},{r:.4f},{x},{c:.1f}" for n, (r, x, c) in enumerate(zip(reading, level, air, strict=True))
    ]
    Path("log.csv").write_text("\n".join(["time_s,reading_m,level,temperature_C", *rows]) + "\n")
    ask = ("diagnose", "log.csv", "--reading-speed", "343")
    code, _, err = shell(*ask, "--column", "level=distance_m")
    assert (code, err.count("\n")) == (3, 1)
    assert "column 'level' looks like a level" in err
    assert "--mount-height" in err
    assert '--column "level=ignore"' in err
    told = float(err.split("--mount-height ")[1].split(",")[0])
    assert told == pytest.approx(height, abs=0.1)
    rows = [row.split(",") for row in rows]
    better = [f"{t},{r},{height - float(x):.4f},{c}" for t, r, x, c in rows]
    Path("log.csv").write_text("\n".join(["time_s,reading_m,distance_m,temperature_C", *better]) + "\n")
    code, _, err = shell(*ask)
    assert code == 0, err


def test_a_true_reference_is_no_level(random: np.random.Generator) -> None:
    for _ in range(20):
        stations = random.uniform(0.3, 4.0, int(random.integers(1, 6)))
        distance = np.repeat(stations, 12)
        table = {"reading_m": distance * random.uniform(0.95, 1.05) + random.normal(0, 0.01, len(distance))}
        table |= {"distance_m": distance, "temperature_C": np.full(len(distance), 20.0)}
        assert echocal.read_observations(table).usable.all()


@pytest.mark.parametrize(
    ("step", "unit"), [(100_000, "us"), (60_000, "us"), (1_000_000, "us"), (600_000, "ms"), (60_000, "ms")]
)
def test_counts_in_time_s_are_asked_for(
    step: int, unit: str, shell: Run, random: np.random.Generator
) -> None:
    times = np.cumsum(step + random.integers(0, step // 2000, 60))
    rows = [f"{t},{11660 + random.normal(0, 3):.1f},{20 + n / 30:.1f}" for n, t in enumerate(times)]
    Path("log.csv").write_text("\n".join(["time_s,echo_us,temperature_C", *rows]) + "\n")
    ask = ("diagnose", "log.csv", "--constant-distance", "-q")
    code, _, err = shell(*ask)
    assert (code, err.count("\n")) == (3, 1)
    assert f'"time_s=time_{unit}"' in err
    assert '--trust "time_s"' in err
    assert shell(*ask, "--column", f"time_s=time_{unit}")[0] == 0
    assert shell(*ask, "--trust", "time_s")[0] == 0


@pytest.mark.parametrize("step", [0.05, 1.0, 7.3, 600.0, 1800.0, 3600.0, 5400.0, 7203.0, 21600.0, 86400.0])
def test_seconds_are_taken(step: float, random: np.random.Generator) -> None:
    for begin in (0.0, 1.7e9):
        times = begin + np.arange(50) * step
        data = echocal.read_observations({"time_s": times, "echo_us": [11660.0] * 50})
        assert data.conditions["elapsed_time"][-1] == pytest.approx(49 * step, rel=1e-6)
    irregular = np.sort(random.uniform(0, 90 * 86400, 50)).round()
    assert echocal.read_observations({"time_s": irregular, "echo_us": [11660.0] * 50}).usable.all()


@pytest.mark.parametrize(
    "name",
    [
        "temperature_c",
        "TEMPERATURE_C",
        "temperature_degC",
        "Temperature_Celsius",
        "temperature_f",
        "temperature_k",
    ],
)
def test_a_unit_in_any_case(name: str) -> None:
    kind = name.rpartition("_")[2][0].upper() if "deg" not in name else "C"
    value = {"C": 20.0, "F": 68.0, "K": 293.15}[kind]
    data = echocal.read_observations({"echo_us": [11660.0] * 3, name: [value] * 3})
    assert data.conditions["temperature"] == pytest.approx([20.0] * 3)


def test_gaps_count_where_there_is_a_reading(tmp_path: Path, random: np.random.Generator) -> None:
    """A device that reports its state between measurements: no reading, no temperature."""
    lines = ["Time,Distance (cm),Temp (°C),rssi"]
    for n in range(60):
        lines.append(
            f"2024-05-14 {n // 30 + 8:02d}:{2 * (n % 30):02d}:00,"
            f"{random.normal(180, 0.3):.1f},{18 + n / 30:.1f},-70"
        )
        lines.append(f"2024-05-14 {n // 30 + 8:02d}:{2 * (n % 30) + 1:02d}:00,,,-71")
    data = read(write(tmp_path, lines), reading_speed=343)
    assert "temperature" in data.conditions
    assert data.usable.sum() == 60
