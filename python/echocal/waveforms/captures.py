"""Captures as an argument: real numbers, a window, one row per capture."""

from collections.abc import Iterator
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, UsageError

Floats = NDArray[np.float64]

_AT_ONCE = 2**21
"""Samples of a block, 16 MB: enough that NumPy's calls cost little, and few enough for the cache."""


@dataclass(frozen=True)
class Captures:
    """Captures in a window of time."""

    rows: NDArray[np.generic]  # samples in the window, as they were given; shape (n, N)
    shape: tuple[int, ...]  # shape of the captures without the time
    start: float  # time of the first sample of the window [s]
    sample_rate: float  # samples per second [Hz]

    @property
    def count(self) -> int:
        """Samples of a capture."""
        return int(self.rows.shape[-1])

    def blocks(self) -> Iterator[tuple[slice, Floats, NDArray[np.bool_]]]:
        """Yield places, captures less their means with zeros for what is not finite, and which are finite.

        A converter's offset would be a step at the ends of the window, which is heard in any band.
        """
        size = max(_AT_ONCE // self.count, 1)
        for first in range(0, max(len(self.rows), 1), size):
            place = slice(first, first + size)
            block = np.asarray(self.rows[place], dtype=np.float64)
            finite = np.asarray(np.isfinite(block).all(axis=-1))
            if not finite.all():
                block = np.where(finite[:, None], block, 0.0)
            block = block - block[:, :1]  # so that a constant leaves nothing, not even a rounding error
            yield place, block - block.mean(axis=-1, keepdims=True), finite


def captures_of(waveform: ArrayLike, sample_rate: float, start: float, stop: float | None) -> Captures:
    """Return the captures in the window.

    Raises `DataError` if they are not real numbers along an axis of time, and `UsageError` if the window is
    empty.
    """
    values = (
        np.ma.filled(np.ma.asarray(waveform).astype(np.float64), np.nan) if np.ma.isMA(waveform) else waveform
    )
    try:
        samples = np.asarray(values)
    except ValueError:
        message = "waveform has captures of different lengths; pad them with the same number of samples"
        raise DataError(message) from None
    if samples.dtype.kind not in "fiu":
        raise DataError(f"waveform has the type {samples.dtype}; give real numbers")
    if samples.ndim == 0:
        raise DataError("waveform is one number; give samples, the last axis is the time")
    count = samples.shape[-1]
    first, last = _window(sample_rate, start, stop, count)
    shape = samples.shape[:-1]
    rows = samples[..., first:last].reshape(int(np.prod(shape)), last - first)
    return Captures(rows, shape, first / sample_rate, sample_rate)


def _window(sample_rate: float, start: float, stop: float | None, count: int) -> tuple[int, int]:
    length = count / sample_rate
    end = length if stop is None else stop
    for name, value in (("start", start), ("stop", end)):
        if not isinstance(value, Real | np.number) or not np.isfinite(float(value)):
            raise UsageError(f"{name} is {value!r}; give a time [s]")
    if not 0.0 <= start < end <= length * (1.0 + 1e-9):
        raise UsageError(
            f"the window is {start:g} .. {end:g} s, and a capture 0 .. {length:g} s ({count} samples); "
            "give 0 <= start < stop <= its end"
        )
    return round(start * sample_rate), min(round(end * sample_rate), count)


def positive(name: str, value: float, unit: str) -> float:
    """Return a number above 0. Raises `UsageError` if it is none."""
    if not isinstance(value, Real | np.number) or not 0.0 < float(value) < np.inf:
        raise UsageError(f"{name} is {value!r}; give a number above 0 [{unit}]")
    return float(value)


def per_capture(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return one positive number per capture, in a row.

    Raises `UsageError` if there is another number of them, or one is not above 0.
    """
    try:
        given = np.asarray(value, dtype=np.float64)
        numbers = np.broadcast_to(given, shape).reshape(-1)
    except (TypeError, ValueError):
        own = np.shape(value)
        message = f"{name} has the shape {own}, the captures {shape}; give one number, or one per capture"
        raise UsageError(message) from None
    if not ((given > 0.0) & np.isfinite(given)).all():
        raise UsageError(f"{name} is {value!r}; give numbers above 0 [unit of the waveform]")
    return numbers
