"""Values as they were recorded, and rows that are far off."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FarRows
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["POWER_ON", "at_power_on", "chance_far", "expected_everywhere", "far", "limit_of", "millimeters"]
__all__ += ["recorded"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]


POWER_ON = (85.0, 185.0)
"""degC, and the same in degF: DS18B20 data sheet, "power-on reset value"."""

_EXACT = 1e-6  # relative; what the arithmetic of units leaves of it


def at_power_on(celsius: Column) -> Mask:
    """Rows with exactly the value that a digital thermometer gives before it has measured."""
    return np.asarray(np.any([np.abs(celsius - value) <= _EXACT * value for value in POWER_ON], axis=0))


def recorded(view: View) -> Column:
    """Values as the logger wrote them: readings, else echo times."""
    reading = view.observations.reading
    return view.observations.echo_time if reading is None else reading


def expected_everywhere(view: View) -> Column:
    """What each row should read, also of rows that cannot be used [m]."""
    if view.reference is not None:
        return view.expected
    rows, known = np.arange(len(view)), np.isfinite(view.expected)
    return np.interp(rows, rows[known], view.expected[known]) if known.any() else view.expected


def limit_of(scatter: float, expected: Column, settings: FarRows) -> Column:
    """Deviation of a row from which on neither noise nor air explains it [m]."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.maximum(settings.deviations * scatter, settings.part * np.abs(expected)))


def far(view: View, settings: FarRows) -> Mask:
    """Rows farther off than noise or air."""
    if view.farthest <= settings.deviations * view.scatter:
        return np.zeros(len(view), dtype=bool)
    with np.errstate(invalid="ignore"):
        off = np.abs(view.deviation) > limit_of(view.scatter, view.expected, settings)
        return np.asarray(view.good & off)


def chance_far(view: View, settings: FarRows) -> float:
    """Rows that heavy-tailed noise alone would put that far: Student's t of 3 degrees, whole table."""
    from scipy.special import stdtr  # takes long to import

    limit = limit_of(view.scatter, view.expected[view.good], settings)
    part = len(limit) / max(len(limit[::97]), 1)
    scale = view.scatter / (MAD_TO_SD * 0.7649)  # median of |t| with 3 degrees is 0.7649
    return float(2 * part * stdtr(3, -limit[::97] / scale).sum()) + 1e-3


def millimeters(value: float) -> str:
    """A distance as people read it."""
    return f"{1e3 * value:.1f} mm"
