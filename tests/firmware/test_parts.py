"""Codes of real parts, 32-bit timers, thermistors, and what a function may return."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toolchain import build, hash_of_all, run
from typer.testing import CliRunner

from echocal import Model, UsageError, firmware, silicon
from echocal.cli import app
from echocal.codes import value_at
from echocal.firmware import EchoCodes, Firmware, HumidityCodes, TemperatureCodes, ThermistorCodes
from echocal.sensors import SENSORS, sensor_of
from echocal.silicon.board import definitions
from echocal.thermistor import thermistor_of

MODEL = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
TIMER = EchoCodes(1 / 72, None, None, 32)  # 72 MHz
NTC = ThermistorCodes(10e3, beta=3950.0, r25=10e3)
SOME = TemperatureCodes(2.0, -20.0, 60.0)
CASES: dict[str, dict[str, Any]] = {
    "sixteen_bits": {"temperature": SOME, "humidity": HumidityCodes(0.001, 0.3, 0.7), "echo": 2_000},
    "falling": {"temperature": SOME, "humidity": HumidityCodes(-0.002, 0.0, 1.0, 1.2), "echo": 2_000},
    "twenty_bits": {
        "temperature": replace(SENSORS["AHT20"].temperature, low=10.0, high=20.0, shift=10),
        "humidity": replace(SENSORS["AHT20"].humidity, shift=14),
        "echo": 2_000,
    },
    "timer": {"temperature": TemperatureCodes(20.0, -20.0, 60.0), "echo": TIMER, "max_distance": 1.0},
    "thermistor": {"temperature": NTC, "echo": 5_000, "max_error": 0.4e-3},
    "tenths": {"temperature": SOME, "output_unit": "0.1mm"},
    "tenths_int16": {
        "temperature": SOME,
        "output_unit": "0.1mm",
        "output_type": "int16",
        "max_distance": 2.5,
    },
    "inches": {"temperature": SOME, "output_unit": "0.01in", "max_error": 0.4e-3},
    "q16_16": {"temperature": SOME, "output_unit": "Q16.16"},
    "q3_13": {"temperature": SOME, "output_unit": "Q3.13", "max_distance": 3.0},
}


def made(name: str, target: str = "c99", **more: Any) -> Firmware:
    return firmware.generate(MODEL, target, n_threads=2, **{**CASES[name], **more})


def inputs(found: Firmware, random: np.random.Generator, count: int = 20_000) -> list[np.ndarray]:
    """Accepted codes, the ends among them."""
    device = found.report["device"]
    axes = (device["echo"], *device["conditions"])
    ends = [sorted(axis["codes"].values()) for axis in axes]
    columns = [random.integers(low, high, count, endpoint=True) for low, high in ends]
    for column, (low, high) in zip(columns, ends, strict=True):
        column[:50], column[50:100] = low, high
    return columns


@pytest.mark.parametrize("name", CASES)
def test_outputs_follow_the_model_at_every_part(name: str, random: np.random.Generator) -> None:
    found = made(name)
    device = found.report["device"]
    codes = inputs(found, random)
    assert (found.status(*codes) == 0).all()
    echo, *conditions = codes
    names = [axis["quantity"] for axis in device["conditions"]]
    values = [value_at(axis, code) for axis, code in zip(device["conditions"], conditions, strict=True)]
    with np.errstate(all="ignore"):
        truth = np.asarray(
            MODEL.distance(echo * device["echo"]["lsb"], **dict(zip(names, values, strict=True)))
        )
    error = np.abs(found.outputs(*codes) * device["output"]["lsb"] - truth)
    assert error[truth <= found.report["maximum_distance_m"]].max() <= found.report["error_proven_m"] + 1e-12
    assert found.report["error_proven_m"] <= found.report["error_bound_m"]


@pytest.mark.parametrize("name", CASES)
def test_c_gives_the_outputs_of_the_twin(name: str, tmp_path: Path) -> None:
    found = made(name)
    flags = ("-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all", *definitions(found))
    assert hash_of_all(build(found, tmp_path, "gcc", *flags)) == found.report["output_hash"]
    parts = (tmp_path / "echocal_correction.c", *(tmp_path / "selftest").glob("*.c"))
    strict = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-DECHOCAL_EVERY_INPUT", "-O2")
    run("gcc", *strict, f"-I{tmp_path}", *parts, "-o", tmp_path / "test")
    assert run(tmp_path / "test") == "echocal self-test: passed\n"


@pytest.mark.slow
@pytest.mark.parametrize("core", ["avr", "cortex-m0", "rv32"])
@pytest.mark.parametrize("name", ["twenty_bits", "tenths_int16"])
def test_cores_give_the_bits_of_the_twin(name: str, core: str) -> None:
    few = {"temperature": TemperatureCodes(16.0, -20.0, 60.0)} if name == "tenths_int16" else {"echo": 400}
    found = made(name, core, **few)
    assert silicon.output_hash(found, core) == found.report["output_hash"]
    assert silicon.measure(found, core) is not None


@pytest.mark.parametrize("name", sorted(SENSORS))
def test_published_formulas(name: str) -> None:
    """What the datasheets print: raw codes and their values."""
    raw = {
        "AHT20": (0x80000, 50.0, 0x80000, 0.5),
        "BME280": (
            2_508,
            25.08,
            47_445,
            0.46333,
        ),  # section 4.2.3: 5123 would be 51.23; 47445 / 1024 = 46.333 %
        "DHT11": (24, 24.0, 53, 0.53),
        "DHT22": (351, 35.1, 652, 0.652),  # section 7: 0000 0010 1000 1100 is 65.2 %
        "DS18B20": (0x191, 25.0625, None, None),
        "HTU21D": (0x683A, 24.69, 0x4E85, 0.324),
        "SHT3X": (0x6666, 25.0, 0x8000, 0.5),
        "SHT4X": (0x6666, 25.0, 0x8000, 0.565),
        "SI7021": (0x683A, 24.69, 0x4E85, 0.324),
        "TMP117": (0x0C80, 25.0, None, None),
    }[name]
    sensor = sensor_of(name.lower())
    assert sensor.source
    for codes, code, value in ((sensor.temperature, *raw[:2]), (sensor.humidity, *raw[2:])):
        assert (codes is None) == (code is None)
        if codes is not None:
            assert codes.zero + codes.lsb * code == pytest.approx(value, abs=0.02 if code > 255 else 1e-9)


@pytest.mark.parametrize("name", ["BME280", "HTU21D", "SHT4X", "SI7021"])
def test_the_note_of_a_sensor_tells_that_saturated_air_is_above_the_last_code(name: str) -> None:
    part = sensor_of(name)
    assert part.humidity is not None
    warm = replace(part.temperature, low=20.0, high=21.0)
    found = firmware.generate(MODEL, temperature=warm, humidity=part.humidity, max_error=0.8e-3)
    warm_axis, damp = found.report["device"]["conditions"]
    saturated = round((1.0 - part.humidity.zero) / part.humidity.lsb)
    echo, code = 5_000, warm_axis["codes"]["minimum"]
    assert found.status(echo, code, saturated) == 5
    assert found.status(echo, code, damp["codes"]["maximum"]) == 0
    assert "pass at most the last accepted humidity code" in part.note


def test_dropped_bits_cost_what_the_header_says(random: np.random.Generator) -> None:
    found = made("twenty_bits", max_distance=4.0, echo=None)
    lines = found.report["provenance"]["resolution"]
    assert len(lines) == 2
    header = found.files["echocal_correction.h"]
    for line in lines:
        assert line in header
        stated = float(line.split("up to ")[1].split(" mm")[0]) * 1e-3
        axis = next(one for one in found.report["device"]["conditions"] if line.startswith(one["name"]))
        others = [one for one in found.report["device"]["conditions"] if one is not axis]
        code = np.arange(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1)
        code = random.choice(code, 20_000)
        other = value_at(others[0], random.integers(*sorted(others[0]["codes"].values()), 20_000))
        exact, middle = axis["zero"] + axis["lsb"] * code, value_at(axis, code)
        at = {others[0]["quantity"]: other}
        time = np.asarray(MODEL.time_of_flight(4.0, **at, **{axis["quantity"]: middle}))
        lost = np.abs(np.asarray(MODEL.distance(time, **at, **{axis["quantity"]: exact})) - 4.0).max()
        assert 0.8 * stated < lost <= stated


def test_codes_of_one_step_give_one_output() -> None:
    found = made("twenty_bits")
    first = [axis["codes"]["minimum"] for axis in found.report["device"]["conditions"]]
    step = 1 << found.report["device"]["conditions"][1]["shift"]
    same = found.outputs(1_000, first[0], first[1] + np.arange(step))
    assert len(set(same.tolist())) == 1
    assert found.outputs(1_000, first[0], first[1] + 40 * step) != same[0]


def test_humidity_may_fall_as_codes_rise() -> None:
    rising = firmware.generate(MODEL, temperature=SOME, humidity=HumidityCodes(0.01, 0.0, 1.0), echo=5_000)
    falling = firmware.generate(
        MODEL, temperature=SOME, humidity=HumidityCodes(-0.01, 0.0, 1.0, 1.0), echo=5_000
    )
    code = np.arange(101)
    assert np.abs(rising.outputs(5_000, 30, code) - falling.outputs(5_000, 30, 100 - code)).max() <= 2e3 * 0.5


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (
            {"output_unit": "0.1mm", "output_type": "int16"},
            "and int16_t in steps of 0.1 mm holds -3.2767 .. 3.2767 m",
        ),
        ({"output_unit": "Q4.12", "max_distance": 9.0, "echo": 60_000}, "holds -7.9998 .. 7.9998 m"),
        ({"output_type": "int8"}, "unknown output type 'int8'; this version has int32, int16"),
        ({"output_unit": "Q16.16", "name": "a" * 16}, "at most 15 characters"),
        ({"target": "esp8266"}, "unknown target 'esp8266'; this version has c99, avr"),
        ({"temperature": NTC, "package": "arduino"}, "makes no codes for temperature_code of a thermistor"),
        ({"echo": TIMER, "package": "micropython"}, "makes no codes for a timer of 32 bits"),
        (
            {"humidity": HumidityCodes(1 / 65_535), "package": "arduino"},
            "humidity_code in steps of 0.0000152",
        ),
        (
            {"temperature": TemperatureCodes(1 / 128, -20.0, 60.0, 0.0, 2)},
            "codes below 0 drop no bits: give a shift of 0 instead of 2, a range without codes below 0,",
        ),
        ({"echo": EchoCodes(0.001, None, None, 32)}, "echo times end at 16777.2 us"),
    ],
)
def test_refusals_name_the_way_out(request_: dict[str, Any], message: str) -> None:
    with pytest.warns(Warning, match=message) if "end at" in message else pytest.raises(UsageError) as told:
        firmware.generate(MODEL, **{"temperature": SOME, **request_})
    if "end at" not in message:
        assert message in str(told.value)


def test_the_timer_of_32_bits_reaches_what_16_bits_do_not() -> None:
    assert made("timer").report["device"]["echo"]["type"] == "u32"
    with pytest.warns(Warning, match="a timer of 32 bits"):
        short = made("timer", echo=EchoCodes(1 / 72))
    assert short.report["device"]["echo"]["codes"]["maximum"] == 65_535


@pytest.mark.parametrize("target", ["cortex-m4", "cortex-m7", "esp32", "rp2040", "msp430"])
def test_other_names_of_the_c99_target(target: str) -> None:
    named, c99 = made("tenths", target, measure=True), made("tenths")
    assert named.report["target"] == target
    assert named.report["measured"] == []
    assert named.report["flash_bytes"] is None
    assert named.report["cycles"] is None
    assert named.report["instructions"] is None
    assert named.files["echocal_correction.c"] == c99.files["echocal_correction.c"]


@pytest.mark.parametrize(
    "codes",
    [
        NTC,
        replace(NTC, side="supply", bits=12),
        ThermistorCodes(10e3, coefficients=(1.125e-3, 2.347e-4, 8.566e-8)),
        ThermistorCodes(10e3, table=((-25.0, 129_300.0), (0.0, 32_650.0), (25.0, 10_000.0), (65.0, 2_086.0))),
    ],
)
def test_a_thermistor_is_what_it_is_made_of(codes: ThermistorCodes) -> None:
    first, values = codes.scale()
    rises = codes.side == "supply"
    assert (np.diff(values) > 0).all() if rises else (np.diff(values) < 0).all()
    for place in (0, len(values) // 2, len(values) - 1):
        ratio = (first + place + 0.5) / 2**codes.bits
        resistance = codes.divider * (ratio / (1 - ratio) if not rises else (1 - ratio) / ratio)
        kelvin = values[place] + 273.15
        if codes.beta is not None:
            assert resistance == pytest.approx(10e3 * math.exp(codes.beta * (1 / kelvin - 1 / 298.15)))
        elif codes.coefficients is not None:
            log = math.log(resistance)
            assert 1 / kelvin == pytest.approx(
                sum(c * log**n for c, n in zip(codes.coefficients, (0, 1, 3), strict=True))
            )
        else:
            assert -25.0 <= values[place] <= 65.0
    assert codes.temperature(10e3) == pytest.approx(25.0, abs=0.3)


@pytest.mark.parametrize(
    ("codes", "message"),
    [
        ({"divider": 10e3}, "give one of them"),
        ({"divider": -1.0, "beta": 3950.0, "r25": 1e4}, r"divider is -1.0; give a positive number \[ohm\]"),
        ({"divider": 1e4, "beta": 3950.0}, r"r25 is None; give a positive number \[ohm\]"),
        ({"divider": 1e4, "table": ((0.0, 3e4), (50.0, 4e3))}, "from 0 to 50 degC, and -20 to 60 degC"),
        ({"divider": 1e4, "table": ((0.0, 3e4), (50.0, 4e4))}, "resistances that fall"),
        ({"divider": 1e4, "beta": 3950.0, "r25": 1e4, "side": "left"}, "give ground or supply"),
    ],
)
def test_no_thermistor(codes: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        ThermistorCodes(**codes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("divider=1e4,beta=3950,r25=1e4,side=left", "side is 'left'; give ground or supply"),
        ("divider=1e4,beta=3950", r"r25 is None; give a positive number \[ohm\]"),
        ("beta=3950,r25=1e4", r"divider is None; give a positive number \[ohm\]"),
        ("divider=-1,beta=3950,r25=1e4", r"divider is -1.0; give a positive number"),
        ("divider=10k,beta=3950,r25=1e4", "'10k' in the thermistor's divider is no number"),
        ("divider=1e4,beta=3950,r25=1e4,bits=10.5", r"bits of the converter is 10.5; .* 4 .. 16"),
        ("divider=1e4,a=1e-3,c=1e-7", "has no b: give a, b and c"),
        ("divider=1e4,table=0:3e4/50", "'50' of the thermistor's table is no DEGC:OHM"),
        ("divider=1e4,table=0:3e4/50:4e3", "from 0 to 50 degC, and -20 to 60 degC"),
    ],
)
def test_what_is_wrong_in_the_text_of_a_thermistor_is_named(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        thermistor_of(text, -20.0, 60.0)


@pytest.mark.parametrize(
    "options",
    [
        ["--sensor", "sht31", "--temperature-range=15:25", "--humidity-shift", "11"],
        ["--ntc", "divider=10000,beta=3950,r25=10000", "--output-unit", "0.1mm"],
        ["--ntc", "divider=10000,a=1.125e-3,b=2.347e-4,c=8.566e-8,bits=12,side=supply"],
        ["--ntc", "divider=10000,table=-25:129300/0:32650/25:10000/65:2086"],
        ["--echo-lsb-us", "0.125", "--echo-bits", "32", "--temperature-lsb", "2"],
        [
            "--output-type",
            "int16",
            "--output-unit",
            "0.1mm",
            "--max-distance-m",
            "2",
            "--temperature-lsb",
            "2",
        ],
    ],
)
def test_the_recorded_command_makes_the_same_c(options: list[str], tmp_path: Path) -> None:
    MODEL.save(tmp_path / "m.json")
    first = run_command(tmp_path, "one", *options)
    command = json.loads((first / "report.json").read_text())["provenance"]["command"]
    import shlex

    words = shlex.split(command)[3:]
    place = words.index("--out")
    again = run_command(tmp_path, "two", *words[:place], *words[place + 2 :])
    for file in ("echocal_correction.c", "echocal_correction.h", "report.json"):
        assert (first / file).read_text() == (again / file).read_text()


def run_command(folder: Path, out: str, *options: str) -> Path:
    done = CliRunner().invoke(
        app, ["firmware", str(folder / "m.json"), "-q", "-o", str(folder / out), *options]
    )
    assert done.exit_code == 0, done.output
    return folder / out
