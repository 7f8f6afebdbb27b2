"""The Arduino library on a simulated UNO: from the trigger pulse to the line that it prints."""

from pathlib import Path
from statistics import mean

import numpy as np
import pytest
from boards.arduino import link, serial
from conftest import with_humidity

from echocal import Model, firmware, silicon
from echocal.firmware import Firmware

SKETCH = "examples/HcSr04/HcSr04.ino"
# Around the turns of Timer1 (32,768 us), at both ends of what is accepted, and past it.
ECHOES = [120, 150, 580, 11_690, 23_456, 25_090, 25_120, 32_767, 32_768, 32_769, 38_000, 50_000]
# Without an echo: no pulse, a time-out of 36 to 38 ms, or a long one, in which a module heeds no trigger.
NO_ECHO = [0, 36_000, 38_000, 130_000]
REFUSED = ["no echo"] * 5
MILLIVOLTS = 713  # of a TMP36, 21.3 degC; code 663 of 10 bits, whose middle is 712.8 mV, 21.3 degC


def thermometer(package: str = "arduino") -> Firmware:
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    return firmware.generate(model, "avr", temperature=(0.0625, -20.0, 60.0), package=package)


def check(packed: Firmware, lines: list[str], echoes: list[int], *codes: int) -> None:
    """Each line: the echo to a microsecond, the codes, and the distance that the twin gives for these."""
    for line, sent in zip(lines, echoes, strict=True):
        echo, *rest = line.split(maxsplit=1 + len(codes))
        assert abs(int(echo) - sent) <= 1
        distance = int(packed.distance_um(int(echo), *codes))
        reason = packed.report["statuses"][int(packed.status(int(echo), *codes))]
        assert rest == [*map(str, codes), reason if distance == -(2**31) else str(distance)]


@pytest.mark.slow
@pytest.mark.parametrize(("package", "sketch"), [("arduino", SKETCH), ("platformio", "src/main.cpp")])
def test_the_example_prints_the_twins_distance(package: str, sketch: str, tmp_path: Path) -> None:
    packed = thermometer(package)
    lines = serial(link(packed, sketch, tmp_path), (MILLIVOLTS, 0), ECHOES)
    check(packed, lines, ECHOES, 340)
    told = [line.split(maxsplit=2)[2] for line in lines]
    assert [told[0], *told[6:]] == ["too near", *["too far"] * 4, "no echo", "no echo"]
    assert all(line.isdigit() for line in told[1:6])


@pytest.mark.slow
@pytest.mark.parametrize("flags", [(), ("-DECHOCAL_NO_INPUT_CAPTURE",)], ids=["capture", "pulseIn"])
def test_without_an_echo_there_is_no_distance(flags: tuple[str, ...], tmp_path: Path) -> None:
    sketch = link(thermometer(), SKETCH, tmp_path, *flags)
    lines = serial(sketch, (MILLIVOLTS, 0), [*NO_ECHO, 11_690])
    assert [line[-7:] for line in lines[:-1]] == REFUSED
    assert int(lines[-1].split()[-1]) == pytest.approx(2_006_000, abs=3_000), "and the next echo is heard"


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::echocal.DomainWarning")  # of time-outs that are accepted
@pytest.mark.parametrize("flags", [(), ("-DECHOCAL_NO_INPUT_CAPTURE",)], ids=["capture", "pulseIn"])
def test_no_accepted_echo_is_too_long_to_wait_for(
    flags: tuple[str, ...], tmp_path: Path, random: np.random.Generator
) -> None:
    """The sketch gave up after 60 ms, whatever was accepted."""
    last = int(random.integers(62_000, 250_000)) // 4 * 4
    echo = firmware.EchoCodes(4.0, last)
    packed = firmware.generate(
        Model("cramer"), "avr", temperature=(0.5, -20.0, 60.0), echo=echo, max_error=2e-3, package="arduino"
    )
    echoes = [11_690, 59_700, 60_500, int(random.integers(62_000, last + 1)), last, last + 8]
    lines = serial(link(packed, SKETCH, tmp_path, *flags), (MILLIVOLTS, 0), echoes)
    for line, sent in zip(lines, echoes, strict=True):
        code, warm, told = line.split(maxsplit=2)
        assert abs(int(code) * 4 - sent) <= 2 + len(flags) * 0.0005 * sent
        distance = int(packed.outputs(int(code), int(warm)))
        assert told == ("no echo" if distance == -(2**31) else str(distance))


