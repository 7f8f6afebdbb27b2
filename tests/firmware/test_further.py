"""One further input beside temperature and humidity: the proof against the model, the C against its twin."""

import functools
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boards.arduino import link, serial
from test_misra import findings
from test_selftest import PASSED, build

from echocal import Model, firmware
from echocal.cli import main
from echocal.errors import UsageError
from echocal.firmware import Firmware, FurtherCodes
from echocal.per_unit import generate_per_unit
from echocal.registry import find_effect

DELAY = {"fixed_delay": {"delay": 31e-6}}
WARM, DAMP = (2.0, -20.0, 60.0), (0.125, 0.0, 1.0)
# effect, its parameters, codes of what it reads
INPUTS: dict[str, tuple[dict[str, float], str]] = {
    "supply_voltage": ({"slope": 60e-6}, "supply_voltage=4.5:5.5:0.02"),
    "recorded_amplitude": ({}, "amplitude=0.05:1:0.01"),
    "first_ping": ({"delay": 60e-6}, "position_in_group=0:7:1"),
    "carbon_dioxide": ({}, "co2_mole_fraction=3e-4:2e-3:1e-4"),
    "wind_along": ({}, "wind_speed=0:8:0.25"),
    "wind_across": ({}, "wind_speed=-6:6:0.25"),
    "slant_range": ({}, "angle=0:0.25:0.01"),
    "temperature_lag": ({"time_constant": 300.0}, "temperature_rate=-0.005:0.005:0.0005"),
    "temperature_self_heating": ({"rise": 1.5}, "elapsed_time=0:1800:60"),
    "thermometer_mix": ({}, "second_temperature=-20:60:1"),
}
BESIDE_HUMIDITY = ["supply_voltage", "recorded_amplitude", "first_ping", "carbon_dioxide", "wind_across"]


def model_of(effect: str) -> Model:
    own = {
        one.name: one.neutral + (one.prior_scale if one.role == "size" else 0.0)
        for one in find_effect(effect).parameters
    } | INPUTS[effect][0]
    return Model("linear" if effect == "carbon_dioxide" else "cramer", {effect: own, **DELAY})


@functools.cache
def made(effect: str, humid: bool = False, target: str = "c99", package: str = "c") -> Firmware:
    more: dict[str, Any] = {"humidity": DAMP} if humid else {}
    codes = INPUTS[effect][1]
    request = {"temperature": WARM, "further": codes, "package": package, "max_error": 0.6e-3, **more}
    return firmware.generate(model_of(effect), target, **request)


def drawn(packed: Firmware, random: np.random.Generator, count: int) -> dict[str, np.ndarray]:
    """Codes of every input, some of them not accepted."""
    device = packed.report["device"]
    codes = {}
    for axis in (device["echo"], *device["conditions"]):
        low, high = axis["codes"]["minimum"], axis["codes"]["maximum"]
        least = 0 if axis["type"][0] == "u" else low - 1
        codes[axis["name"]] = random.integers(max(least, low - 1), high + 2, count)
    return codes


def given(packed: Firmware, codes: dict[str, np.ndarray]) -> tuple[list[np.ndarray], dict[str, np.ndarray]]:
    """Arguments of the twin."""
    columns = list(codes.items())
    keys = {"humidity_code": "humidity_code"}
    return [column for _, column in columns[:2]], {
        keys.get(name, "further_code"): column for name, column in columns[2:]
    }


@pytest.mark.parametrize(
    ("effect", "humid"), [(name, False) for name in INPUTS] + [(name, True) for name in BESIDE_HUMIDITY]
)
def test_the_distance_is_the_models_within_the_proven_error(
    effect: str, humid: bool, random: np.random.Generator
) -> None:
    packed = made(effect, humid)
    codes = drawn(packed, random, 20_000)
    first, others = given(packed, codes)
    outputs = packed.outputs(*first, **others)
    device = packed.report["device"]
    axes = [device["echo"], *device["conditions"]]
    inside = np.ones(len(outputs), dtype=bool)
    values = {}
    for axis in axes:
        column = codes[axis["name"]]
        inside &= (column >= axis["codes"]["minimum"]) & (column <= axis["codes"]["maximum"])
        values[axis["quantity"]] = column * axis["lsb"] + axis["zero"]
    assert np.array_equal(outputs != -(2**31), inside)
    words = np.array(packed.report["statuses"])[packed.status(*first, **others)]
    alone = ~inside & np.logical_and.reduce(
        [
            (codes[axis["name"]] >= axis["codes"]["minimum"])
            & (codes[axis["name"]] <= axis["codes"]["maximum"])
            for axis in axes[:-1]
        ]
    )
    assert set(words[alone]) == {"further input out of range"}
    time = values.pop("time_of_flight")
    truth = model_of(effect).distance(time, **values)
    near = inside & (truth <= 4.0)
    error = np.abs(outputs * 1e-6 - truth)[near].max()
    assert 0.3 * packed.report["error_proven_m"] < error <= packed.report["error_proven_m"]


