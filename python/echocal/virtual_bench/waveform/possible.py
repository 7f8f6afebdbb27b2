"""Refuse what cannot be: a target behind the sensor, more than all humidity, a size below zero."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from echocal.errors import UsageError


@dataclass(frozen=True)
class Limits:
    """What a number may be."""

    # low, high: it is at least this and at most that
    low: float = -np.inf
    high: float = np.inf
    above: bool = False  # whether it must be more than `low`
    endless: bool = False  # whether it may be infinite: a thing that is not there, a size without end
    unit: str = ""
    way_out: str = ""  # what to do, if the limits do not tell it

    def allow(self, values: np.ndarray) -> np.ndarray:
        """Tell which values are possible."""
        low = values > self.low if self.above else values >= self.low
        finite = ~np.isnan(values) if self.endless else np.isfinite(values)
        return np.asarray(low & (values <= self.high) & finite)

    def told(self) -> str:
        """Tell in words what is possible."""
        unit = f" {self.unit}" if self.unit else ""
        if np.isfinite(self.low) and np.isfinite(self.high):
            return f"from {self.low:g} to {self.high:g}{unit}"
        if np.isfinite(self.low):
            return f"{'more than' if self.above else 'at least'} {self.low:g}{unit}"
        return "a finite number"


def check(name: str, value: ArrayLike, limits: Limits) -> None:
    """Check a number, or one for each reading.

    Raises `UsageError` if one is not possible; the text names it, its value, the limit and the way out.

    Examples
    --------
    >>> from echocal.virtual_bench.waveform.possible import Limits, check
    >>> check("relative_humidity", 0.5, Limits(0.0, 1.0))
    """
    values = np.asarray(value, dtype=np.float64)
    right = limits.allow(values)
    if right.all():
        return
    where = int(np.flatnonzero(~np.atleast_1d(right))[0])
    wrong = float(np.atleast_1d(values)[where])
    place = f" in reading {where + 1}" if values.ndim else ""
    unit = f" {limits.unit}" if limits.unit else ""
    message = f"{name} is {wrong:g}{unit}{place}; it must be {limits.told()}"
    raise UsageError(f"{message}: {limits.way_out}" if limits.way_out else message)


def check_seed(name: str, seed: object) -> None:
    """Check the seed of random numbers.

    Raises `UsageError` if it is no whole number of 0 or more.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise UsageError(f"{name} is {seed!r}; give a whole number of 0 or more")


def check_length(name: str, value: ArrayLike, count: int) -> None:
    """Check that a column has a value for each reading, or one for all.

    Raises `UsageError` if it has another number of values.
    """
    values = np.asarray(value)
    if values.ndim and values.shape != (count,):
        raise UsageError(
            f"{name} has the shape {values.shape}, and distance has {count} readings; "
            "give one number for all, or one for each reading"
        )
