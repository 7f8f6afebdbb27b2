"""A node of ESPHome on a PC: ESPHome's own generator and C++, above pins and a clock that are simulated.

Beside the component under test it has ESPHome's own `ultrasonic`, as its documentation shows it.
"""

import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from toolchain import run

from echocal.firmware import Firmware

HERE = Path(__file__).parent
ENVIRONMENT = HERE.parents[2] / "target/esphome"
ESPHOME = ENVIRONMENT / "bin/esphome"
PLATFORMS = {"host": "host:", "esp8266": "esp8266: {board: d1_mini}", "esp32": "esp32: {board: esp32dev}"}
NODE = """
esphome: {name: node}
%s
packages:
  echocal: !include echocal.yaml
sensor:
  - {platform: template, id: air_temperature, update_interval: never}
  - {platform: template, id: air_humidity, update_interval: never}
  - {platform: ultrasonic, name: Plain, trigger_pin: GPIO12, echo_pin: GPIO13, update_interval: 1s}
"""
FLAGS = ("-std=gnu++20", "-fno-exceptions", "-w", "-DUSE_HOST")  # those of ESPHome, without its warnings
PINS = "components/host/gpio.cpp"  # what node.cpp replaces
OWN = Path("esphome/components/echocal")  # what a package brings
OBJECTS = ("helpers.o", "rest.o", "node.o")

Pulse = tuple[int, int, float, float]  # us before it, its length [us], degC, %


def esphome(*words: str | Path) -> str:
    """Standard output of a command of ESPHome that must succeed."""
    if not ESPHOME.exists():
        made = f"python -m venv --without-pip {ENVIRONMENT}"
        filled = f"pip --python {ENVIRONMENT}/bin/python install --no-deps -r .ci/esphome.txt"
        pytest.skip(f"no ESPHome: {made} && {filled}")
    done = subprocess.run((ESPHOME, *words), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def configuration(packed: Firmware, folder: Path, platform: str = "host") -> Path:
    """A node's configuration that includes the package, as its first lines say."""
    packed.save(folder)
    (folder / "node.yaml").write_text(NODE % PLATFORMS[platform])
    return folder / "node.yaml"


def generate(packed: Firmware, folder: Path) -> Path:
    """The folder of the C++ that ESPHome generates and of its own."""
    esphome("compile", "--only-generate", configuration(packed, folder))
    return folder / ".esphome/build/node/src"


def build_library(source: Path, folder: Path) -> None:
    """ESPHome's own files, and the board below them. Headers are most of the work, so files are joined."""
    files = sorted(path.relative_to(source) for path in (source / "esphome").rglob("*.cpp"))
    units: dict[str, list[str]] = {"helpers.cpp": [], "rest.cpp": []}
    for number, file in enumerate(files):
        if not file.match(f"*/{PINS}") and not file.is_relative_to(OWN):
            # Each file has a TAG of its own; those called helpers.cpp share another name with other files.
            text = f'#define TAG TAG_{number}\n#include "{file}"\n#undef TAG\n'
            units["helpers.cpp" if file.name == "helpers.cpp" else "rest.cpp"].append(text)
    for name, texts in units.items():
        (folder / name).write_text("".join(texts))
    for part in (folder / "helpers.cpp", folder / "rest.cpp", HERE / "node.cpp"):
        run("g++", *FLAGS, f"-I{source}", "-c", part, "-o", folder / f"{part.stem}.o")


def link(source: Path, library: Path) -> Path:
    """The node: its program of one configuration, the component, and what all nodes share."""
    program = source.parent / "node"
    own = [source / "main.cpp", source / OWN / "echocal_sensor.cpp"]
    for part in own:
        run("g++", *FLAGS, f"-I{source}", "-c", part, "-o", part.with_suffix(".o"))
    run("gcc", "-c", source / OWN / "echocal_correction.c", "-o", source / "correction.o")
    shared = (library / name for name in OBJECTS)
    objects = (part.with_suffix(".o") for part in own)
    run("g++", *objects, source / "correction.o", *shared, "-o", program)
    return program


class Told(NamedTuple):
    """What a node publishes after each trigger pulse."""

    distance: NDArray[np.float64]  # m
    status: list[str]
    plain: NDArray[np.float64]  # m, of ESPHome's `ultrasonic`


def published(node: Path, pulses: Iterable[Pulse]) -> Told:
    """What the node publishes."""
    text = "".join(f"{silence} {length} {warm} {damp}\n" for silence, length, warm, damp in pulses)
    home = f"HOME={node.parent}"  # where a node keeps its preferences
    lines = [line.split(maxsplit=2) for line in run("env", home, node, text=text).splitlines()]
    ours = [line for line in lines if line[0] == "D"]
    plain = [float(line[1]) for line in lines if line[0] == "P"]
    return Told(np.array([float(line[1]) for line in ours]), [line[2] for line in ours], np.array(plain))