@pytest.mark.parametrize(
    ("effect", "humid"), [("supply_voltage", False), ("wind_across", True), ("slant_range", False)]
)
@pytest.mark.parametrize("target", ["c99", "avr"])
def test_the_c_has_every_bit_of_its_twin(effect: str, humid: bool, target: str, tmp_path: Path) -> None:
    packed = made(effect, humid, target)
    assert run_selftest(packed, tmp_path)
    rows = [line.split(",") for line in packed.files["echocal_golden.csv"].splitlines()]
    names, table = rows[0], np.array(rows[1:], dtype=np.int64)
    columns = dict(zip(names[:-2], table[:, :-2].T, strict=True))
    first, others = given(packed, columns)
    assert np.array_equal(packed.outputs(*first, **others), table[:, -2])
    assert np.array_equal(packed.status(*first, **others), table[:, -1])
    assert 6 in table[:, -1]


def run_selftest(packed: Firmware, folder: Path) -> bool:
    from toolchain import run

    return run(build(packed, folder, "gcc", "-DECHOCAL_EVERY_INPUT")) == PASSED


@pytest.mark.parametrize(
    ("effect", "humid"), [("supply_voltage", True), ("wind_across", True), ("slant_range", False)]
)
def test_the_c_keeps_the_rules(effect: str, humid: bool, tmp_path: Path) -> None:
    packed = made(effect, humid)
    found = {check for _, check in findings(packed, tmp_path, ".c")}
    assert found <= {"2.5", "8.9", "15.5", "21.6"}


def test_files_state_the_input_and_its_share() -> None:
    packed = made("supply_voltage")
    header = packed.files["echocal_correction.h"]
    assert "supply_voltage = supply_voltage_code * 0.02 V; 225 .. 275" in header
    assert "#define ECHOCAL_FURTHER_INPUT_OUT_OF_RANGE (6U)" in header
    assert "#define ECHOCAL_SUPPLY_VOLTAGE_CODE_LAST (275)" in header
    delay = packed.report["form"]["delay"]
    assert delay["condition"] == "supply_voltage"
    assert 0.0 < delay["error_share_m"] < packed.report["error_proven_m"]
    assert "a delay by the supply voltage" in header
    assert "mm of the error at most" in header
    assert not any("supply_voltage" in line for line in packed.report["assumptions"])
    assert "supply_voltage in steps of 0.02 V" in header, "its step is part of the expanded uncertainty"
    usual = firmware.generate(Model("cramer"), temperature=WARM)
    assert "FURTHER" not in usual.files["echocal_correction.h"]
    assert len(usual.report["statuses"]) == 6


def test_a_delay_by_the_temperature_alone() -> None:
    """Of transducers out of tune: one delay for all temperatures left 0.67 mm."""
    model = Model("cramer", {"resonance_drift": {"delay": 40e-6}, **DELAY})
    packed = firmware.generate(model, temperature=(0.5, -20.0, 60.0), max_error=0.3e-3)
    assert packed.report["form"]["delay"]["condition"] == "temperature"
    warm = np.arange(-40, 121)[:, None]
    echo = np.arange(200, 22_000, 37)
    truth = model.distance(echo * 1e-6, temperature=warm * 0.5)
    error = np.abs(packed.outputs(echo, warm) * 1e-6 - truth)[truth <= 4.0].max()
    assert error <= packed.report["error_proven_m"] <= 0.3e-3


def test_the_example_prints_the_twins_distance(tmp_path: Path) -> None:
    """The sketch on a simulated ATmega328P; the code of the further input is the user's, here a count."""
    packed = made("supply_voltage", target="avr", package="arduino")
    sketch = "examples/HcSr04/HcSr04.ino"
    text = packed.files[sketch]
    assert "    return 250;\n" in text
    counted = "    static uint16_t code = 224;\n    return code++;\n"
    packed.files[sketch] = text.replace("    return 250;\n", counted)
    echoes = [11_690, 580, 23_456, 1_500, 11_691]
    lines = serial(link(packed, sketch, tmp_path), (713, 0), echoes)
    packed.files[sketch] = text
    for number, (line, sent) in enumerate(zip(lines, echoes, strict=True)):
        echo, warm, code, told = line.split(maxsplit=3)
        assert (abs(int(echo) - sent) <= 1, int(warm), int(code)) == (True, 11, 224 + number)
        distance = int(packed.outputs(int(echo), int(warm), further_code=int(code)))
        assert told == ("further input out of range" if number == 0 else str(distance))


