"""Sketches of a generated package on the emulated UNO of `echocal.silicon`."""

from pathlib import Path

import numpy as np

from echocal import silicon
from echocal.firmware import Firmware

WARNINGS = ("-Wall", "-Wextra", "-Werror")


def link(packed: Firmware, sketch: str, folder: Path, *flags: str) -> silicon.Sketch:
    """A sketch of a package with the library beside it, without a warning."""
    packed.save(folder)
    headers = {(folder / path).parent for path in packed.files if path.endswith(".h")}
    return silicon.compile_sketch(folder / sketch, libraries=sorted(headers), options=(*WARNINGS, *flags))


def serial(sketch: silicon.Sketch, millivolts: tuple[float, float], echoes: list[int]) -> list[str]:
    """The lines that the sketch sends, one echo [us] after each of its trigger pulses; 0 is none."""
    times = np.array([echo * 1e-6 if echo else np.nan for echo in echoes])
    volts = np.array([millivolts]) * 1e-3
    return silicon.play(sketch, times, voltages=volts, patience=5.0 if echoes else 0.2).lines
