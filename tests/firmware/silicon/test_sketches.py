"""Sketches on the emulated UNO: what they measure, against figures and formulas; errors name their place."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

from echocal import silicon
from echocal.errors import DataError, UsageError
from echocal.silicon import arduino
from echocal.silicon.arduino import with_prototypes

pytestmark = pytest.mark.skipif(
    bool(silicon.missing_for_sketches()), reason=f"absent: {', '.join(silicon.missing_for_sketches())}"
)

WARNINGS = ("-Wall", "-Wextra", "-Werror")
SETUP = """
void setup() {
  Serial.begin(BAUD);
  pinMode(7, OUTPUT);
  pinMode(8, INPUT);
  HEADER
}
float celsius() { return (analogRead(A0) * 5.0 / 1024 - 0.5) * 100; }
long ping() {
  digitalWrite(7, HIGH);
  delayMicroseconds(10);
  digitalWrite(7, LOW);
  return pulseIn(8, HIGH, 30000UL);
}
"""
LOOPS = {
    "thermometer_last": 'long us = ping(); Serial.print("T"); Serial.println(us); Serial.println(celsius());',
    "thermometer_first": "float t = celsius(); long us = ping(); Serial.println(us); Serial.println(t);",
    "prints_before": "Serial.println(celsius()); long us = ping(); Serial.println(us);",
    "line_around": 'Serial.print(celsius()); long us = ping(); Serial.print(" us "); Serial.println(us);',
    "waits_first": "delay(WAIT); float t = celsius(); Serial.println(ping()); Serial.println(t);",
}
"""Orders in which people write a loop."""


def written(folder: Path, text: str, name: str = "own") -> Path:
    path = folder / f"{name}.ino"
    path.write_text(text, encoding="utf-8")
    return path


def first_numbers(played: silicon.Played) -> np.ndarray:
    return np.array([float(lines[0].split(",")[0]) for lines in played.rows])


# relative bias of the echo time, and scatter about a straight line [us]
MEASURED = {
    "study": ((-0.0060, -0.00568), (1.9, 3.2)),  # pulseIn: -0.584 %, 2.4 to 2.6 us
    "interrupts_held": ((-1e-4, 1e-4), (0.2, 0.5)),  # whole microseconds
    "pulse_in_long": ((-1.5e-4, 1.5e-4), (1.8, 3.0)),  # micros() in steps of 4 us
    "timer_capture": ((-2e-5, 2e-5), (0.1, 0.3)),  # steps of 0.5 us
}


@pytest.mark.parametrize("name", silicon.SKETCHES)
def test_the_bias_of_each_way_to_time_an_echo(name: str, random: np.random.Generator) -> None:
    echo = random.uniform(150e-6, 25e-3, 100)
    played = silicon.play(silicon.compile_sketch(name, options=WARNINGS), echo, voltages=0.713)
    measured, true = first_numbers(played), echo * 1e6
    (low, high), (least, most) = MEASURED[name]
    assert low < (measured - true).sum() / true.sum() < high
    slope, offset = np.polyfit(true, measured, 1)
    assert least < (measured - slope * true - offset).std() < most


def test_echoes_are_not_rounded_to_microseconds() -> None:
    """Half a microsecond more is a tick more."""
    sketch = silicon.compile_sketch("timer_capture")
    lengths = (11_661.0, 11_661.5, 11_662.0)
    ticks = [silicon.play(sketch, np.full(8, length * 1e-6)).rows for length in lengths]
    means = [np.mean([float(lines[0].split(",")[0]) for lines in rows]) for rows in ticks]
    assert np.diff(means) == pytest.approx([0.5, 0.5], abs=0.15)


@pytest.mark.parametrize("options", [("-DLM35",), ("-DPOTENTIOMETER",)])
@pytest.mark.parametrize("name", silicon.SKETCHES)
def test_every_sketch_compiles_without_warnings_for_each_part(name: str, options: tuple[str, ...]) -> None:
    assert silicon.compile_sketch(name, options=(*WARNINGS, *options)).serial > 0


CODES = (
    SETUP
    + "void loop() { ping(); Serial.println(analogRead(A0)); Serial.println(analogRead(A1)); delay(5); }"
)


@pytest.mark.parametrize("reference", ["supply", "internal"])
def test_codes_are_those_of_the_data_sheet(
    reference: str, tmp_path: Path, random: np.random.Generator
) -> None:
    """ATmega328P, 24.7: 1024 Vin / Vref, rounded down, 1023 at most."""
    header = "analogReference(INTERNAL);" if reference == "internal" else ""
    text = CODES.replace("BAUD", "115200").replace("HEADER", header)
    supply = float(random.uniform(2.7, 5.5))
    top = 1.1 if reference == "internal" else supply
    # half a step beside the edges of codes, and out of range
    edges = (random.integers(0, 1024, (30, 2)) + 0.5) / 1024 * top
    volts = np.vstack([edges, [[0.0, top], [1.5 * top, -0.1]]])
    sketch = silicon.compile_sketch(written(tmp_path, text), options=WARNINGS)
    played = silicon.play(sketch, np.full(len(volts), 2e-3), voltages=volts, reference_voltage=supply)
    expected = np.clip(np.floor(volts * 1024 / top), 0, 1023)
    assert [[int(line) for line in lines] for lines in played.rows] == expected.tolist()
    assert played.codes.tolist() == expected.tolist()


@pytest.mark.parametrize("baud", [9_600, 115_200])
@pytest.mark.parametrize("wait", [0, 20])
@pytest.mark.parametrize("order", LOOPS)
def test_lines_and_voltages_belong_to_their_row(order: str, wait: int, baud: int, tmp_path: Path) -> None:
    """In whatever order a loop reads, triggers and prints, and while lines wait in the buffer."""
    tail = f"delay({wait});" if wait and order != "waits_first" else ""
    header = 'Serial.println("an ultrasonic sensor");'
    loop = f"void loop() {{ {LOOPS[order].replace('WAIT', str(wait))} {tail} }}"
    text = (SETUP + loop).replace("BAUD", str(baud)).replace("HEADER", header)
    echo = np.linspace(4e-3, 16e-3, 7)
    echo[3] = np.nan
    warm = np.linspace(0.0, 50.0, 7)
    sketch = silicon.compile_sketch(written(tmp_path, text), options=WARNINGS)
    played = silicon.play(sketch, echo, voltages=0.5 + 0.01 * warm)
    assert played.before == ("an ultrasonic sensor",)
    for lines, length, degrees in zip(played.rows, np.nan_to_num(echo * 1e6), warm, strict=True):
        numbers = [float(word) for word in re.findall(r"-?\d+\.?\d*", " ".join(lines))]
        assert len(numbers) == 2
        measured, told = numbers[::-1] if order in ("prints_before", "line_around") else numbers
        assert measured == pytest.approx(length, rel=0.1), "what is sent meanwhile delays pulseIn()"
        assert told == pytest.approx(degrees, abs=0.5)


def test_a_missed_echo_is_silence_or_the_long_pulse_of_a_module() -> None:
    sketch = silicon.compile_sketch("timer_capture")
    echo = [5e-3, np.nan, 6e-3]
    silent = silicon.play(sketch, echo)
    assert first_numbers(silent) == pytest.approx([5_000.0, 0.0, 6_000.0], abs=1.0)
    timed_out = silicon.play(sketch, echo, time_out=silicon.TIME_OUT)
    assert first_numbers(timed_out) == pytest.approx([5_000.0, 38_000.0, 6_000.0], abs=1.0)
    assert silent.seconds > timed_out.seconds


def test_silence_before_the_echo_is_waited_for() -> None:
    sketch = silicon.compile_sketch("timer_capture")
    short, long = (silicon.play(sketch, np.full(5, 5e-3), silence=s) for s in (300e-6, [10e-3] * 5))
    assert first_numbers(long) == pytest.approx(first_numbers(short), abs=1.0)
    assert long.seconds - short.seconds == pytest.approx(5 * 9.7e-3, abs=2e-3)


def test_functions_may_follow_their_call() -> None:
    text = (
        "// void no() { }\n#define NO() { no(); }\nstruct Echo { int us; };\nvoid setup() { use(read()); }\n"
        "void loop() { }\nEcho read() { return Echo(); }\nstatic void use(Echo echo) { }\n"
        "int none() { return 1; }\n"
    )
    told = with_prototypes(text, "a.ino")
    assert "Echo read();\nstatic void use(Echo echo);\n#line 4" in told
    assert "none();" not in told


EMPTY = "void setup() { }\nvoid loop() { }"
CONSTANTS = "const char room[32000] PROGMEM = {1};\n"
BROKEN = {
    "void setup() { }\nvoid loop() {\n  plusIn(8, HIGH);\n}": r"own\.ino:3: .plusIn. was not declared",
    f"#include <NewPing.h>\n{EMPTY}": r"own\.ino:1: NewPing\.h: No such file",
    "int late();\nvoid setup() {\n  pinMode(late(), OUTPUT);\n}\nvoid loop() { }": (
        r"own\.ino:3: undefined reference to .late"
    ),
    "void setup() { }\nvoid loop() {\n  int degrees(void);\n}": (r"Arduino\.h:\d+: .* \(from .*own\.ino:3\)"),
    "char room[3000];\nvoid setup() { }\nvoid loop() { room[millis()] = 1; }": "more than the 2048 bytes",
    f"{CONSTANTS}void setup() {{ }}\nvoid loop() {{ pinMode(pgm_read_byte(room + millis()), 1); }}": (
        r"needs 32\d\d\d bytes of flash; an UNO has 32256"
    ),
}


@pytest.mark.parametrize("text", BROKEN)
def test_what_does_not_compile_is_told_with_its_line(text: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=BROKEN[text]):
        silicon.compile_sketch(written(tmp_path, text))


PULSE = "digitalWrite(PIN, HIGH); delayMicroseconds(10); digitalWrite(PIN, LOW); delay(20);"
SHORT = PULSE.replace("10", "2")
SILENT = {
    "void setup() { }\nvoid loop() { }": r"does not trigger pin 7 within 1 s on the board$",
    f"void setup() {{ pinMode(9, OUTPUT); }}\nvoid loop() {{ {PULSE.replace('PIN', '9')} }}": (
        r"does not trigger pin 7 .*; pin 9 has \d+ pulses of up to 1\d\.\d us: is it the trigger pin\?"
    ),
    f"void setup() {{ pinMode(7, OUTPUT); }}\nvoid loop() {{ {SHORT.replace('PIN', '7')} }}": (
        r"its \d+ pulses there last \d\.\d us at most, and an HC-SR04 needs 10 us"
    ),
    f"void setup() {{ pinMode(7, OUTPUT); }}\nvoid loop() {{ {PULSE.replace('PIN', '7')} }}": (
        "prints nothing in .* s on the board"
    ),
    f"void setup() {{ pinMode(7, OUTPUT); {PULSE.replace('PIN', '7')} }}\nvoid loop() {{ }}": (
        "triggered 1 of 3 times, and then not for 1 s on the board"
    ),
    "#include <avr/sleep.h>\nvoid setup() { cli(); sleep_enable(); sleep_cpu(); }\nvoid loop() { }": (
        "the chip stopped after .* s"
    ),
}


@pytest.mark.parametrize("text", SILENT)
def test_a_sketch_that_says_nothing_is_told_what_it_lacks(text: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=SILENT[text]):
        silicon.play(silicon.compile_sketch(written(tmp_path, text)), np.full(5, 5e-3), patience=1.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"echo": [5e-3, 0.0]}, "echo 2 is 0 s; expected is 1e-06 to 10 s"),
        ({"echo": 5e-3}, r"echo has shape \(\)"),
        ({"voltages": [1.0] * 3}, "must agree in the number of rows"),
        ({"voltages": np.ones((2, 3))}, "there are two analog pins"),
        ({"voltages": np.nan}, "must be finite"),
        ({"silence": -1.0}, "silence must not be negative"),
        ({"reference_voltage": 12.0}, "reference_voltage is 12 V"),
        ({"trigger_pin": 1}, "trigger_pin is 1"),
        ({"echo_pin": 7}, "trigger_pin and echo_pin are both 7"),
    ],
)
def test_impossible_requests(arguments: dict[str, object], message: str) -> None:
    request = {"echo": [5e-3, 6e-3], **arguments}
    with pytest.raises(UsageError, match=message):
        silicon.play(arduino.Sketch("none", b"", 0), **request)


def test_what_is_not_installed_is_told_with_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(arduino, "HARDWARE", tmp_path)
    monkeypatch.setattr(arduino, "HEADERS", tmp_path / "sim_avr.h")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UsageError) as told:
        silicon.compile_sketch("study")
    assert str(told.value).endswith(
        "apt install gcc-avr avr-libc gcc libc6-dev libsimavr-dev arduino-core-avr"
    )


def test_what_is_compiled_once_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ECHOCAL_CACHE", str(tmp_path / "kept"))
    arduino._core.cache_clear()
    core = arduino._core()
    arduino._core.cache_clear()
    written_at = core.stat().st_mtime_ns
    assert arduino._core() == core
    assert core.stat().st_mtime_ns == written_at
    assert core.is_relative_to(tmp_path / "kept")
    assert [path.name for path in (tmp_path / "kept").iterdir()] == [core.parent.name], "nothing unfinished"
    arduino._core.cache_clear()


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is read-only for root")
def test_a_home_that_cannot_be_written_to_is_no_obstacle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o500)
    monkeypatch.setenv("ECHOCAL_CACHE", str(tmp_path / "kept"))
    assert arduino.simulated_uno().exists()
