"""Columns that say the same: one is the other times a factor, shifted, or rounded."""

from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column

_FEWEST = 5  # rows
_DIFFERENT = 4  # different values of each column: two points always lie on a line
_RELATED = 0.8  # squared correlation, far below what rounding leaves of a copy
_SLACK = 1.25  # of what rounding leaves open, for the factor is fitted
_WIDE = 8.0  # range of the values over what rounding leaves open: else anything lies on a line
_DIGITS = 1e-7  # of the largest value: what single precision leaves of it
_MOST_DIGITS = 9
_SOME = 5000  # rows that are looked at

_SPEEDS = (310.0, 365.0)
"""m/s: of sound in air from -35 to 55 degC, which is also what firmware takes it for."""

_APART = 0.1  # of a length, beyond what rounding leaves open: a delay, a ruler, single wild rows aside
_MOST = 0.9  # of the rows
_FINE, _ENOUGH = 2e-3, 20  # m and rows: what a ruler and a good sensor do not agree to, row after row


@dataclass(frozen=True)
class Line:
    """A column that follows from another: ``copy = factor * other + offset``, within the rounding of both."""

    factor: float
    offset: float

    def of(self, other: str) -> str:
        """What the copy is, with the name of the other column."""
        offset = f" {'+' if self.offset > 0 else '-'} {abs(self.offset):.4g}" if self.offset else ""
        return f"{self.factor:.6g} times '{other}'{offset}"


def line_between(copy: Column, other: Column) -> Line | None:
    """The line on which two columns lie within their rounding; None where they do not.

    Examples
    --------
    >>> import numpy as np
    >>> reading = np.array([200.0, 200.5, 199.5, 100.0, 99.5, 50.5, 50.0, 24.0])
    >>> line_between(2 * reading, reading)
    Line(factor=2.0, offset=0.0)
    >>> line_between(np.floor(reading / 2.54), reading) is None
    False
    >>> line_between(reading + np.array([3, -2, 1, 0, 2, -1, 2, 1.0]), reading) is None
    True
    """
    known = np.flatnonzero(np.isfinite(copy) & np.isfinite(other))
    known = known[:: max(1, len(known) // _SOME)]
    y, x = copy[known], other[known]
    if len(known) < _FEWEST:
        return None
    x_off, y_off = x - x.mean(), y - y.mean()
    own, both = float(x_off @ x_off), float(x_off @ y_off)
    if not both * both > _RELATED * own * float(y_off @ y_off):
        return None
    if min(len(np.unique(y)), len(np.unique(x))) < _DIFFERENT:
        return None
    steps = tuple(0.0 if is_set(own) else resolution(own) for own in (y, x))
    factor = both / own
    factor, offset = _plain(factor, y, x, steps)
    open_ = 0.5 * (steps[0] + abs(factor) * steps[1])
    left = y - factor * x - offset
    exact = _DIGITS * float(np.abs(y).max())
    if np.abs(left).max() > _SLACK * open_ + exact or np.ptp(y) < _WIDE * open_:
        return None
    return Line(factor, offset)


def _plain(factor: float, y: Column, x: Column, steps: tuple[float, ...]) -> tuple[float, float]:
    """Factor and offset of the middle of a strip; without an offset, and round, where the rows allow it."""
    open_ = 0.5 * (steps[0] + abs(factor) * steps[1])
    ratio = float((x @ y) / (x @ x))
    for digits in (2, 3, 4, 5, 6, 17):
        rounded = float(f"{ratio:.{digits}g}")
        if np.abs(y - rounded * x).max() <= open_:
            return rounded, 0.0
    left = y - factor * x
    return factor, float(0.5 * (left.max() + left.min()))


def echo_speed(length: Column, seconds: Column) -> float:
    """Speed of sound [m/s] if a time is that of the echo from a length [m, s]; else 0."""
    known = np.isfinite(length) & np.isfinite(seconds) & (length > 0.0) & (seconds > 0.0)
    d, t = length[known], seconds[known]
    if len(d) < 2 or 2 * len(d) < len(length):
        return 0.0
    middle = float(np.median(2.0 * d / t))
    open_ = 0.5 * (resolution(d) + 0.5 * middle * resolution(t))
    near = np.abs(d - 0.5 * middle * t) <= open_ + _APART * d
    if not _SPEEDS[0] <= middle <= _SPEEDS[1] or near.mean() < _MOST:
        return 0.0
    return float(2.0 * (d[near] @ t[near]) / (t[near] @ t[near]))


def follows(length: Column, seconds: Column, temperature: Column | None = None) -> bool:
    """Whether a length [m] is what a device computes of the echo times [s], to the last digit it writes.

    With one speed of sound, or with one for each temperature [degC]. Lengths in steps of more than 2 mm are
    not judged: a good sensor agrees with a ruler as well.

    Examples
    --------
    >>> import numpy as np
    >>> air, echo = np.linspace(10.0, 30.0, 40), np.linspace(3e-3, 16e-3, 40)
    >>> made = 0.5 * (331.4 + 0.6 * air) * echo
    >>> follows(made.round(3), echo, air), follows(made.round(3), echo), follows(made.round(1), echo, air)
    (True, False, False)
    """
    known = np.isfinite(length) & np.isfinite(seconds) & (length > 0.0) & (seconds > 0.0)
    known &= True if temperature is None else np.isfinite(temperature)
    d, t = length[known], seconds[known]
    step = resolution(d)
    if len(d) < _ENOUGH or step > _FINE or not np.ptp(d) > _WIDE * step:
        return False
    speeds = [np.full(len(d), float(np.median(2.0 * d / t)))]
    if temperature is not None:
        slope = temperature[known] - temperature[known].mean()
        columns = np.column_stack([0.5 * t, 0.5 * t * slope])
        speeds.append(columns @ np.linalg.lstsq(columns, d, rcond=None)[0] / (0.5 * t))
    open_ = _SLACK * 0.5 * (step + 0.5 * float(speeds[0][0]) * resolution(t))
    return any(
        bool(_SPEEDS[0] <= np.median(c) <= _SPEEDS[1] and np.mean(np.abs(d - 0.5 * c * t) <= open_) >= _MOST)
        for c in speeds
    )


def resolution(values: Column) -> float:
    """Resolution in which values are written: one of the last digit, at most 1.

    The least difference is none: values that are set, as places on a tape, may all be multiples of ten.

    Examples
    --------
    >>> import numpy as np
    >>> resolution(np.array([10.0, 20.0, 40.0])), resolution(np.array([0.25, 0.5]))
    (1.0, 0.01)
    """
    known = values[np.isfinite(values)]
    same = _DIGITS * float(np.abs(known).max(initial=0.0))
    left = (float(np.abs(known - known.round(n)).max(initial=0.0)) for n in range(_MOST_DIGITS))
    return next((10.0**-n for n, own in enumerate(left) if own <= same), 0.0)


def is_set(values: Column) -> bool:
    """Whether all values are round: what somebody sets is, and what a device measures or rounds is not.

    Examples
    --------
    >>> import numpy as np
    >>> is_set(np.array([10.0, 25.0, 40.0])), is_set(np.array([10.0, 21.0, 40.0]))
    (True, False)
    """
    digit, known = resolution(values), values[np.isfinite(values)]
    return digit > 0.0 and bool(np.all(np.abs(np.remainder(known / digit + 2.5, 5.0) - 2.5) < 0.1))
