"""The external component for ESPHome in a node, and ESPHome's own `ultrasonic` beside it."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boards.esphome import FLAGS, PLATFORMS, build_library, configuration, esphome, generate, link, published
from conftest import made, with_humidity
from test_codes import METERS
from test_codes import made as odd
from toolchain import run

from echocal import Model, UsageError, firmware
from echocal.firmware import EchoCodes, Firmware

pytestmark = pytest.mark.filterwarnings("ignore::echocal.DomainWarning")  # of time-outs that are accepted

Node = Callable[[Firmware], Path]
HALF_DEGREES = (0.5, -20.0, 60.0)
NO_DISTANCE = -(2**31)
DEFAULT_US = 11_661  # the component's default of 2 m, at its 343 m/s
TIME_OUTS = (0, 36_000, 38_000, 65_000, 130_000, 200_000)  # us, pulses without an echo


def accepting(
    tick: float, longest: float, shortest: float | None = None, package: str = "esphome"
) -> Firmware:
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    echo = EchoCodes(tick, longest, shortest)
    return firmware.generate(model, package=package, temperature=HALF_DEGREES, echo=echo, max_error=2e-3)


CASES: dict[str, Callable[[], Firmware]] = {
    "default": lambda: made("degree_3", "esphome"),
    "humidity": lambda: with_humidity("esphome", "c99"),
    "half microseconds, mm": lambda: odd("humid_mm", package="esphome"),
    "every code": lambda: made("whole_range_of_echo", "esphome"),
    "from 0": lambda: accepting(1.0, 3_000, 0),
    "1 s": lambda: accepting(20.0, 1e6),
}


@pytest.fixture
def node(once: Callable[[str, Callable[[Path], None]], Path], tmp_path: Path) -> Node:
    """Compiles a node that includes the package."""

    def compiled(packed: Firmware) -> Path:
        source = generate(packed, tmp_path)
        return link(source, once("esphome-library", lambda folder: build_library(source, folder)))

    return compiled


def drawn(packed: Firmware, random: np.random.Generator, times: np.ndarray) -> tuple[list[Any], np.ndarray]:
    """Pulses of these lengths [us] in drawn air, and the distances [m] of the twin."""
    axes = packed.report["device"]["conditions"]
    codes = [
        random.integers(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1, len(times)) for axis in axes
    ]
    air = [axis["zero"] + axis["lsb"] * code for axis, code in zip(axes, codes, strict=True)]
    damp = air[1] * 100 if len(air) > 1 else np.full(len(times), np.nan)
    silence = random.integers(300, 12_300, len(times))
    outputs = packed.outputs(np.round(times / tick(packed)).astype(int), *codes)
    distances = np.where(outputs == NO_DISTANCE, np.nan, outputs * METERS[packed.unit])
    return list(zip(silence.tolist(), times.tolist(), air[0].tolist(), damp.tolist(), strict=True)), distances


def tick(packed: Firmware) -> float:
    """What a code of the echo time stands for [us]."""
    return round(packed.report["device"]["echo"]["lsb"] * 1e6, 6)


def ends(packed: Firmware) -> tuple[float, float]:
    """First and last accepted echo time [us]."""
    codes = packed.report["device"]["echo"]["codes"]
    return codes["minimum"] * tick(packed), codes["maximum"] * tick(packed)


def accepted(packed: Firmware) -> np.ndarray:
    """Accepted echo times, whole microseconds; half way between two ticks it may be either of them."""
    first, last = ends(packed)
    every = np.arange(np.ceil(first), np.floor(last) + 1).astype(int)
    every = every[every > 0]  # 0 stands for no pulse
    return every[np.abs(every / tick(packed) % 1 - 0.5) > 1e-3]


def beyond(packed: Firmware, random: np.random.Generator) -> np.ndarray:
    """Echo times that are not accepted: next to the ends, farther, and those of time-outs."""
    first, last = ends(packed)
    farther = random.uniform(last + tick(packed), 2 * last, 20)
    times = np.round([first - tick(packed), last + tick(packed), *farther, *TIME_OUTS]).astype(int)
    return times[(times < first) | (times > last)]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CASES, "drawn"])
def test_a_node_publishes_the_twins_distance(name: str, node: Node, random: np.random.Generator) -> None:
    """Of every accepted echo, where they ended at 11,661 us; of nothing else."""
    step, longest = random.choice([0.5, 1.0, 2.0, 10.0]), random.integers(12_000, 65_536)
    packed = CASES[name]() if name in CASES else accepting(float(step), float(longest * step))
    every = accepted(packed)
    some = every if len(every) < 30_000 else np.union1d(random.choice(every, 5_000), every[[0, -1]])
    pulses, distances = drawn(packed, random, some)
    refused, none = drawn(packed, random, beyond(packed, random))
    assert not np.isnan(distances).any()
    assert np.isnan(none).all()
    unknown = [(450, pulses[-1][1], warm, pulses[-1][3]) for warm in (np.nan, -40.0, 80.0)]
    told = published(node(packed), [*pulses, *refused, *unknown])
    np.testing.assert_allclose(told.distance[: len(pulses)], distances, rtol=2e-7, atol=1e-9)
    assert set(told.status[: len(pulses)]) == {"ok"}
    # A pulse of more than a second outlasts the next trigger, which has no echo, either.
    assert np.isnan(told.distance[len(pulses) :]).all()
    causes = [cause for cause in told.status[len(pulses) :] if cause != "echo still high"]
    expected = [reasons(packed, pulse) for pulse in refused]
    expected += [{"no temperature"}, *[{"temperature out of range"}] * 2]
    for cause, allowed in zip(causes, expected, strict=True):
        assert cause in allowed


def reasons(packed: Firmware, pulse: Any) -> set[str]:
    """Causes that may be given for an echo that is not accepted; past the time-out it depends on the loop."""
    silence, length, *_ = pulse
    first, last = ends(packed)
    if length <= 0:
        return {"no echo"}
    # So late a module ends its pulse without an echo.
    late = max(int(35_000 / tick(packed)), round(last / tick(packed))) + 1
    if late <= round(length / tick(packed)) and late <= 65_535:
        return {"no echo"}
    far = {"too near" if length < first else "too far"}
    return far if silence + length <= last + 25_000 else far | {"no echo"}


def test_far_echoes_that_esphomes_own_component_loses(node: Node, random: np.random.Generator) -> None:
    """By default `ultrasonic` gives up after an echo from 2 m at 343 m/s. Nearer both time the same echo."""
    packed = CASES["default"]()
    near = np.arange(200, DEFAULT_US, 97)
    far = np.array([DEFAULT_US, 11_800, 20_000, 25_000])
    pulses, distances = drawn(packed, random, np.concatenate((near, far)))
    told = published(node(packed), pulses)
    np.testing.assert_allclose(told.distance, distances, rtol=2e-7, atol=1e-9)
    assert np.isnan(told.plain).tolist() == [False] * len(near) + [True] * len(far)
    assert np.rint(told.plain[: len(near)] * 2e6 / 343).astype(int).tolist() == near.tolist()


def test_a_wire_that_bounces_does_not_shorten_the_echo(node: Node) -> None:
    """A pulse of a few microseconds alone is too near; ESPHome's `ultrasonic` takes it for noise."""
    told = published(node(CASES["default"]()), [(450, 5, 20.0, 50.0), (450, 5_000, 20.0, 50.0)])
    assert told.status == ["too near", "ok"]


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize("name", ["humidity", "1 s"])
def test_esphome_accepts_the_configuration(name: str, platform: str, tmp_path: Path) -> None:
    packed = CASES[name]()
    told = esphome("config", configuration(packed, tmp_path, platform))
    (timeout,) = re.findall(r"^    timeout: (\d+)us$", told, re.MULTILINE)
    assert ends(packed)[1] + 12_300 < float(timeout) < ends(packed)[1] + 26_000, "pulses begin within 12.3 ms"


