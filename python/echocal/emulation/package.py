"""The Arduino library of a model on the board, and its error split into its origins."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.emulation.inputs import Emulation
from echocal.errors import DomainWarning, UsageError
from echocal.firmware import EchoCodes, Firmware, generate
from echocal.model import Model
from echocal.registry import find_effect
from echocal.silicon import Played, Sketch, compile_sketch

PARTS_OF_ERROR = {
    "timer": "steps of the timer, and what delays it",
    "sensors": "steps and errors of thermometer and hygrometer, less what the model corrects of them",
    "arithmetic": "the C against the model, which is proven",
    "air": "law, assumed air and effects on the speed of sound of the model, against the air of the bench",
    "transducer": "what module and target add to 2 d / c, less what the model corrects of it",
}
"""Origins of the error of a reading, and what they are."""

_SPEED, _DEFAULT_PART = "speed", "air"  # stages of effects

_SKETCH = "examples/HcSr04/HcSr04.ino"
_FINE, _COARSE = (0.0625, -20.0, 60.0), (0.25, -20.0, 60.0)  # step and range of the codes [degC]
_HUMIDITIES = (0.05, 0.0, 1.0)
_ECHOES = (4.0, 25_600.0)  # tick and longest echo [us]
_THERMOMETER = "TMP36"  # of the example sketch


def package_of(model: Model, part: str, *, humidity: bool, **request: Any) -> Firmware:
    """Generate the library and its example sketch; `request` is for `firmware.generate`.

    Raises `UsageError` if the example sketch is for another thermometer.
    """
    if part != _THERMOMETER:
        raise UsageError(f"the sketch of a model reads a {_THERMOMETER}, not a {part}: leave out the part")
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

    Raises `UsageError` if it is no Arduino library.
    """
    if _SKETCH not in made.files:
        raise UsageError(f"this firmware has no {_SKETCH}: generate(..., package='arduino')")
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


def error_parts(found: Emulation, model: Model) -> pd.DataFrame:
    """Split the errors of the readings.

    The parts of a row add up to its error. Each is the change of the distance when one value after the other
    is replaced: what the board has, by what is true.

    Parameters
    ----------
    found : Emulation
        From `emulate` with a model or its library.
    model : Model
        The model.

    Returns
    -------
    DataFrame
        A column for each of `PARTS_OF_ERROR` [m]; NaN where a row has no reading.

    Raises
    ------
    UsageError
        If true distances are not known, or the sketch is none of this model.

    Examples
    --------
    >>> import echocal
    >>> model = echocal.Model("cramer")
    >>> found = echocal.emulate(model, temperature=(0.0, 50.0, 10.0), distance=2.0)
    >>> parts = echocal.error_parts(found, model)
    >>> bool(abs(parts.sum(axis="columns") - found.errors()["reading_m"]).max() < 1e-9)
    True
    >>> parts.abs().max().idxmax()
    'air'
    """
    for name, given, kind in (("found", found, Emulation), ("model", model, Model)):
        if not isinstance(given, kind):
            raise UsageError(f"{name} is of the type {type(given).__name__}; give the {kind.__name__}")
    table, inputs = found.table, found.inputs
    if inputs.distance is None or inputs.ideal is None or found.firmware is None:
        raise UsageError("an error is split for the C of a model, and where the true distances are known")
    if found.firmware.report["model_hash"] != model.hash:  # the difference would be told as one of arithmetic
        raise UsageError(
            f"the model has the hash {model.hash[:12]}, and the C on the board was made from "
            f"{found.firmware.report['model_hash'][:12]}: give that model"
        )
    board = {"temperature": table["temperature_C"].to_numpy()}
    true = {"temperature": inputs.temperature}
    if len(found.firmware.report["device"]["conditions"]) == 2:  # else the model assumes the humidity
        board["relative_humidity"] = table["humidity_percent"].to_numpy() / 100.0
        true["relative_humidity"] = inputs.relative_humidity
    counted, reading = table["echo_us"].to_numpy() * 1e-6, table["reading_m"].to_numpy()

    def distance(
        one: Model, echo: NDArray[np.float64], known: dict[str, NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DomainWarning)  # told when the C was made
            return np.asarray(one.distance(echo, **known))

    exact = distance(_without(model, lambda stage: stage == _DEFAULT_PART), inputs.echo, true)
    measured = distance(model, inputs.echo, board)
    rounded = distance(model, counted, board)
    air = distance(_without(model, lambda stage: stage != _SPEED), inputs.ideal, true) - inputs.distance
    return pd.DataFrame(
        {
            "timer": rounded - measured,
            "sensors": measured - exact,
            "arithmetic": reading - rounded,
            "air": air,
            "transducer": exact - inputs.distance - air,
        }
    )


def _without(model: Model, stage_is: Callable[[str], bool]) -> Model:
    """Return the model without its effects of some stages."""
    kept = {name: sizes for name, sizes in model.effects.items() if not stage_is(find_effect(name).stage)}
    return Model(model.law, kept, air=model.air)