def test_the_command_of_the_files_makes_them_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model_of("supply_voltage").save(tmp_path / "MODEL.json")
    codes = FurtherCodes("supply_voltage", 0.005, 4.5, 5.5, 0.1, 1)
    packed = firmware.generate(Model.load(tmp_path / "MODEL.json"), temperature=WARM, further=codes)
    command = packed.report["provenance"]["command"]
    assert "--further supply_voltage=4.5:5.5:0.005:0.1:1" in command
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", command.split())
    with pytest.raises(SystemExit) as stopped:
        main()
    assert not stopped.value.code
    assert ", supply voltage " in capsys.readouterr().err
    again = json.loads((tmp_path / "firmware" / "report.json").read_text())
    assert again["output_hash"] == packed.report["output_hash"]
    assert "lowest 1 bits are dropped" in (tmp_path / "firmware" / "echocal_correction.h").read_text()


REFUSALS: list[tuple[dict[str, Any], str]] = [
    ({"further": "supply_voltage=4.5:5.5"}, "give QUANTITY=LOW:HIGH:LSB"),
    ({"further": 5.0}, "give QUANTITY=LOW:HIGH:LSB"),
    ({"further": "voltage=4.5:5.5:0.1"}, "no quantity has this name: give one of .*supply_voltage"),
    (
        {"further": "wind_speed=0:8:0.25"},
        "nothing in the model depends on it: leave it out, or give one of pressure, co2",
    ),
    ({"further": "temperature=0:1:0.1"}, "no further input: give its codes as temperature"),
    ({"further": "supply_voltage=5.5:4.5:0.1"}, "supply voltage 5.5:4.5 V with LSB 0.1 is not a range"),
    ({"assume": {"supply_voltage": 5.0}}, "supply_voltage is measured: it cannot be assumed as well"),
    ({"package": "esphome"}, "package esphome reads temperature and humidity, and supply_voltage_code"),
    ({"package": "micropython"}, "package micropython reads temperature and humidity"),
    ({"further": "supply_voltage=4.5:5.5:0.000001"}, "needs codes 4500000 .. 5500000|combinations"),
]


@pytest.mark.parametrize(("request_", "message"), REFUSALS)
def test_refusals_say_the_way_out(request_: dict[str, Any], message: str) -> None:
    usual = {"temperature": WARM, "further": "supply_voltage=4.5:5.5:0.02"}
    with pytest.raises(UsageError, match=message):
        firmware.generate(model_of("supply_voltage"), **{**usual, **request_})


def test_what_no_delay_and_factor_follow_is_refused_at_once() -> None:
    """A lag changes the temperature: that is no factor of the speed which is the same at all temperatures."""
    model, codes = model_of("temperature_lag"), "temperature_rate=-0.01:0.01:0.0005"
    with pytest.raises(
        UsageError, match=r"for each temperature rate leave up to [0-9.]+ mm .* leave out the humidity"
    ):
        firmware.generate(model, temperature=WARM, humidity=DAMP, further=codes)


def test_an_effect_that_reads_more_says_what() -> None:
    model = Model("cramer", {"temperature_radiation": {"gain": 2e-3}})
    request: dict[str, Any] = {"temperature": WARM, "further": "radiation=0:1000:50"}
    with pytest.raises(UsageError, match=r"also reads radiation_rate.*assume"):
        firmware.generate(model, **request)
    packed = firmware.generate(model, assume={"radiation_rate": 0.0}, **request)
    assert packed.report["error_proven_m"] <= 0.5e-3


def test_unit_data_are_refused() -> None:
    with pytest.raises(UsageError, match="not proven beside a further input"):
        generate_per_unit(
            model_of("supply_voltage"), ["fixed_delay"], temperature=WARM, further=INPUTS["supply_voltage"][1]
        )


def test_codes_that_are_missing_are_named() -> None:
    packed = made("supply_voltage")
    with pytest.raises(UsageError, match="takes a supply_voltage_code"):
        packed.outputs(1000, 10)
    with pytest.raises(UsageError, match="takes no humidity_code"):
        packed.outputs(1000, 10, 5, 250)