def test_two_calibrations_in_one_node(tmp_path: Path) -> None:
    request = {"package": "esphome", "temperature": HALF_DEGREES}
    for name, pins in (("echocal", "GPIO"), ("left_tank", "GPIO1")):
        packed = firmware.generate(Model("cramer"), name=name, **request)
        text = packed.files[f"{name}.yaml"]
        packed.files[f"{name}.yaml"] = text.replace("GPIO", pins).replace("Distance", f"Distance {name}")
        path = configuration(packed, tmp_path)
    path.write_text(path.read_text().replace("sensor:", "  left_tank: !include left_tank.yaml\nsensor:", 1))
    esphome("compile", "--only-generate", path)
    source = tmp_path / ".esphome/build/node/src"
    main = (source / "main.cpp").read_text()
    for name in ("echocal", "left_tank"):
        assert f"{name}::EchocalSensor" in main
        sensor = source / f"esphome/components/{name}/{name}_sensor.cpp"
        run("g++", *FLAGS, "-fsyntax-only", f"-I{source}", sensor)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("timeout: 20ms", "value must be at least 25"),
        ("humidity: air_humidity", r"\[humidity\] is an invalid option"),
        ("temperature: none", "Couldn't find ID 'none'"),
    ],
)
def test_esphome_refuses_what_would_lose_distances(option: str, message: str, tmp_path: Path) -> None:
    packed = made("degree_2", "esphome")
    path = configuration(packed, tmp_path)
    example = tmp_path / "echocal.yaml"
    text = re.sub(f"^    {option.split()[0]}.*\n", "", example.read_text(), flags=re.MULTILINE)
    example.write_text(text.replace("    update_interval", f"    {option}\n    update_interval"))
    with pytest.raises(AssertionError, match=message):
        esphome("config", path)


def test_the_readme_tells_the_version_that_is_tested() -> None:
    version = esphome("version").split()[-1]
    assert f"a node of ESPHome {version}, its own code" in CASES["default"]().files["README.md"]


TOO_FAR = (20.0, 1.1e6, 2_000)


@pytest.mark.parametrize(
    ("package", "echo", "message"),
    [
        ("esphome", TOO_FAR, "0 .. 1000000 us, and 2000 .. 1100000 us are to be accepted"),
        (
            "arduino",
            TOO_FAR,
            "package 'arduino' measure echo times of 0 .. 1000000 us, and 2000 .. 1100000 us",
        ),
        ("platformio", TOO_FAR, "package 'platformio' measure echo times of 0 .. 1000000 us, and 2000 .."),
        ("micropython", TOO_FAR, "package 'micropython' measure echo times of 0 .. 1000000 us, and 2000 .."),
    ],
)
def test_what_a_package_cannot_measure_is_refused(package: str, echo: Any, message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)) as told:
        accepting(*echo, package=package)
    assert "or the package c" in str(told.value)
    assert accepting(*echo, package="c").files
