"""What the parameters of a unit cost on a simulated ATmega328P, beside the same request without them."""

from pathlib import Path

import numpy as np
import pytest
from toolchain import run

from echocal import Model, firmware, silicon
from echocal.firmware import Firmware
from echocal.per_unit import Block, UnitFirmware, generate_per_unit
from echocal.silicon.board import HERE

pytestmark = pytest.mark.slow

FINE = (0.0625, -20.0, 60.0)
DELAYED = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
BOTH = ("fixed_delay", "clock_error")
CHIP = ("avr-gcc", "-mmcu=atmega328p")
# By error bound [mm] and box: most bytes and cycles more than without unit data (avr-gcc 5.4 -Os).
MORE = {
    (0.5, BOTH): (58, 64),
    (0.3, BOTH): (58, 64),
    (0.1, BOTH): (78, 83),
    (0.5, ("fixed_delay",)): (12, 8),
}
DATA = """
#include <stdint.h>
uint16_t the_unit[2] = {%dU, %dU};
"""
LOAD = """
#include "echocal_unit.h"
void once(void);
void once(void)
{
    static echocal_unit unit;
    static uint8_t block[ECHOCAL_UNIT_BLOCK_BYTES];
    (void)%s;
}
"""


def objects(made: Firmware, folder: Path, *texts: str) -> list[Path]:
    made.save(folder)
    for number, text in enumerate(texts):
        (folder / f"echocal_more_{number}.c").write_text(text)
    flags = ("-Os", "-std=c99", "-ffunction-sections", "-fdata-sections", f"-I{folder}")
    compiled = []
    for source in sorted(folder.glob("echocal_*.c")):
        run(*CHIP, *flags, "-c", source, "-o", source.with_suffix(".o"))
        compiled.append(source.with_suffix(".o"))
    return compiled


def linked(things: list[Path], folder: Path, *flags: str | Path) -> Path:
    out = folder / "chip.elf"
    run(*CHIP, *flags, *things, "-nostartfiles", "-Wl,--gc-sections,-e,once", "-o", out)
    return out


def size(chip: Path) -> int:
    return int(run("avr-size", chip).splitlines()[1].split()[0])


def cost(made: Firmware, folder: Path, name: str, unit: tuple[int, int] = (0, 0)) -> tuple[int, int, int]:
    """Bytes of the function with all that it calls; fewest and most cycles of a call."""
    stub = (f"-DDISTANCE={name}", HERE / "avr_stub.S")
    folder.mkdir()
    flash = size(linked(objects(made, folder), folder, *stub)) - 6  # of the stub
    things = objects(made, folder, DATA % unit)
    chip = linked(things, folder, *stub, "-Wl,-u,the_unit")
    driver = folder / "driver"
    run("gcc", "-O2", HERE / "avr_driver.c", "-o", driver, "-lsimavr")
    codes = made.report["device"]["echo"]["codes"]
    echo = (str(codes["minimum"] + 300), str(codes["maximum"] - 300))
    # the third argument of a call stands where a humidity does: here the address of the first variable
    lines = run(driver, chip, *echo, "-320", "960", "640", "256", "256", "1").splitlines()
    fewest, most, _ = map(int, lines[-1].split())
    return flash, fewest, most


@pytest.mark.parametrize(("bound", "box"), MORE)
def test_unit_data_cost_few_bytes_and_cycles(bound: float, box: tuple[str, ...], tmp_path: Path) -> None:
    assert not silicon.missing("avr"), silicon.missing("avr")
    request = {"temperature": FINE, "max_error": bound * 1e-3}
    plain = firmware.generate(DELAYED, "avr", **request)
    made = generate_per_unit(DELAYED, box, "avr", **request)
    flash, _, cycles = cost(plain, tmp_path / "plain", "echocal_distance_um")
    more = cost(made, tmp_path / "units", "echocal_unit_distance_um", (2_000, 3_000))
    assert more[1] == more[2], "of constant time"
    bytes_, time = MORE[bound, box]
    assert more[0] - flash <= bytes_
    assert more[2] - cycles <= time


@pytest.mark.parametrize(
    ("call", "most"),
    [
        ("echocal_unit_load(&unit, block)", 300),
        ("echocal_unit_recalibrate(block, (const echocal_unit_point *)0x200, 2U)", 1_900),
    ],
)
def test_loading_and_recalibrating_are_small(call: str, most: int, tmp_path: Path) -> None:
    made = generate_per_unit(DELAYED, BOTH, "avr", temperature=FINE)
    tmp_path.joinpath("units").mkdir()
    things = objects(made, tmp_path / "units", LOAD % call)
    assert size(linked(things, tmp_path / "units")) <= most


def answers(made: UnitFirmware, chip: Path, folder: Path, code: int) -> list[str]:
    driver = folder / "driver"
    run("gcc", "-O2", HERE / "avr_driver.c", "-o", driver, "-lsimavr")
    codes = made.report["device"]["echo"]["codes"]
    echo = (str(codes["minimum"]), str(codes["maximum"]))
    lines = run(driver, chip, *echo, str(code), str(code), "1", "256", "256", "1").splitlines()
    return [line for line in lines if not line.startswith("Loaded")]


@pytest.mark.parametrize("bound", [0.5e-3, 0.1e-3])
def test_the_chip_gives_the_bits_of_the_twin(
    bound: float, tmp_path: Path, random: np.random.Generator
) -> None:
    made = generate_per_unit(DELAYED, BOTH, "avr", temperature=FINE, max_error=bound)
    delay, clock = made.box.sides
    block = Block(
        1, delay.least + int(random.integers(delay.span)), clock.least + int(random.integers(clock.span))
    )
    rate = int(made.layout.converted(clock, block.rate))
    late = int(made.layout.converted(delay, block.delay)) + made.layout.center
    folder = tmp_path / "units"
    folder.mkdir()
    stub = ("-DDISTANCE=echocal_unit_distance_um", HERE / "avr_stub.S", "-Wl,-u,the_unit")
    chip = linked(objects(made, folder, DATA % (rate, late)), folder, *stub)
    code = int(random.integers(-320, 961))
    row, _ = answers(made, chip, folder, code)
    codes = made.report["device"]["echo"]["codes"]
    echo = np.arange(codes["minimum"], codes["maximum"] + 1)
    value = 0
    for output in made.unit_outputs(echo, code, delay=block.delay, rate=block.rate).tolist():
        value = (value * 40_503 + output + 2**31) % (2**61 - 1)
    assert int(row, 16) % (2**61 - 1) == value
