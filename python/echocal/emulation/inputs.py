"""What the emulated board is given row by row: target, air and echo."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError, DataWarning, UsageError
from echocal.firmware import Firmware
from echocal.keywords import keyword
from echocal.observations import Observations, plan, read_observations
from echocal.observations.source import load
from echocal.silicon import Played
from echocal.sweep.grid import Range, axis
from echocal.virtual_bench.echo_time import check_air, echo_time

_ASIDE = {"echo_time", "reading", "reference_distance", "temperature"}
"""Quantities of a table that the board, or the truth, states itself."""

_STANDARD = 101_325.0  # Pa
_AIR = (("temperature", None), ("relative_humidity", 0.0), ("pressure", _STANDARD))
"""Quantities of the air, and what holds where a table has none."""
TRUTH = "true_air_degC"
"""Column with the true temperature of the air. It is named like none of a table's quantities."""


@dataclass(frozen=True)
class Inputs:
    """Rows for the board."""

    echo: Column  # length of ECHO [s]; NaN for a missed echo; shape (n,)
    # temperature, relative_humidity: of the air [degC], [1]; shape (n,)
    temperature: Column
    relative_humidity: Column
    distance: Column | None  # of the target [m], if it is known; shape (n,)
    ideal: Column | None = None  # echo time of this distance in this air, 2 d / c [s]; shape (n,)
    seconds: Column | None = None  # times of the rows [s]; shape (n,)
    radiation: Column = field(default_factory=lambda: np.zeros(1))  # irradiance of the sun [W/m2]; shape (n,)
    kept: pd.DataFrame = field(default_factory=pd.DataFrame)  # further columns, which stay in the result
    names: tuple[str, ...] = ()  # columns of the table
    pressure: Column = field(default_factory=lambda: np.full(1, _STANDARD))  # of the air [Pa]; shape (n,)


def from_ranges(
    temperature: Range | None,
    distance: Range | None,
    relative_humidity: Range | None,
    pressure: Range | None,
    *,
    detector: str,
    seed: int | None,
) -> Inputs:
    """Return every combination of values, the last one given changing the fastest."""
    if temperature is None:
        raise UsageError(f"a temperature is needed, such as {keyword('temperature', 20)}, or a table of rows")
    given = {
        "temperature": temperature,
        "distance": 2.0 if distance is None else distance,
        "relative_humidity": 0.0 if relative_humidity is None else relative_humidity,
        "pressure": _STANDARD if pressure is None else pressure,
    }
    axes = [axis(name, values).ravel() for name, values in given.items()]
    warm, far, damp, dense = (grid.ravel() for grid in np.meshgrid(*axes, indexing="ij"))
    kept = pd.DataFrame(index=range(len(warm)))
    if relative_humidity is not None:
        kept["humidity_percent"] = 100.0 * damp
    if pressure is not None:
        kept["pressure_hPa"] = dense / 100.0
    ideal = echo_time(far, warm, damp, dense)
    _refuse_none(ideal, UsageError)
    echo = echo_time(far, warm, damp, dense, detector=detector, seed=seed)
    return Inputs(echo, warm, damp, far, ideal, kept=kept, pressure=dense)


