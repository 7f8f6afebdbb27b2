"""Real firmware on an emulated board: from distances and air to the table that a person would have logged."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal import silicon
from echocal.arrays import Column
from echocal.emulation.inputs import TRUTH, Emulation, Inputs, from_ranges, from_table
from echocal.emulation.lines import columns_of, understood
from echocal.emulation.package import (
    PARTS_OF_ERROR,
    columns_of_package,
    compile_package,
    error_parts,
    package_of,
)
from echocal.errors import UsageError
from echocal.firmware import Firmware
from echocal.model import Model
from echocal.sweep.grid import Range
from echocal.virtual_bench.instruments import HIH4030, PARTS, AnalogThermometer
from echocal.virtual_bench.waveform.possible import check_seed

__all__ = ["PARTS_OF_ERROR", "TRUTH", "Emulation", "emulate", "error_parts"]

_BITS = 10
_PINS = 7, 8  # TRIG and ECHO of the sketches of this package
_OPTIONS = {"TMP36": (), "LM35": ("-DLM35",), "potentiometer": ("-DPOTENTIOMETER",)}
"""Options of the compiler with which the sketches of this package read a part."""

Progress = Callable[[int, int], object]


def emulate(
    sketch: str | Path | Model | Firmware = "study",
    table: Any = None,
    *,
    temperature: Range | None = None,
    distance: Range | None = None,
    relative_humidity: Range | None = None,
    pressure: Range | None = None,
    columns: Mapping[str, str] | None = None,
    part: str | AnalogThermometer = "tmp36",
    humidity: bool = False,
    reference_voltage: float = 5.0,
    adc_bits: int = _BITS,
    time_out: float | None = None,
    detector: str = "ideal",
    seed: int | None = None,
    trigger_pin: int = 7,
    echo_pin: int = 8,
    libraries: Iterable[str | Path] = (),
    patience: float = 5.0,
    progress: Progress | None = None,
) -> Emulation:
    """Run a sketch on an emulated Arduino UNO with an HC-SR04 and an analog thermometer.

    Needs avr-gcc, the Arduino core and libsimavr, which are no part of this package.

    Parameters
    ----------
    sketch : str, Path, Model or Firmware
        Name of a sketch of this package (`echocal.silicon.SKETCHES`), a file ``.ino`` or ``.cpp``; a model,
        whose Arduino library is generated; or a library from ``generate(..., package="arduino")``.
    table : path, DataFrame, or mapping of str to array_like, optional
        Rows with ``temperature_C`` and either ``echo_us``, the length of ECHO, or ``distance_m``. Optional:
        ``humidity_percent``, ``pressure_hPa``, ``radiation_W_m2``, and a time, by which a thermometer lags.
    temperature, distance, relative_humidity, pressure : float, tuple or sequence, optional
        Without a table: values, or (start, stop, step), stop included, of which every combination is a row
        [degC], [m], [1], [Pa]. Default: 2 m, dry air, 101325 Pa.
    columns : mapping of str to str, optional
        What columns of the table, or of a sketch's own lines, hold, as of `echocal.read_observations`.
    part : str or AnalogThermometer
        Thermometer at A0: ``"tmp36"``, ``"lm35"``, ``"potentiometer"``, or one of
        `echocal.virtual_bench.instruments`. A name stands for a part without noise, lag and tolerance,
        unless `seed` is given.
    humidity : bool
        Whether a HIH-4030 is at A1 and the library of a model reads it.
    reference_voltage : float
        Voltage of the board that the converter compares with [V]. The sketches suppose 5 V.
    adc_bits : int
        Bits of the converter; an ATmega328P has 10.
    time_out : float, optional
        Length of ECHO for a missed echo [s]; default: no pulse.
    detector : {"ideal", "comparator"}
        Where distances are given: "ideal" holds ECHO for 2 d / c; "comparator" is an HC-SR04 of the
        virtual bench.
    seed : int, optional
        Draws one part of its kind, with the tolerance, the noise and the lag of its data sheet, and the noise
        of the comparator.
    trigger_pin, echo_pin : int
        Pins of the board.
    libraries : iterable of path
        Folders of Arduino libraries that the sketch includes.
    patience : float
        Time on the board without a trigger after which the run ends [s].
    progress : callable, optional
        Called with the number of rows begun, and that of all.

    Returns
    -------
    Emulation

    Raises
    ------
    UsageError
        If a tool is not installed, an argument is impossible, or a request makes no sense.
    DataError
        If the table lacks what the board needs, or the sketch does not compile, trigger or print.

    Examples
    --------
    >>> import echocal
    >>> found = echocal.emulate("study", temperature=[0.0, 20.0, 40.0], distance=2.0)
    >>> found.table[["reading_m", "temperature_C", "distance_m"]].round(2).to_numpy().tolist()
    [[2.06, -0.2, 2.0], [1.99, 19.82, 2.0], [1.92, 39.84, 2.0]]
    >>> float(round((found.errors()["echo_us"] / (found.echo * 1e6)).mean(), 3))
    -0.006
    """
    if adc_bits != _BITS:
        raise UsageError(f"the converter of an ATmega328P has {_BITS} bits, not {adc_bits}")
    _refuse(sketch, trigger_pin, echo_pin, seed)
    libraries = [libraries] if isinstance(libraries, str | Path) else list(libraries)
    silicon.refuse_impossible(reference_voltage, trigger_pin, echo_pin, time_out, patience)
    silicon.refuse_missing()
    inputs = _inputs(table, columns or {}, detector, seed, temperature, distance, relative_humidity, pressure)
    asked = {name: request for name, request in (columns or {}).items() if name not in inputs.names}
    own = _is_own(sketch)
    if asked and not own:
        message = f"no column '{next(iter(asked))}': the table has {', '.join(inputs.names) or 'none'}"
        raise UsageError(message)
    thermometer, random = _thermometer(part, seed)
    program, made = _compiled(sketch, thermometer.name, humidity, libraries, own=own)
    played = silicon.play(
        program,
        inputs.echo,
        voltages=_voltages(inputs, thermometer, random, reference_voltage),
        reference_voltage=reference_voltage,
        time_out=time_out,
        trigger_pin=trigger_pin,
        echo_pin=echo_pin,
        patience=patience,
        progress=progress,
    )
    if made is not None:
        told = columns_of_package(played, made)
    else:
        told = understood(played, asked) if own else columns_of(played)
    name = "C of the model" if made is not None else str(sketch)
    return Emulation(_joined(told, inputs), inputs, played, name, made)


def _compiled(
    sketch: str | Path | Model | Firmware,
    part: str,
    humidity: bool,
    libraries: Iterable[str | Path],
    *,
    own: bool,
) -> tuple[silicon.Sketch, Firmware | None]:
    """Compile a sketch, or the library of a model with its example; return the library, too."""
    made = package_of(sketch, part, humidity=humidity) if isinstance(sketch, Model) else sketch
    if isinstance(made, Firmware):
        return compile_package(made), made
    options = () if own else _options(part)
    return silicon.compile_sketch(made, libraries=libraries, options=options), None


def _is_own(sketch: str | Path | Model | Firmware) -> bool:
    return not isinstance(sketch, Model | Firmware) and sketch not in silicon.SKETCHES


def _refuse(sketch: str | Path | Model | Firmware, trigger_pin: int, echo_pin: int, seed: int | None) -> None:
    """Refuse what is no sketch, pins that a sketch of this package does not have, and what is no seed."""
    if not isinstance(sketch, str | Path | Model | Firmware):
        raise UsageError(f"sketch is {sketch!r}; give a name, a file, a Model or a Firmware")
    if not _is_own(sketch) and (trigger_pin, echo_pin) != _PINS:
        raise UsageError(
            f"the pins are {trigger_pin} and {echo_pin}, and the sketches of this package have TRIG at "
            f"{_PINS[0]} and ECHO at {_PINS[1]}: leave the pins out, or give a sketch of your own"
        )
    if seed is not None:
        check_seed("seed", seed)


def _inputs(
    table: Any, columns: Mapping[str, str], detector: str, seed: int | None, *ranges: Range | None
) -> Inputs:
    if table is None:
        return from_ranges(*ranges, detector=detector, seed=seed)
    if any(one is not None for one in ranges):
        raise UsageError("a table has its own distances and air: give it, or ranges of values, not both")
    return from_table(table, columns, detector, seed)


def _thermometer(
    part: str | AnalogThermometer, seed: int | None
) -> tuple[AnalogThermometer, np.random.Generator | None]:
    """Return the thermometer at A0, and what draws its noise."""
    random = None if seed is None else np.random.default_rng(seed)
    if isinstance(part, str):
        found = PARTS.get(part.lower())
        if not isinstance(found, AnalogThermometer):
            analog = ", ".join(name for name, one in PARTS.items() if isinstance(one, AnalogThermometer))
            why = "has no voltage, and its bus is not emulated" if found else "is unknown"
            raise UsageError(f"part '{part}' {why}; there are {analog}")
        return (found.ideal() if random is None else found.drawn(random)), random
    if not isinstance(part, AnalogThermometer):
        raise UsageError(f"part is {part!r}; give a name such as 'tmp36', or an AnalogThermometer")
    return part, random


def _options(part: str) -> tuple[str, ...]:
    if part not in _OPTIONS:
        raise UsageError(
            f"the sketches of this package read {', '.join(_OPTIONS)}, not a {part}: give a sketch that does"
        )
    return _OPTIONS[part]


def _voltages(
    inputs: Inputs, thermometer: AnalogThermometer, random: np.random.Generator | None, supply: float
) -> Column:
    recorded = thermometer.record(
        inputs.temperature, inputs.seconds, radiation=inputs.radiation, random=random
    )
    hygrometer = HIH4030 if random is None else HIH4030.drawn(random)
    damp = hygrometer.voltage(inputs.relative_humidity, inputs.temperature, supply)
    return np.column_stack([thermometer.voltage(recorded, supply), damp])


def _joined(told: pd.DataFrame, inputs: Inputs) -> pd.DataFrame:
    """What the sketch printed beside the truth and what else the input has; a printed column wins."""
    table = told.copy()
    if inputs.distance is not None:
        table["distance_m"] = inputs.distance
    table[TRUTH] = inputs.temperature
    for name in inputs.kept:
        if name not in table:
            table[name] = inputs.kept[name].to_numpy()
        elif name == "humidity_percent":
            table["true_humidity"] = inputs.kept[name].to_numpy()
    return table
