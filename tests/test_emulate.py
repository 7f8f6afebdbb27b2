"""``echocal emulate``: from ranges or a table to what a board logs, and on to a diagnosis."""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal import emulation, firmware, silicon
from echocal.emulation import TRUTH
from echocal.errors import UsageError
from echocal.virtual_bench.echo_time import echo_time
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


def test_the_studys_sweep_is_a_table_that_a_diagnosis_reads(run: Run, tmp_path: Path) -> None:
    asked = "--sketch study --temperature 0:50:2 --distance 0.5,2 -o out.csv --json out.json"
    words = ("emulate", *asked.split())
    begun = os.times()
    code, told = run(*words)
    assert code == 0, told
    spent = sum(os.times()[:4]) - sum(begun[:4])
    assert spent < 10.0, "seconds of processor for 52 rows, and for the core where it is not compiled yet"
    table = pd.read_csv(tmp_path / "out.csv")
    assert list(table) == ["echo_us", "reading_m", "temperature_C", "distance_m", TRUTH]
    assert table[TRUTH].tolist() == np.repeat(np.arange(0.0, 51.0, 2.0), 2).tolist()
    error = table["reading_m"] / table["distance_m"] - 1
    # as the study: about +3.5 % at 0 degC and -5 % at 50 degC, and pulseIn() takes 0.58 % away
    assert error.iloc[1] == pytest.approx(0.029, abs=0.002)
    assert error.iloc[-1] == pytest.approx(-0.054, abs=0.002)
    told_figures = json.loads((tmp_path / "out.json").read_text())
    assert told_figures["schema"] == "echocal.emulation/1"
    assert -0.0065 < told_figures["echo_bias"] < -0.0053
    found = echocal.diagnose(tmp_path / "out.csv", columns={TRUTH: "ignore"})
    named = {cause.id for cause in found.causes}
    assert found.verdict in ("named", "ambiguous")
    # what pulseIn() loses is a scale of the distance for a diagnosis, and the engine lists these together
    assert named & {"interrupt_loss", "clock_error", "reference_scale", "speed_intercept"}
    assert run(*words)[0] == 0, "its own file may be replaced"
    (tmp_path / "out.csv").write_text("mine\n")
    assert run(*words)[0] == 2


def test_the_c_of_a_model_gives_the_twins_distance_for_rows_of_a_table(run: Run, tmp_path: Path) -> None:
    echocal.Model("cramer", air={"relative_humidity": 0.5}).save(tmp_path / "model.json")
    rows = pd.DataFrame({"temperature_C": [1.0, 12.0, 21.3, 48.0], "distance_m": [0.3, 1.0, 2.0, 3.5]})
    rows["humidity_percent"], rows["time"] = 50.0, pd.date_range("2024-01-01", periods=4, freq="h", tz="UTC")
    rows.to_csv(tmp_path / "rows.csv", index=False)
    words = "emulate --model model.json rows.csv --part tmp36 --reference-voltage 5 --adc-bits 10 -o out.csv"
    code, told = run(*words.split())
    assert code == 0, told
    table = pd.read_csv(tmp_path / "out.csv")
    assert list(table) == [
        "echo_us",
        "reading_m",
        "temperature_C",
        "distance_m",
        TRUTH,
        "humidity_percent",
        "time",
    ]
    made = emulation.package_of(echocal.Model.load(tmp_path / "model.json"), "TMP36", humidity=False)
    codes = np.round(table["temperature_C"] / 0.0625).astype(int)
    twin = made.distance_um(table["echo_us"].astype(int), codes)
    assert (table["reading_m"] * 1e6).round().astype(int).tolist() == twin.tolist()
    assert (table["temperature_C"] - table[TRUTH]).between(-0.33, 0.33).all(), "half a step of 10 bits"
    assert (table["reading_m"] - table["distance_m"]).abs().max() < 4e-3


def test_the_c_of_a_model_reads_a_hygrometer() -> None:
    model = echocal.Model("virial")
    made = firmware.generate(
        model,
        "avr",
        temperature=(0.5, 0.0, 40.0),
        humidity=(0.1, 0.0, 1.0),
        package="arduino",
        max_error=1e-3,
        max_distance=2.0,
    )
    found = echocal.emulate(made, temperature=[10.0, 30.0], relative_humidity=0.6, distance=1.0)
    assert found.firmware is made
    assert found.table["humidity_percent"].between(50.0, 70.0).all()
    assert found.table["true_humidity"].tolist() == [60.0, 60.0]
    assert np.abs(found.errors()["reading_m"]).max() < 3e-3