def test_the_example_prints_the_twins_distance_with_humidity(tmp_path: Path) -> None:
    packed = with_humidity("arduino")
    # 0.5 of the supply from a HIH-4030: 54.8 %
    lines = serial(link(packed, SKETCH, tmp_path), (MILLIVOLTS, 2500), ECHOES[:4])
    check(packed, lines, ECHOES[:4], 11, 5)


@pytest.mark.slow
@pytest.mark.parametrize("humid", [False, True])
def test_the_temperature_has_no_bias(humid: bool, tmp_path: Path, random: np.random.Generator) -> None:
    """Whatever the supply. It was the converter's reference, and 4.75 V for 5 V were 3.7 degC."""
    packed = thermometer()
    if humid:
        codes = {"humidity": (0.1, 0.0, 1.0), "temperature": (0.0625, -20.0, 60.0), "max_error": 1e-3}
        packed = firmware.generate(Model("virial"), "avr", package="arduino", **codes)
    warm = random.uniform(-19.0, 59.0, 100)
    supply, damp = random.uniform(4.5, 5.5), 0.5
    volts = np.column_stack((0.5 + warm / 100, np.full(100, supply * (0.16 + 0.62 * damp))))
    sketch = link(packed, SKETCH, tmp_path)
    played = silicon.play(sketch, np.full(100, 2e-3), voltages=volts, reference_voltage=supply, patience=5.0)
    codes_found = np.array([line.split()[1:-1] for line in played.lines], dtype=int)
    errors = codes_found[:, 0] * 0.0625 - warm
    assert abs(errors.mean()) <= 0.1
    assert np.abs(errors).max() <= 0.15, "a step of the converter, and of the code"
    assert not humid or set(codes_found[:, 1]) == {5}, "its output is a fraction of the supply"


def test_a_temperature_beyond_the_reference_is_refused(tmp_path: Path) -> None:
    """1.1 V are 60 degC of a TMP36; all that is hotter has the same code."""
    lines = serial(link(thermometer(), SKETCH, tmp_path), (1_150, 0), [2_000])
    assert lines == ["2000 32767 temperature out of range"]


def test_where_there_is_no_echo_it_says_so(tmp_path: Path) -> None:
    lines = serial(link(thermometer(), SKETCH, tmp_path), (MILLIVOLTS, 0), [70_000, 5_000])
    assert lines[0] == "no echo"


@pytest.mark.slow
def test_held_interrupts_are_worth_their_trouble(tmp_path: Path) -> None:
    """What the sketch says of pulseIn(): 0.6 % short with interrupts on, right without."""
    echoes = list(range(9_000, 13_000, 173))

    def errors(packed: Firmware, folder: str) -> list[int]:
        sketch = link(packed, SKETCH, tmp_path / folder, "-DECHOCAL_NO_INPUT_CAPTURE")
        lines = serial(sketch, (MILLIVOLTS, 0), echoes)
        return [int(line.split()[0]) - echo for line, echo in zip(lines, echoes, strict=True)]

    packed = thermometer()
    held = errors(packed, "held")
    text = packed.files[SKETCH]
    assert text.count("    noInterrupts();\n") == 1
    packed.files[SKETCH] = text.replace("    noInterrupts();\n", "")
    stolen = errors(packed, "stolen")
    assert max(map(abs, held)) <= 5
    assert -0.0075 < mean(stolen) / mean(echoes) < -0.0045


def test_the_selftest_passes_on_the_board(tmp_path: Path) -> None:
    """It needs no echo: the board is asked for one that never comes."""
    packed = thermometer()
    sketch = link(packed, "examples/SelfTest/SelfTest.ino", tmp_path)
    assert serial(sketch, (0, 0), []) == ["echocal self-test: passed"]