def from_table(source: Any, columns: Mapping[str, str], detector: str, seed: int | None) -> Inputs:
    """Return the rows of a table: echo times, or distances and the air.

    Requests for columns that the table does not have are left to the lines of the sketch. Raises `DataError`
    if it has neither, or no temperature.
    """
    table = load(source)
    names = tuple(map(str, table.columns))
    columns = {name: request for name, request in columns.items() if name in names}
    held = {one.form.quantity: one.column for one in plan.make(list(names), columns).assignments.values()}
    timed = "echo_time" in held
    kept = table.drop(columns=[column for quantity, column in held.items() if quantity in _ASIDE])
    if not timed:
        # a table of measurements has echo times or readings
        table = table.drop(columns=[held["reading"]] if "reading" in held else []).assign(echo_us=10_000.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # a row without echo is a missed echo here
        found = read_observations(table, columns, trust=[plan.EVERYTHING])
    warm, damp, dense = (_air(found, *one) for one in _AIR)
    try:
        check_air(warm, damp, dense)
    except UsageError as error:
        raise DataError(f"the table cannot be: {error}") from None
    far = found.reference_distance
    ideal = None if far is None else echo_time(far, warm, damp, dense)
    if not timed:
        if ideal is None:
            message = "the table has neither echo times (echo_us) nor distances of the target (distance_m)"
            raise DataError(message)
        _refuse_gaps("distance", ideal)
        _refuse_none(ideal, DataError)
    if timed:
        echo = np.where(found.echo_time > 0.0, found.echo_time, np.nan)
    else:
        echo = echo_time(cast("Column", far), warm, damp, dense, detector=detector, seed=seed)
    sun = found.conditions.get("radiation", np.zeros(len(warm)))
    return Inputs(
        np.asarray(echo),
        warm,
        damp,
        far,
        ideal,
        _seconds(found),
        sun,
        kept.reset_index(drop=True),
        names,
        dense,
    )


def _air(found: Observations, name: str, otherwise: float | None) -> Column:
    """Return a quantity of the air in each row."""
    values = found.conditions.get(name)
    if values is None:
        if otherwise is None:
            raise DataError(
                f"the table has no {name} of the air, which the thermometer of the board needs: {name}_C"
            )
        return np.full(len(found), otherwise)
    _refuse_gaps(name.replace("_", " "), values)
    return values


def _seconds(found: Observations) -> Column | None:
    if found.time is None:
        return found.conditions.get("elapsed_time")
    return np.asarray((found.time - found.time[0]) / np.timedelta64(1, "s"), dtype=np.float64)


def _refuse_none(ideal: Column, refusal: type[UsageError | DataError]) -> None:
    """Refuse a target that is not in front of the sensor."""
    behind = np.flatnonzero(ideal <= 0.0)
    if len(behind):
        message = f"the distance of row {behind[0] + 1} is not above 0 m: put the target before the sensor"
        raise refusal(message)


def _refuse_gaps(name: str, values: Column) -> None:
    gaps = np.flatnonzero(~np.isfinite(values))
    if len(gaps):
        raise DataError(
            f"{name} has no value in {len(gaps)} rows, the first is row {gaps[0] + 1}: the board needs one"
        )


@dataclass(frozen=True)
class Emulation:
    """What a sketch measured on the emulated board.

    Attributes
    ----------
    table : DataFrame
        What the sketch printed (``echo_us``, ``reading_m``, ``temperature_C``, as far as it does), the true
        ``distance_m``, the true temperature as `TRUTH`, and further columns of the input.
    inputs : Inputs
        What the board was given: echo times, air, distances.
    played : echocal.silicon.Played
        Lines of the sketch, and codes of the converter.
    name : str
        Name of the sketch.
    firmware : Firmware or None
        What was generated, if the sketch is that of a model.

    Examples
    --------
    >>> import echocal
    >>> found = echocal.emulate("timer_capture", {"temperature_C": [20.0], "echo_us": [11_660.0]})
    >>> found.name, found.played.codes.tolist(), list(found.table)
    ('timer_capture', [[143, -1]], ['echo_us', 'reading_m', 'temperature_C', 'true_air_degC'])
    """

    table: pd.DataFrame
    inputs: Inputs
    played: Played
    name: str
    firmware: Firmware | None = None

    @property
    def echo(self) -> Column:
        """True length of ECHO [s], NaN for a missed echo."""
        return self.inputs.echo

    def errors(self) -> dict[str, Column]:
        """Return what the sketch measured less what is true, for what it printed: [us], [m], [degC].

        Returns
        -------
        dict of str to ndarray, shape (n,)
            ``echo_us``, ``reading_m``, ``temperature_C``; NaN where a row has no value.
        """
        true = {"echo_us": self.echo * 1e6, "temperature_C": self.table[TRUTH].to_numpy(dtype=np.float64)}
        if "distance_m" in self.table:
            true["reading_m"] = self.table["distance_m"].to_numpy(dtype=np.float64)
        measured = {name: self.table[name].to_numpy(dtype=np.float64) for name in true if name in self.table}
        return {name: values - true[name] for name, values in measured.items()}
