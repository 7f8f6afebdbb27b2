"""Emulated firmware: mistakes of a request, a sketch or a machine are one clear line."""

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import echocal
from echocal import firmware, silicon
from echocal.errors import DataError, UsageError
from echocal.virtual_bench.instruments import TMP36

pytestmark = pytest.mark.skipif(
    bool(silicon.missing_for_sketches()), reason=f"absent: {', '.join(silicon.missing_for_sketches())}"
)

Run = Callable[..., tuple[int, str]]
OWN = """
void setup() { Serial.begin(9600); pinMode(9, OUTPUT); pinMode(10, INPUT); }
void loop() {
  float celsius = (analogRead(A0) * 5.0 / 1024 - 0.5) * 100;
  Serial.print("Temperature: "); Serial.print(celsius); Serial.println(" C");
  digitalWrite(9, HIGH); delayMicroseconds(10); digitalWrite(9, LOW);
  long us = pulseIn(10, HIGH, 30000UL);
  if (us == 0) Serial.println("no echo");
  else { Serial.print("Distance: "); Serial.print(us / 58.0); Serial.println(" cm"); }
  delay(60);
}
"""


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ("", 2, "a temperature is needed, such as --temperature 20, or a table of rows"),
        ("--temperature 20 --sketch none.ino", 2, "no sketch 'none.ino': it is neither a file nor one of"),
        ("--temperature 20 --adc-bits 12", 2, "the converter of an ATmega328P has 10 bits, not 12"),
        ("--temperature 20 --part dht22", 2, "part 'dht22' has no voltage, and its bus is not emulated"),
        ("--temperature 20 --part pt100", 2, "part 'pt100' is unknown; there are tmp36, lm35, potentiometer"),
        ("--temperature x", 2, "temperature: 'x' is no range"),
        ("--temperature 20 --column A=reading_m", 2, "no column 'A': the table has none"),
        ("--temperature 20 --model m.json --sketch study", 2, "give --sketch or --model, not both"),
        ("--temperature 20 --model m.json --part lm35", 2, "the sketch of a model reads a TMP36, not a LM35"),
        ("--temperature 20 -o out.parquet", 2, "the table is written as .csv"),
        ("rows.csv --temperature 20", 2, "give it, or ranges of values, not both"),
        ("--temperature 1000", 2, "temperature is 1000 degC in reading 1; it must be from -100 to 100 degC"),
        ("--temperature 20 --relative-humidity 50", 2, "it is a fraction; write 0.5 for 50 %"),
        (
            "--temperature 20 --pressure 1013",
            2,
            "pressure is 1013 Pa in reading 1; it must be from 10000 to 1e+06 Pa",
        ),
        ("--temperature 90 --relative-humidity 1", 2, "vapor over pressure is 0.69"),
        ("--temperature 20 --distance 0", 2, "the distance of row 1 is not above 0 m"),
        ("--temperature 20 --distance 1e-9", 2, "expected is 1e-06 to 10 s, or NaN for a missed echo"),
        ("--temperature 20 --seed -1", 2, "seed is -1; give a whole number of 0 or more"),
        ("--temperature 20 --time-out-ms -5", 2, "time_out is -0.005 s; expected is 1e-06 to 10 s"),
        ("--temperature 20 --time-out-ms nan", 2, "time_out is nan s"),
        ("--temperature 20 --reference-voltage nan", 2, "reference_voltage is nan V; an ATmega328P takes"),
        ("--temperature 20 --echo-pin 13", 2, "the sketches of this package have TRIG at 7 and ECHO at 8"),
        ("--temperature 20 --library none", 2, "library none is no folder"),
        ("--temperature 20 --sketch=", 2, "no sketch ''"),
        ("--temperature 20 --waveform a.gif", 2, "a.gif has the ending '.gif'; a plot is .png, .svg or .pdf"),
        ("--temperature 20 --waveform a", 2, "a has no ending; a plot is .png, .svg or .pdf"),
        ("wet.csv", 3, "relative_humidity is 1.5 in reading 2; it must be from 0 to 1"),
        ("frozen.csv", 3, "temperature is -300 degC in reading 1"),
        ("behind.csv", 3, "the distance of row 2 is not above 0 m"),
        ("untimed.csv --seed 1", 2, "time has no value in row 2"),
        (
            "bare.csv",
            3,
            "the table has neither echo times (echo_us) nor distances of the target (distance_m)",
        ),
        ("cold.csv", 3, "the table has no temperature of the air"),
        ("gaps.csv", 3, "temperature has no value in 1 rows, the first is row 2"),
    ],
)
def test_mistakes_are_one_clear_line(words: str, code: int, message: str, run: Run, tmp_path: Path) -> None:
    echocal.Model("cramer").save(tmp_path / "m.json")
    for name, text in {
        "rows": "temperature_C,distance_m\n20,2\n",
        "bare": "temperature_C\n20\n",
        "cold": "echo_us\n12000\n",
        "gaps": "temperature_C,distance_m\n20,2\n,2\n",
        "wet": "temperature_C,echo_us,humidity_percent\n20,9000,50\n20,9000,150\n",
        "frozen": "temperature_C,distance_m\n-300,2\n20,2\n",
        "behind": "temperature_C,distance_m\n20,2\n20,-1\n",
        "untimed": "temperature_C,distance_m,time_s\n20,2,0\n30,2,\n40,2,60\n",
    }.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    found, told = run("emulate", *words.split())
    assert found == code
    assert message in told
    assert len(told.strip().splitlines()) == 1


