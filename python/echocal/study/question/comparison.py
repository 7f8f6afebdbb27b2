"""What a suspect makes of the readings, beside what Table 2 has: mean, slope, scatter, step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.study.question.experiment import Readings
from echocal.study.question.suspects import Suspect
from echocal.study.tables import Table

__all__ = [
    "LIMIT",
    "Pattern",
    "Verdict",
    "compare",
    "curve",
    "deviation",
    "pattern_of",
    "unrounded",
    "without_steps",
]

Column = NDArray[np.float64]

LIMIT = 3.0
"""Standard errors beyond which a suspect is excluded."""

_STEPS = (10, 5, 2)  # mm, of readings that are whole centimeters, half centimeters, ...
_SMOOTH = 2  # degree of the curve of a suspect: a straight line, and the bend of a law
_SAME_SIZE = 0.5  # mm: a suspect that moves the readings by less moves them in no direction


@dataclass(frozen=True)
class Pattern:
    """What is left of readings less the calculation."""

    mean: float  # mean [mm]
    slope: float  # slope against the temperature [mm/K]
    scatter: float  # standard deviation about the line [mm]
    # mean_error, slope_error: standard errors of mean [mm] and slope [mm/K]
    mean_error: float
    slope_error: float
    step: int  # largest step [mm] of which all readings are multiples


@dataclass(frozen=True)
class Verdict:
    """Whether a suspect alone could have made the Tinkercad column.

    Attributes
    ----------
    excluded_by : tuple of str
        Of ``sign``, ``size``, ``slope``, ``step``, ``absent``; empty if the suspect remains.
    size : float or None
        Size that the table needs, where it is free.
    size_error : float or None
        Its standard error.
    """

    excluded_by: tuple[str, ...]
    size: float | None = None
    size_error: float | None = None

    @property
    def remains(self) -> bool:
        """Whether nothing excludes it."""
        return not self.excluded_by


def deviation(table: Table, reading: Column | None = None) -> Column:
    """Readings, by default Tinkercad's, less the calculation of Table 2 [mm], shape (n,) or (tables, n)."""
    told = table.values("measured_distance_tinkercad_m") if reading is None else reading
    return np.asarray((told - table.values("measured_distance_calculation_m")) * 1e3)


def pattern_of(temperature: Column, left: Column, reading: Column) -> Pattern:
    """Describe deviations [mm] and readings [m] of one table."""
    centered = temperature - temperature.mean()
    slope = float(centered @ left / (centered @ centered))
    rest = left - left.mean() - slope * centered
    scatter = float(np.sqrt(rest @ rest / (len(left) - 2)))
    step = next((one for one in _STEPS if not np.any(np.round(reading * 1e3) % one)), 1)
    mean_error = scatter / np.sqrt(len(left))
    return Pattern(
        float(left.mean()), slope, scatter, float(mean_error), scatter / float(np.linalg.norm(centered)), step
    )


def curve(table: Table, readings: Readings, size: float | None = None, staged: float | None = None) -> Column:
    """Deviation that a suspect makes [mm], mean over its tables, shape (n,); a free one in another size."""
    made = deviation(table, readings.reading).mean(axis=0)
    return np.asarray(made if size is None or staged is None else made * size / staged)


def unrounded(table: Table) -> Column:
    """Calculation of Table 2 before it was rounded to millimeters [m]: its speed is a straight line."""
    temperature, speed = table.temperature, 1.0 / table.values("measured_distance_calculation_m")
    return np.asarray(1.0 / np.polyval(np.polyfit(temperature, speed, 1), temperature))


def without_steps(table: Table, suspect: Suspect, readings: Readings) -> Column:
    """Deviation that a suspect makes, without what only this run of the board has [mm], shape (n,).

    Where the count begins and how a reading is rounded differ in each run. So a smooth curve through the rows
    stands for a suspect, unless the suspect itself cuts off.
    """
    away = (readings.reading.mean(axis=0) - unrounded(table)) * 1e3
    if suspect.cuts_off:
        return np.asarray(away)
    return np.asarray(np.polyval(np.polyfit(table.temperature, away, _SMOOTH), table.temperature))


def compare(table: Table, suspect: Suspect, readings: Readings) -> Verdict:
    """Judge a suspect by sign, size, slope and step.

    Parameters
    ----------
    table : Table
        Table 2.
    readings : Readings
        What the board made of it.
    """
    temperature = table.temperature
    wanted = pattern_of(temperature, deviation(table), table.values("measured_distance_tinkercad_m"))
    made = curve(table, readings)
    if suspect.free is not None:
        return _sized(suspect, wanted, made)
    own = pattern_of(temperature, made, readings.reading[0])
    found = [_by_size(own.mean, wanted)]
    if abs(own.slope - wanted.slope) > LIMIT * wanted.slope_error:
        found.append("slope")
    if own.step > wanted.step:
        found.append("step")
    if suspect.absent:
        found.append("absent")
    return Verdict(tuple(one for one in found if one))


def _by_size(mean: float, wanted: Pattern) -> str:
    """Return ``sign`` or ``size`` if a mean [mm] cannot be that of the table."""
    if abs(mean - wanted.mean) <= LIMIT * wanted.mean_error:
        return ""
    return "sign" if mean * wanted.mean < 0.0 and abs(mean) > _SAME_SIZE else "size"


def _sized(suspect: Suspect, wanted: Pattern, made: Column) -> Verdict:
    free = suspect.free
    if free is None:
        message = "a suspect of a fixed size has none to find"
        raise ValueError(message)
    unit = float(made.mean()) / free.staged  # mm for one unit of the size
    size, error = wanted.mean / unit, abs(wanted.mean_error / unit)
    inside = free.low - LIMIT * error <= size <= free.high + LIMIT * error
    wrong_way = (free.low >= 0.0 and size < 0.0) or (free.high <= 0.0 and size > 0.0)
    why = () if inside else ("sign",) if wrong_way else ("size",)
    return Verdict((*why, "absent") if suspect.absent else why, size, error)
