"""Firmware with the parameters of its unit: the bound against brute force, the C against its twin."""

import functools
import itertools
import json
import tracemalloc
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_misra import findings
from toolchain import HERE, STRICT, run

from echocal import Model
from echocal.errors import BoundError, UsageError
from echocal.per_unit import Block, UnitFirmware, generate_per_unit
from echocal.sensors import sensor_of

OUT_OF_RANGE = -(2**31)
OK, WRONG_VERSION, WRONG_CRC, DELAY, RATE, POINT, TOO_CLOSE = range(7)
BOTH = ["fixed_delay", "clock_error"]
DELAYED = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
CASES: dict[str, tuple[Model, Any, dict[str, Any]]] = {
    "whole codes": (DELAYED, BOTH, {}),
    "fractions": (DELAYED, BOTH, {"max_error": 0.1e-3}),
    "avr": (DELAYED, BOTH, {"target": "avr"}),
    "avr fractions": (DELAYED, BOTH, {"target": "avr", "max_error": 0.1e-3}),
    "wide": (DELAYED, {"fixed_delay": (-2e-4, 2e-4), "clock_error": (-0.05, 0.05)}, {"max_error": 0.6e-3}),
    "delay alone": (DELAYED, ["fixed_delay"], {}),
    "clock alone": (DELAYED, ["clock_error=-0.01:0.02"], {"max_error": 0.3e-3}),
    "other ticks": (DELAYED, BOTH, {"echo": (4.0, None, None), "max_error": 0.9e-3}),
    "short ticks": (DELAYED, BOTH, {"echo": (0.5, None, None), "max_error": 0.3e-3}),
    "diagnosed": (
        Model("linear", {"zero_error": {"offset": -4e-3}, "clock_error": {"frequency_error": 1e-3}}),
        ["clock_error", "fixed_delay=-2e-5:6e-5"],
        {"max_error": 0.4e-3},
    ),
}


@functools.cache
def made(name: str) -> UnitFirmware:
    model, box, request = CASES[name]
    if "echo" in request:
        from echocal.firmware import EchoCodes

        request = {**request, "echo": EchoCodes(request["echo"][0])}
    return generate_per_unit(model, box, **{"temperature": (2.0, -20.0, 60.0), **request})


def unit_model(name: str, delay: float, clock: float) -> Model:
    model = CASES[name][0]
    own = {"fixed_delay": {"delay": delay}, "clock_error": {"frequency_error": clock}}
    return Model(model.law, {**model.effects, **own})