def test_a_sketch_that_does_not_compile_is_one_line(run: Run, tmp_path: Path) -> None:
    (tmp_path / "own.ino").write_text(OWN.replace("long us", "lnog us"), encoding="utf-8")
    code, told = run(*["emulate", "--temperature", "20", "--sketch", "own.ino"])
    assert code == 3
    assert "own.ino:7" in told
    assert "lnog" in told
    assert len(told.strip().splitlines()) == 1


def test_tools_that_are_missing_are_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(silicon.arduino, "missing_for_sketches", lambda: ["libsimavr-dev"])
    code, told = run(*["emulate", "--temperature", "20"])
    assert code == 2
    assert "apt install" in told
    assert "libsimavr-dev" in told
    assert len(told.strip().splitlines()) == 1


def test_a_simulator_that_cannot_be_built_or_started_is_one_line(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The headers are there and the library is not; or what was compiled once does not start any more."""
    monkeypatch.setenv("ECHOCAL_CACHE", str(tmp_path))
    words = ["emulate", "--temperature", "20"]
    built = run(*words)
    assert built[0] == 0
    program = next(tmp_path.glob("uno-*/uno"))
    whole = program.read_bytes()
    for damage, said in (
        (
            lambda: program.write_bytes(whole.replace(b"libsimavr.so", b"libabsent.so")),
            "apt install libsimavr",
        ),
        (lambda: program.write_bytes(b""), "remove this folder and run again, or set ECHOCAL_CACHE"),
        (program.unlink, "remove this folder and run again, or set ECHOCAL_CACHE"),
    ):
        damage()
        code, told = run(*words)
        assert code == 2, told
        assert said in told
        assert len(told.strip().splitlines()) == 1, told
    shutil.rmtree(program.parent)
    fails = (1, "", "ld: cannot find -lsimavr\ncollect2: error")
    real = silicon.arduino.attempt
    monkeypatch.setattr(silicon.arduino, "attempt", lambda *told: fails if told[0] == "gcc" else real(*told))
    code, told = run(*words)
    assert code == 2
    assert "cannot build the simulated UNO: ld: cannot find -lsimavr; to install what it needs: apt" in told
    assert len(told.strip().splitlines()) == 1
    assert not list(tmp_path.glob("*unfinished*"))


@pytest.mark.parametrize(
    ("prints", "message"),
    [
        ('Serial.print(us); Serial.print(",");', "prints no line for any of 2 echoes"),
        ('Serial.println("hello");', "not understood, as 'hello': its output has a header (hello)"),
        ("for (int i = 0; i < 500; i++) Serial.print('a'); Serial.println();", f"as '{80 * 'a'}...'"),
    ],
)
def test_lines_that_tell_nothing_are_one_short_line(prints: str, message: str, tmp_path: Path) -> None:
    text = "void setup() { Serial.begin(9600); pinMode(9, OUTPUT); pinMode(10, INPUT); }\nvoid loop() {"
    text += "digitalWrite(9, HIGH); delayMicroseconds(10); digitalWrite(9, LOW); long us = pulseIn(10, HIGH);"
    (tmp_path / "own.ino").write_text(f"{text} {prints} delay(60); }}\n", encoding="utf-8")
    with pytest.raises(DataError) as raised:
        echocal.emulate(tmp_path / "own.ino", temperature=[20.0, 21.0], trigger_pin=9, echo_pin=10)
    told = str(raised.value)
    assert message in told
    assert str(Path(tempfile.gettempdir())) not in told.replace(str(tmp_path), "")
    assert len(told) < 600


def test_a_sketch_that_is_silent_at_its_first_echo_keeps_its_header(tmp_path: Path) -> None:
    text = """
void setup() {
  Serial.begin(9600); pinMode(9, OUTPUT); pinMode(10, INPUT);
  Serial.println("echo_us,reading_cm");
}
void loop() {
  digitalWrite(9, HIGH); delayMicroseconds(10); digitalWrite(9, LOW);
  long us = pulseIn(10, HIGH, 30000UL);
  if (us > 0) { Serial.print(us); Serial.print(","); Serial.println(us / 58.0); }
  delay(60);
}
"""
    (tmp_path / "own.ino").write_text(text, encoding="utf-8")
    rows = {"temperature_C": [20.0] * 4, "echo_us": [np.nan, 5800.0, 8700.0, 11600.0]}
    found = echocal.emulate(tmp_path / "own.ino", rows, trigger_pin=9, echo_pin=10)
    assert found.table["reading_m"].to_numpy() == pytest.approx(
        [np.nan, 1.0, 1.5, 2.0], rel=0.01, nan_ok=True
    )


@pytest.mark.parametrize("last", ["", "float celsius = (analogRead(A0) * 5.0 / 1024 - 0.5) * 100;"])
def test_a_sketch_that_waits_before_it_prints_tells_of_its_own_echo(last: str, tmp_path: Path) -> None:
    text = "void setup() { Serial.begin(9600); pinMode(9, OUTPUT); pinMode(10, INPUT); }\nvoid loop() {"
    text += "digitalWrite(9, HIGH); delayMicroseconds(10); digitalWrite(9, LOW); long us = pulseIn(10, HIGH);"
    text += f'delay(60); {last} Serial.print("Distance: "); Serial.print(us / 58.0); Serial.print(" cm");'
    text += 'Serial.print(", Temperature: "); Serial.print(celsius); Serial.print(" C");' if last else ""
    (tmp_path / "own.ino").write_text(f"{text} Serial.println(); }}\n", encoding="utf-8")
    rows = {"temperature_C": [0.0, 10.0, 20.0, 30.0], "distance_m": [0.5, 1.0, 1.5, 2.0]}
    found = echocal.emulate(tmp_path / "own.ino", rows, trigger_pin=9, echo_pin=10).table
    assert found["reading_m"].to_numpy() == pytest.approx(rows["distance_m"], rel=0.05)
    if last:
        assert found["temperature_C"].to_numpy() == pytest.approx(rows["temperature_C"], abs=0.6)


def test_a_sketch_that_prints_at_every_third_echo_is_told_so(tmp_path: Path) -> None:
    text = OWN.replace("void loop", "int n;\nvoid loop").replace(
        "Serial.print(", "if (n % 3 == 0) Serial.print("
    )
    text = text.replace("Serial.println(", "if (n % 3 == 0) Serial.println(").replace(
        "delay(60)", "n++; delay(60)"
    )
    (tmp_path / "own.ino").write_text(text.replace("Distance", "Quux"), encoding="utf-8")
    with pytest.raises(DataError, match=r"4 of 6 echoes have no line: print one for each"):
        echocal.emulate(tmp_path / "own.ino", temperature=(20.0, 25.0, 1.0), trigger_pin=9, echo_pin=10)


def test_a_sketch_with_a_byte_order_mark_and_returns_compiles(tmp_path: Path) -> None:
    text = "\ufeff" + OWN.replace("\n", "\r\n")
    (tmp_path / "own.ino").write_bytes(text.encode("utf-8"))
    found = echocal.emulate(tmp_path / "own.ino", temperature=20.0, trigger_pin=9, echo_pin=10)
    assert found.table["reading_m"].to_numpy() == pytest.approx([2.0], abs=0.04)


@pytest.mark.parametrize(
    "request_",
    [
        {"sketch": None},
        {"sketch": b"study"},
        {"part": 5},
        {"seed": 1.5},
        {"seed": True},
        {"reference_voltage": "5"},
        {"time_out": "a"},
        {"patience": 0},
        {"patience": np.inf},
        {"libraries": "nowhere"},
    ],
)
def test_what_is_no_argument_is_refused(request_: dict[str, Any]) -> None:
    with pytest.raises(UsageError) as raised:
        echocal.emulate(**{"sketch": "study", "temperature": 20.0, **request_})
    assert "\n" not in str(raised.value)


def test_an_echo_that_is_too_short_to_be_seen_does_not_confuse_the_others() -> None:
    table = {"temperature_C": [20.0, 20.0, 20.0], "echo_us": [1.0, 3.0, 5000.0]}
    found = echocal.emulate("timer_capture", table)
    assert found.table["echo_us"].iloc[-1] == pytest.approx(5000.0, abs=1.0)
    assert found.table["temperature_C"].to_numpy() == pytest.approx([19.82] * 3, abs=0.01)


def test_lines_that_nobody_understands_are_shown(tmp_path: Path) -> None:
    (tmp_path / "own.ino").write_text(OWN.replace("Distance", "Quux").replace(" cm", ""), encoding="utf-8")
    request = {"temperature": [20.0, 21.0], "trigger_pin": 9, "echo_pin": 10}
    with pytest.raises(DataError, match=r"not understood, as 'Temperature: 19\.\d+ C, Quux: 19\d\.\d+'"):
        echocal.emulate(tmp_path / "own.ino", **request)
    told = echocal.emulate(tmp_path / "own.ino", columns={"Quux": "reading_cm"}, **request)
    assert told.table["reading_m"].to_numpy() == pytest.approx([2.0, 2.0], abs=0.04)


def test_only_a_library_for_arduino_runs_there() -> None:
    made = firmware.generate(echocal.Model("cramer"), "avr", temperature=(0.5, 0.0, 40.0))
    with pytest.raises(UsageError, match=r"generate\(\.\.\., package='arduino'\)"):
        echocal.emulate(made, temperature=20.0)


def test_a_part_of_ones_own_needs_a_sketch_of_ones_own() -> None:
    with pytest.raises(UsageError, match="read TMP36, LM35, potentiometer, not a NTC"):
        echocal.emulate("study", temperature=20.0, part=replace(TMP36, name="NTC"))


def test_rows_are_counted_while_it_runs() -> None:
    told: list[tuple[int, int]] = []
    echocal.emulate("timer_capture", temperature=(0.0, 9.0, 1.0), progress=lambda *state: told.append(state))
    assert told[-1] == (10, 10)
    assert [done for done, _ in told] == sorted(done for done, _ in told)
