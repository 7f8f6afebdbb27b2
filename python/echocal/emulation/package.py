"""The Arduino library of a model, as `echocal.firmware.generate` makes it, on the board."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import UsageError
from echocal.firmware import EchoCodes, Firmware, generate
from echocal.model import Model
from echocal.silicon import Played, Sketch, compile_sketch

__all__ = ["columns_of_package", "compile_package", "package_of"]

_SKETCH = "examples/HcSr04/HcSr04.ino"
_FINE, _COARSE = (0.0625, -20.0, 60.0), (0.25, -20.0, 60.0)  # step and range of the codes [degC]
_HUMIDITIES = (0.05, 0.0, 1.0)
_ECHOES = (4.0, 25_600.0)  # tick and longest echo [us]
_THERMOMETER = "TMP36"  # of the example sketch


def package_of(model: Model, part: str, *, humidity: bool, **request: Any) -> Firmware:
    """Generate the library and its example sketch; `request` is for `firmware.generate`.

    Raises
    ------
    UsageError
        If the example sketch is for another thermometer.
    """
    if part != _THERMOMETER:
        message = f"the sketch of a model reads a {_THERMOMETER}, not a {part}: leave out the part"
        raise UsageError(message)
    if humidity:  # coarse, since every combination of three inputs is proven: 40 million
        return generate(
            model,
            "avr",
            package="arduino",
            temperature=_COARSE,
            humidity=_HUMIDITIES,
            echo=EchoCodes(*_ECHOES),
            **request,
        )
    return generate(model, "avr", package="arduino", temperature=_FINE, **request)


def compile_package(made: Firmware) -> Sketch:
    """Compile the example sketch of a library with it.

    Raises
    ------
    UsageError
        If it is no Arduino library.
    """
    if _SKETCH not in made.files:
        message = f"this firmware has no {_SKETCH}: generate(..., package='arduino')"
        raise UsageError(message)
    with tempfile.TemporaryDirectory(prefix="echocal-") as name:
        made.save(name)
        return compile_sketch(Path(name) / _SKETCH, libraries=[name])


def columns_of_package(played: Played, made: Firmware) -> pd.DataFrame:
    """Return echo time, temperature, humidity and distance of what the example sketch prints.

    NaN where it prints why there is no distance.
    """
    axes = (made.report["device"]["echo"], *made.report["device"]["conditions"])
    rows = np.full((len(played.rows), len(axes) + 1), np.nan)
    for row, lines in enumerate(played.rows):
        words = lines[0].split() if lines else []
        numbers = [word for word in words[: len(axes) + 1] if word.lstrip("-").isdigit()]
        rows[row, : len(numbers)] = [int(word) for word in numbers]
    scaled = [one["zero"] + one["lsb"] * rows[:, place] for place, one in enumerate(axes)]
    table = pd.DataFrame(
        {
            "echo_us": np.round(scaled[0] * 1e6, 9),
            "reading_m": rows[:, -1] * float(made.report["device"]["output"]["lsb"]),
        }
    )
    table["reading_m"] = table["reading_m"].round(9)
    table["temperature_C"] = np.round(scaled[1], 9)
    if len(axes) == 3:
        table["humidity_percent"] = np.round(100.0 * scaled[2], 9)
    return table