def corners_and_inside(packed: UnitFirmware, random: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Delays and frequency errors: each corner of the box, and 12 places in it."""
    sides = packed.box.sides
    yield from itertools.product(*((side.low, side.high) for side in sides))
    yield from zip(*(random.uniform(side.low, side.high, 12) for side in sides), strict=True)


@pytest.mark.parametrize("name", CASES)
def test_no_unit_of_the_box_exceeds_the_bound(name: str, random: np.random.Generator) -> None:
    """Every echo code of 16 bits, by the model of the unit in floating point."""
    packed = made(name)
    delay, clock = (side.parameter for side in packed.box.sides)
    axis, (warm,) = packed.report["device"]["echo"], packed.report["device"]["conditions"]
    ends = (warm["codes"]["minimum"], warm["codes"]["maximum"])
    far, bound = packed.report["per_unit"]["maximum_distance_m"], packed.report["per_unit"]["error_proven_m"]
    # beyond the largest distance the function is off by its overall error, and the unit data by a little more
    share = packed.report["per_unit"]["error_of_the_unit_data_m"]
    beyond = packed.report["error_overall_m"] + share * 1.02
    worst = 0.0
    for late, fast in corners_and_inside(packed, random):
        model = unit_model(name, late, fast)
        codes = [*ends, *random.integers(ends[0], ends[1], 5)]
        echo, code = np.meshgrid(np.arange(65_536), codes, indexing="ij")
        truth = model.distance(echo * axis["lsb"], temperature=code * warm["lsb"] + warm["zero"])
        stored = {"delay": delay.stored(late), "rate": clock.stored(fast)}
        found = packed.unit_outputs(echo, code, **stored)
        accepted = found != OUT_OF_RANGE
        error = np.abs(found * 1e-6 - truth)[accepted]
        within = truth[accepted] <= far
        assert within.any()
        assert error[within].max() <= bound, (late, fast)
        assert error.max() <= beyond, (late, fast)
        worst = max(worst, error[within].max())
        # what is within reach in all conditions is within that of every unit
        near = packed.report["reach_m"]["always"][0] + 1e-3
        assert near < 0.03 or name == "wide"
        assert accepted[(truth > near) & (truth < far)].all(), (late, fast)
    assert bound <= packed.report["per_unit"]["error_bound_m"]
    assert worst > 0.6 * bound, "a bound that is far from every unit is of no use"


@pytest.fixture(scope="module")
def program(once: Callable[..., Path]) -> Callable[[str, str], str]:
    """Runs the C of a case on lines of text."""

    def built(name: str, lines: Iterable[str] | str) -> str:
        packed = made(name)

        def fill(folder: Path) -> None:
            packed.save(folder)
            sources = (folder / "echocal_correction.c", folder / "echocal_unit.c", HERE / "per_unit.c")
            free = [side.free for side in packed.box.sides]
            both = ("-DBOTH",) if all(free) else ()
            for compiler in ("gcc", "clang"):
                flags = ("-std=c99", "-O2", *STRICT, "-fsanitize=undefined", "-fno-sanitize-recover", *both)
                run(compiler, *flags, f"-I{folder}", *sources, "-o", folder / compiler)

        folder = once(f"per-unit-{name.replace(' ', '-')}", fill)
        text = lines if isinstance(lines, str) else "\n".join(lines)
        answers = {compiler: run(folder / compiler, text=text) for compiler in ("gcc", "clang")}
        assert answers["gcc"] == answers["clang"]
        return answers["gcc"]

    return built


def hash_of(numbers: np.ndarray) -> str:
    value = 0
    for number in numbers.tolist():
        value = (value * 40_503 + number) % 2**64
    return f"{value:016x}"


def status_of(packed: UnitFirmware, echo: np.ndarray, code: int, **stored: int) -> np.ndarray:
    """The rule, written once more: no echo, too near, else what the function says of the corrected code."""
    codes, _ = packed.layout.corrected(echo, **stored)
    first = packed.report["device"]["echo"]["codes"]["minimum"]
    time_out = packed.report["first_time_out_code"] or 65_536
    found = packed.status(codes, code).astype(np.int64)
    more = (echo - codes) & 0xFFFF
    return np.select([(echo == 0) | (echo >= time_out), echo < more + first], [1, 2], found)


@pytest.mark.parametrize("name", CASES)
def test_the_c_is_the_twin_for_every_echo_code(
    name: str, program: Callable[..., str], random: np.random.Generator
) -> None:
    packed = made(name)
    delay, clock = packed.box.sides
    echo = np.arange(65_536)
    lines, expected = [], []
    for late, fast in itertools.islice(corners_and_inside(packed, random), 8):
        block = Block(int(random.integers(2**32)), delay.parameter.stored(late), clock.parameter.stored(fast))
        stored = {"delay": block.delay, "rate": block.rate}
        code = int(random.integers(-10, 31))
        lines += [f"l {block.to_bytes().hex()}", f"d {code}"]
        lines += [f"w {block.number} {block.delay} {block.rate}"]
        outputs = packed.unit_outputs(echo, code, **stored).astype(np.int64) % 2**32
        status = status_of(packed, echo, code, **stored)
        assert ((outputs != OUT_OF_RANGE % 2**32) == (status == OK)).all()
        expected += [str(OK), hash_of(outputs + status), block.to_bytes().hex()]
    assert program(name, lines).split() == expected


def test_a_block_that_is_not_valid_gives_the_parameters_of_the_model(program: Callable[..., str]) -> None:
    packed = made("whole codes")
    delay, clock = packed.box.sides
    good = Block(4_711, delay.least + 5, clock.least + 7).to_bytes()
    damaged = []
    for place, bit in itertools.product(range(len(good)), range(8)):
        spoiled = bytearray(good)
        spoiled[place] ^= 1 << bit
        damaged.append((spoiled.hex(), WRONG_VERSION if place == 0 else WRONG_CRC))
    damaged += [("ff" * 12, WRONG_VERSION), ("00" * 12, WRONG_VERSION)]
    damaged += [(Block(1, delay.least - 1, clock.least).to_bytes().hex(), DELAY)]
    damaged += [(Block(1, delay.least + delay.span + 1, clock.least).to_bytes().hex(), DELAY)]
    damaged += [(Block(1, delay.least, clock.least - 1).to_bytes().hex(), RATE)]
    damaged += [(Block(1, delay.least, clock.least + clock.span + 1).to_bytes().hex(), RATE)]
    default = Block(0, *(side.parameter.stored(side.default) for side in (delay, clock)))
    answers = program("whole codes", [f"l {default.to_bytes().hex()}", "d 20"]).split()
    assert answers[0] == str(OK)
    lines = [line for block, _ in damaged for line in (f"l {good.hex()}", f"l {block}", "d 20")]
    found = program("whole codes", lines).split()
    assert found[1::3] == [str(status) for _, status in damaged]
    assert set(found[2::3]) == {answers[1]}, "each time the parameters of the model, none left over"
    assert program("whole codes", [f"l {good.hex()}", "d 20"]).split()[1] != answers[1]


def point(model: Model, distance: float, celsius: float, packed: UnitFirmware) -> str:
    """A reference point as a rig gives it: the sum of 16 echo codes, rounded to the nearest."""
    axis, (warm,) = packed.report["device"]["echo"], packed.report["device"]["conditions"]
    code = round((celsius - warm["zero"]) / warm["lsb"])
    time = model.time_of_flight(distance, temperature=code * warm["lsb"] + warm["zero"])
    return f"{round(distance * 1e6)} {round(16 * time / axis['lsb'])} {code}"


@pytest.mark.parametrize("name", ["whole codes", "fractions", "avr", "wide", "other ticks", "diagnosed"])
def test_two_known_distances_give_the_parameters_of_the_unit(
    name: str, program: Callable[..., str], random: np.random.Generator
) -> None:
    packed = made(name)
    delay, clock = packed.box.sides
    function = packed.report["error_overall_m"]
    for _ in range(20):
        inside = (
            random.uniform(side.low + 0.1 * width, side.high - 0.1 * width)
            for side, width in ((delay, delay.high - delay.low), (clock, clock.high - clock.low))
        )
        late, fast = inside
        model = unit_model(name, late, fast)
        start = Block(77, *(side.parameter.stored(side.default) for side in (delay, clock))).to_bytes().hex()
        near, far = random.uniform(0.2, 0.5), random.uniform(3.0, 3.9)
        points = [point(model, near, 20.0, packed), point(model, far, 20.0, packed)]
        if random.random() < 0.5:
            points.reverse()
        status, block = program(name, f"r {start} 2 {' '.join(points)}").split()
        assert int(status) == OK, (late, fast)
        found = Block.from_bytes(bytes.fromhex(block))
        assert found.number == 77
        # what the function is off at both points; sixteenths of a code and the steps of the block add
        speed = 331.0 + 0.6 * 20
        tick = packed.report["device"]["echo"]["lsb"]
        off = function + speed / 2 * (tick / 16 + 2e-6 / 32) + 4.0 * 2.0**-18
        error = [
            (clock.parameter.read(found.rate) - fast) * distance
            + (delay.parameter.read(found.delay) - late) * speed / 2
            for distance in (near, far)
        ]
        assert np.abs(error).max() < off, (late, fast, error)
        # one point more gives the same delay; the rate stays
        status, block = program(name, f"r {block} 1 {points[0]}").split()
        again = Block.from_bytes(bytes.fromhex(block))
        assert (int(status), again.rate) == (OK, found.rate)
        assert abs(again.delay - found.delay) <= 1


def test_a_recalibration_outside_the_box_is_refused_and_changes_nothing(program: Callable[..., str]) -> None:
    packed = made("whole codes")
    inside = point(DELAYED, 0.4, 20.0, packed)
    good = Block(77, 992, 0).to_bytes().hex()
    late = unit_model("whole codes", 150e-6, 0.0)
    early = unit_model("whole codes", -20e-6, 0.0)
    fast, slow = (unit_model("whole codes", 31e-6, error) for error in (3e-3, -3e-3))
    wild = "400000 16 20"

    def both(model: Model) -> str:
        return f"2 {point(model, 0.4, 20.0, packed)} {point(model, 3.5, 20.0, packed)}"

    damaged = "ff" + good[2:]
    asked = [
        (f"r {good} {both(late)}", DELAY, good),
        (f"r {good} {both(early)}", DELAY, good),
        (f"r {good} 1 {point(late, 0.4, 20.0, packed)}", DELAY, good),
        (f"r {good} {both(fast)}", RATE, good),
        (f"r {good} {both(slow)}", RATE, good),
        (f"r {good} 2 {inside} {point(DELAYED, 1.0, 20.0, packed)}", TOO_CLOSE, good),
        (f"r {good} 2 {inside} {inside}", TOO_CLOSE, good),
        (f"r {good} 1 {wild}", DELAY, good),
        (f"r {good} 1 400000 4294967295 20", POINT, good),
        (f"r {good} 1 9000000 38000 20", POINT, good),
        (f"r {good} 1 1000 38000 20", POINT, good),
        (f"r {good} 1 -2000000000 38000 20", POINT, good),
        (f"r {good} 1 400000 38000 99", POINT, good),
        (f"r {good} 3 {inside} {point(DELAYED, 3.0, 20.0, packed)}", POINT, good),
        (f"r {damaged} 1 {inside}", WRONG_VERSION, damaged),
    ]
    answers = program("whole codes", [line for line, _, _ in asked]).splitlines()
    assert answers == [f"{status} {block}" for _, status, block in asked]


def test_a_recalibration_without_points_reads_none(program: Callable[..., str]) -> None:
    good = Block(77, 992, 0).to_bytes().hex()
    assert program("whole codes", f"r {good} 0").split() == [f"{POINT}", good]


@pytest.mark.parametrize("name", ["delay alone", "clock alone"])
def test_a_single_parameter_is_adjusted_by_one_point(
    name: str, program: Callable[..., str], random: np.random.Generator
) -> None:
    packed = made(name)
    start = Block(3, *(side.parameter.stored(side.default) for side in packed.box.sides)).to_bytes().hex()
    (free,) = (side for side in packed.box.sides if side.free)
    place = packed.box.sides.index(free)
    for _ in range(20):
        values = [side.default for side in packed.box.sides]
        values[place] = random.uniform(0.9 * free.low + 0.1 * free.high, 0.1 * free.low + 0.9 * free.high)
        known = point(unit_model(name, *values), 2.0, 20.0, packed)
        status, block = program(name, f"r {start} 1 {known}").split()
        assert int(status) == OK
        found = Block.from_bytes(bytes.fromhex(block))
        off = (packed.report["error_overall_m"] + 2e-5) / 2.0
        by = abs(free.parameter.read((found.delay, found.rate)[place]) - values[place])
        assert (by if free.parameter.unit == "1" else by * 343.4 / 4.0) < off


def test_the_files_tell_what_is_proven() -> None:
    packed = made("fractions")
    told = packed.report["per_unit"]
    assert json.loads(packed.files["report.json"])["per_unit"] == told
    assert told["error_proven_m"] == told["error_of_the_function_m"] + told["error_of_the_unit_data_m"]
    assert told["error_of_the_function_m"] == packed.report["error_proven_m"]
    header = packed.files["echocal_unit.h"]
    assert "0x29B1" in header
    assert "CRC-16/CCITT-FALSE" in header
    millimeters = float(header.split("is at most ")[1].split(" mm")[0])
    assert told["error_proven_m"] * 1e3 <= millimeters < told["error_proven_m"] * 1e3 + 1e-4
    command = packed.report["provenance"]["command"]
    assert "--per-unit fixed_delay=0:8.1e-05 --per-unit clock_error=-0.0019:0.0019" in command
    assert "--max-error-mm 0.1 --max-distance-m 4 " in command


def test_a_hygrometer_is_passed_on(tmp_path: Path, random: np.random.Generator) -> None:
    codes = {"temperature": (4.0, -20.0, 32.0), "humidity": (0.25, 0.0, 1.0)}
    packed = generate_per_unit(Model("cramer"), BOTH, "avr", max_error=0.6e-3, **codes)
    packed.save(tmp_path)
    source = tmp_path / "echocal_unit.c"
    for compiler in ("gcc", "clang"):
        run(compiler, "-std=c99", "-O2", *STRICT, f"-I{tmp_path}", "-c", source, "-o", tmp_path / "unit.o")
    arguments = "uint16_t echo_us, int16_t temperature_code, uint8_t humidity_code, const echocal_unit *unit"
    assert f"int32_t echocal_unit_distance_um({arguments});" in packed.files["echocal_unit.h"]
    delay, clock = (side.parameter for side in packed.box.sides)
    bound = packed.report["per_unit"]["error_proven_m"]
    for late, fast in corners_and_inside(packed, random):
        echo = random.integers(300, 23_000, 4_000)
        warm, damp = random.integers(-5, 9, 4_000), random.integers(0, 5, 4_000)
        own = {"fixed_delay": {"delay": late}, "clock_error": {"frequency_error": fast}}
        truth = Model("cramer", own).distance(
            echo * 1e-6, temperature=warm * 4.0, relative_humidity=damp * 0.25
        )
        stored = {"delay": delay.stored(late), "rate": clock.stored(fast)}
        found = packed.unit_outputs(echo, warm, damp, **stored)
        within = truth < 4.0
        assert (found != OUT_OF_RANGE)[within & (truth > 0.03)].all()
        assert np.abs(found * 1e-6 - truth)[within & (found != OUT_OF_RANGE)].max() <= bound


def test_codes_whose_bits_are_dropped_are_taken_once_for_each_step() -> None:
    known = sensor_of("SHT31")
    assert known.humidity is not None
    tracemalloc.start()
    try:
        generate_per_unit(
            Model("cramer"),
            ["fixed_delay=0:8e-5"],
            max_error=0.8e-3,
            temperature=replace(known.temperature, low=20.0, high=22.0),
            humidity=known.humidity,
        )
        assert tracemalloc.get_traced_memory()[1] < 100e6  # every code: 750 x 65,536 numbers of 8 bytes
    finally:
        tracemalloc.stop()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["whole codes", "avr fractions", "delay alone", "clock alone"])
def test_misra_finds_only_the_deviations_that_the_header_tells(name: str, tmp_path: Path) -> None:
    packed = made(name)
    found = findings(packed, tmp_path, "echocal_unit.c")
    told = "2.5, 8.7: the macros and the functions are for the caller"
    assert told in packed.files["echocal_unit.h"]
    assert {rule for file, rule in found if file.startswith("echocal_unit")} == {"2.5", "8.7"}


def test_what_cannot_be_is_refused_with_the_way_out() -> None:
    few: dict[str, Any] = {"temperature": (2.0, -20.0, 60.0)}
    with pytest.raises(
        UsageError, match=r"humidity'.*can differ from unit to unit; this version has fixed_delay, c"
    ):
        generate_per_unit(DELAYED, ["humidity"], **few)
    with pytest.raises(
        UsageError, match=r"does not hold the model's own fixed_delay.delay, 3.1e-05 s, which"
    ):
        generate_per_unit(DELAYED, ["fixed_delay=0:2e-5"], **few)
    with pytest.raises(UsageError, match=r"is no range within the bounds of clock_error.*, -0.05 .. 0.05"):
        generate_per_unit(DELAYED, {"clock_error": (-0.2, 0.2)}, **few)
    with pytest.raises(UsageError, match=r"give EFFECT or EFFECT=LOW:HIGH"):
        generate_per_unit(DELAYED, ["clock_error=1"], **few)
    with pytest.raises(UsageError, match="named twice"):
        generate_per_unit(DELAYED, ["clock_error", "clock_error"], **few)
    with pytest.raises(UsageError, match="names no effect"):
        generate_per_unit(DELAYED, [], **few)
    with pytest.raises(UsageError, match=r"the package micropython has no unit data: choose package='c'"):
        generate_per_unit(DELAYED, BOTH, package="micropython", **few)
    with pytest.raises(UsageError, match="choose output_unit='um'"):
        generate_per_unit(DELAYED, BOTH, output_unit="mm", max_error=1e-3, **few)
    with pytest.raises(BoundError, match=r"parameters of a unit alone add up to .* mm.*or a finer tick"):
        generate_per_unit(DELAYED, BOTH, max_error=0.02e-3, form="full_table", **few)
    bent = Model("cramer", {"amplitude_walk": {"delay": 1e-4}})
    with pytest.raises(UsageError, match="with the effects amplitude_walk the echo time is no straight line"):
        generate_per_unit(bent, BOTH, max_error=4e-3, **few)
