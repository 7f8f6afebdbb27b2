"""The example on cores of 32 bits that QEMU plays, with a stand-in for the boards' own Arduino core."""

from pathlib import Path

import numpy as np
import pytest
from boards.standin import CLOCKS, play
from test_arduino import NO_ECHO, REFUSED
from test_codes import FALLING

from echocal import Model, firmware
from echocal.firmware import EchoCodes, Firmware

SKETCHES = {"arduino": "examples/HcSr04/HcSr04.ino", "platformio": "src/main.cpp"}
MODEL = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
MILLIVOLTS = 713  # of a TMP36, 21.3 degC
ECHOES = [150, 580, 11_690, 23_456, 25_080]
STEP = 1  # us, of micros()
BIAS = 0.1  # degC


def packed(core: str, package: str = "arduino") -> Firmware:
    return firmware.generate(MODEL, core, temperature=(0.0625, -20.0, 60.0), package=package)


@pytest.mark.slow
@pytest.mark.parametrize("core", CLOCKS)
@pytest.mark.parametrize("package", SKETCHES)
def test_the_example_measures(package: str, core: str, tmp_path: Path) -> None:
    made = packed(core, package)
    lines = play(made, SKETCHES[package], core, tmp_path, MILLIVOLTS, ECHOES)
    for line, sent in zip(lines, ECHOES, strict=True):
        echo, warm, distance = map(int, line.split())
        assert abs(echo - sent) <= STEP
        assert abs(warm * 0.0625 - 21.3) <= 0.3, "the converter's supply is 3.3 V"
        assert distance == made.distance_um(echo, warm)


@pytest.mark.slow
@pytest.mark.parametrize("core", CLOCKS)
def test_without_an_echo_there_is_no_distance(core: str, tmp_path: Path) -> None:
    lines = play(packed(core), SKETCHES["arduino"], core, tmp_path, MILLIVOLTS, [*NO_ECHO, 11_690])
    assert [line[-7:] for line in lines[:-1]] == REFUSED
    assert int(lines[-1].split()[-1]) == pytest.approx(2_006_000, abs=3_000), "and the next echo is heard"


@pytest.mark.filterwarnings("ignore::echocal.DomainWarning")  # of time-outs that are accepted
def test_no_accepted_echo_is_too_long_to_wait_for(tmp_path: Path) -> None:
    echo = EchoCodes(4.0, 200_000)
    made = firmware.generate(
        MODEL, "cortex-m3", temperature=(0.5, -20.0, 60.0), echo=echo, max_error=2e-3, package="arduino"
    )
    lines = play(made, SKETCHES["arduino"], "cortex-m3", tmp_path, MILLIVOLTS, [60_500, 200_000, 201_000])
    assert [int(line.split()[0]) for line in lines] == pytest.approx([15_125, 50_000, 50_250], abs=2)
    assert [line.endswith("no echo") for line in lines] == [False, False, True]


@pytest.mark.slow
@pytest.mark.parametrize("core", CLOCKS)
def test_an_echo_is_timed_to_a_microsecond(core: str, tmp_path: Path, random: np.random.Generator) -> None:
    """It was 6 us, two edges of which each was seen a turn of a loop late."""
    echoes = random.integers(120, 25_000, 60).tolist()
    lines = play(packed(core), SKETCHES["arduino"], core, tmp_path, MILLIVOLTS, echoes)
    found = [int(line.split()[0]) for line in lines]
    assert np.abs(np.subtract(found, echoes)).max() <= STEP


@pytest.mark.slow
@pytest.mark.parametrize("core", CLOCKS)
def test_the_temperature_has_no_bias(core: str, tmp_path: Path, random: np.random.Generator) -> None:
    """Whatever the supply: the sketch measures it (STM32, ESP32), or a person writes it down."""
    supply = int(random.integers(3_000, 3_600))
    made = packed(core)
    text = made.files[SKETCHES["arduino"]]
    if core == "cortex-m0":
        assert text.count("REFERENCE = 3300;") == 1
        made.files[SKETCHES["arduino"]] = text.replace("REFERENCE = 3300;", f"REFERENCE = {supply};")
    millivolts = random.integers(310, 1_090, 100).tolist()
    lines = play(made, SKETCHES["arduino"], core, tmp_path, millivolts, [2_000] * 100, supply)
    found = np.array([int(line.split()[1]) for line in lines]) * 0.0625
    errors = found - (np.array(millivolts) - 500) / 10
    assert abs(errors.mean()) <= BIAS
    assert np.abs(errors).max() <= {"cortex-m0": 0.25}.get(core, 0.15), (
        "a step of the converter, and of the code"
    )


def test_ticks_of_another_unit_and_a_thermometer_that_falls(tmp_path: Path) -> None:
    made = firmware.generate(
        MODEL,
        "cortex-m0",
        temperature=FALLING,
        humidity=(0.1, 0.0, 1.0),
        echo=EchoCodes(0.5),
        output_unit="mm",
        max_error=1e-3,
        package="arduino",
    )
    lines = play(made, SKETCHES["arduino"], "cortex-m0", tmp_path, 1_000, [11_690, 38_000])
    echo, warm, damp, distance = map(int, lines[0].split())
    assert abs(echo - 2 * 11_690) <= 2 * STEP
    assert (warm, damp) == (100, 2)  # 50 degC; 0.303 of the supply of a HIH-5030: 23.8 %
    assert distance == np.asarray(made.outputs(echo, warm, damp))
    assert lines[1] == "no echo", "76,000 ticks are more than a code holds"
