"""Columns called by their unit alone, ``inches`` and ``ms``: a length says what a time beside it is."""

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.observations.alike import echo_speed
from echocal.observations.found import Found
from echocal.observations.units import NAMES
from echocal.observations.units_said import split_unit, symbol_of

__all__ = ["step"]

Column = NDArray[np.float64]

_TIMES = ("us", "ms", "s")
_LENGTHS = ("m", "cm", "mm", "inch", "ft")
_ECHOES = (1e-4, 0.06)  # s: 1.7 cm to 10 m


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Take a time for an echo where a length beside it agrees, or where it can be nothing else."""
    requests, notes = dict(found.requests), list(found.notes)
    lengths = {
        n: unit
        for n in map(str, table.columns)
        if (unit := _unit(n, found)) in _LENGTHS and _is_numeric(table[n])
    }
    for name in map(str, table.columns):
        unit = symbol_of(name)
        if (
            unit not in _TIMES
            or name in requests
            or not _is_numeric(table[name])
            or _runs_on(_si(table, name, f"echo_{unit}"))
        ):
            continue
        seconds = _si(table, name, f"echo_{unit}")
        for length, own in lengths.items():
            speed = echo_speed(_si(table, length, f"distance_{own}"), seconds)
            if speed:
                requests[name] = f"echo_{unit}"
                notes.append(f"'{name}' is read as echo_{unit}: it agrees with '{length}' ({speed:.0f} m/s)")
                break
        else:
            if unit == "us" and _ECHOES[0] <= np.nanmedian(seconds) <= _ECHOES[1]:
                requests[name] = "echo_us"
                notes.append(f"'{name}' is read as echo_us: its values go up and down, so it is no clock")
    return table, replace(found, requests=requests, notes=tuple(notes))


def _unit(name: str, found: Found) -> str:
    return symbol_of(found.units.get(name, "")) or symbol_of(name) or split_unit(name)[1]


def _si(table: pd.DataFrame, name: str, as_: str) -> Column:
    form, unit = NAMES[as_]
    return np.asarray(form.units[unit].to_si(table[name].to_numpy(dtype=np.float64, na_value=np.nan)))


def _is_numeric(values: "pd.Series[float]") -> bool:
    return bool(
        pd.api.types.is_numeric_dtype(values)
        and not pd.api.types.is_bool_dtype(values)
        and values.notna().any()
    )


def _runs_on(seconds: Column) -> bool:
    """Whether a time only grows, as that of a clock does."""
    steps = np.diff(seconds[np.isfinite(seconds)])
    return bool(len(steps) > 1 and (steps >= 0.0).all() and (steps > 0.0).any())