def test_the_error_is_split_into_its_origins(random: np.random.Generator) -> None:
    """What the model corrects of a thermometer and of a module is in no part."""
    warm, far = random.uniform(5.0, 45.0, 20), random.uniform(0.3, 2.0, 20)
    late = echo_time(far, warm) * 1e6 + 30.0
    rows = {"temperature_C": warm, "distance_m": far, "echo_us": late}
    part = replace(TMP36.ideal(), offset=2.0)
    known = {"temperature_offset": {"offset": -2.0}, "fixed_delay": {"delay": 30e-6}}
    found = echocal.emulate(echocal.Model("cramer", known), rows, part=part)
    parts = echocal.error_parts(found, echocal.Model("cramer", known)) * 1e3
    assert list(parts) == list(emulation.PARTS_OF_ERROR)
    assert parts.sum(axis="columns").to_numpy() == pytest.approx(found.errors()["reading_m"] * 1e3)
    assert parts["transducer"].abs().max() < 0.01
    assert parts["timer"].abs().max() < 0.3, "steps of 1 us, rounded up at half a step of 0.5 us"
    assert parts["arithmetic"].abs().max() < 0.5, "the bound that is proven"
    # two laws of dry air, and 40 kHz in one of them: 0.32 mm of 1 m at 5 degC, 0.73 mm at 45 degC
    assert (parts["air"] / far).abs().max() < 0.75
    # the middle of a step of 10 bits stands for it: nothing is left on average; cut off, -0.5 mm of 1 m
    assert (parts["sensors"] / far).mean() == pytest.approx(0.0, abs=0.25)
    with pytest.raises(UsageError, match="where the true distances are known"):
        echocal.error_parts(echocal.emulate("study", temperature=20.0), echocal.Model("cramer"))
    with pytest.raises(UsageError, match="the C on the board was made from"):
        echocal.error_parts(found, echocal.Model("linear", known))
    with pytest.raises(UsageError, match="model is of the type str; give the Model"):
        echocal.error_parts(found, "cramer")  # type: ignore[arg-type]


def test_an_own_sketch_is_read_as_a_log(run: Run, tmp_path: Path) -> None:
    (tmp_path / "own.ino").write_text(OWN, encoding="utf-8")
    (tmp_path / "rows.csv").write_text("temperature_C,distance_m\n0,1\n20,2\n50,2\n20,20\n", encoding="utf-8")
    pins = "--trigger-pin 9 --echo-pin 10"
    code, told = run(*f"emulate rows.csv --sketch own.ino {pins} -o out.csv".split())
    assert code == 0, told
    table = pd.read_csv(tmp_path / "out.csv")
    true = echo_time(table["distance_m"], table[TRUTH]) * 1e6 / 5800
    short = 1 - table["reading_m"][:3] / true[:3]
    assert short.between(0.010, 0.018).all(), "the sketch still sends the temperature while pulseIn() counts"
    assert np.isnan(table["reading_m"][3]), "116 ms are longer than the sketch waits"
    assert table["temperature_C"].to_numpy() == pytest.approx(table[TRUTH].to_numpy(), abs=0.6)


def test_missed_echoes_and_a_wrong_reference_are_seen_as_on_a_board() -> None:
    table = {"temperature_C": [20.0, 20.0], "echo_us": [11_650.4, np.nan]}
    found = echocal.emulate("timer_capture", table, reference_voltage=4.75)
    assert found.table["echo_us"].to_numpy() == pytest.approx([11_650.4, 0.0], abs=0.6)
    # the sketch supposes 5 V: 0.7 V seem to be 0.737 V
    assert found.table["temperature_C"][0] == pytest.approx(23.7, abs=0.5)
    assert "distance_m" not in found.table
    timed_out = echocal.emulate("timer_capture", table, time_out=38e-3)
    assert timed_out.table["echo_us"][1] == pytest.approx(38_000.0, abs=1.0)


@pytest.mark.parametrize("part", ["lm35", "potentiometer"])
def test_other_parts_are_read_by_their_own_formula(part: str) -> None:
    found = echocal.emulate("study", temperature=[5.0, 25.0, 45.0], part=part)
    assert np.abs(found.errors()["temperature_C"]).max() < 0.5


def test_a_seed_draws_one_real_part_and_its_lag() -> None:
    table = {"temperature_C": [10.0, 30.0, 30.0], "distance_m": 3 * [1.0], "time_s": [0.0, 1.0, 61.0]}
    same = [echocal.emulate("study", table, seed=5).table for _ in range(2)]
    assert same[0].equals(same[1])
    lag = same[0]["temperature_C"]
    drawn = TMP36.drawn(np.random.default_rng(5))
    assert lag[0] == pytest.approx(10.0 + drawn.offset, abs=1.0)
    assert lag[1] - lag[0] < 2.0
    assert lag[2] - lag[0] == pytest.approx(20.0 * (1 - np.exp(-1.0)), abs=1.5)


def test_nothing_of_the_laws_is_in_the_bench() -> None:
    """The thermometers and the air of the bench are a world of their own."""
    import subprocess

    script = (
        "import sys, echocal.virtual_bench.instruments, echocal.virtual_bench.instruments\n"
        "import echocal.virtual_bench.echo_time\n"
        "print([m for m in sys.modules if m.startswith('echocal.') and 'virtual_bench' not in m])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    allowed = {"echocal._accessors", "echocal._core", "echocal._interrupt"}
    allowed |= {"echocal.errors", "echocal.keywords", "echocal.shown"}
    assert set(eval(done.stdout)) <= allowed, "the package itself imports its core"
