"""Sentences that a user can check in the data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.concise import concise, decimal
from echocal.diagnose.findings.parts import Shifted
from echocal.observations.quantiles import median, quantiles
from echocal.quantities import BY_COLUMN, QUANTITIES

__all__ = [
    "Recorded",
    "enumerated",
    "first_against_others",
    "most_correlated",
    "parameter_text",
    "quantity_text",
    "readable",
    "shifted_text",
    "shown",
    "size_text",
    "spoken",
    "tendency",
]

Column = NDArray[np.float64]

_SHOWN = {name: (facts.shown.unit, facts.shown.factor) for name, facts in QUANTITIES.items()}
_SHOWN |= {name: _SHOWN[facts.id] for name, facts in BY_COLUMN.items()}
_SHOWN |= {"distance": ("m", 1.0), "hour of day": ("h", 1.0)}  # columns that are no influence quantities
"""Unit and factor in which people read a column."""

_READABLE = {"s": (1e6, "us"), "m": (1e3, "mm")}

_EVEN = 0.1  # spread over mean below which a signal counts as constant
_ENOUGH = 10_000  # rows that are enough for a rank correlation
_SAME = 1e-6  # m, far below the resolution of such sensors


def enumerated(names: Sequence[str]) -> str:
    """``a, b and c``."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def quantity_text(name: str, value: float) -> str:
    """``18.3 degC``, ``64 %``: a value as people read it."""
    unit, factor = _SHOWN.get(name, ("", 1.0))
    return f"{decimal(value * factor)} {unit}".strip()


def shifted_text(one: Shifted) -> str:
    """What a model gains outside the range that it is fitted to."""
    low, high = (quantity_text(one.against, end) for end in (one.low, one.high))
    return (
        f"the model is fitted to rows with {spoken(one.against)} from {low} to {high}. On the {one.rows} "
        f"rows outside, the RMS error is {1e3 * one.rms_before_m:.2f} mm with the base and "
        f"{1e3 * one.rms_after_m:.2f} mm with the model"
    )


def parameter_text(name: str, value: float, uncertainty: float, unit: str) -> str:
    """``delay = 31.0(8) us``; without uncertainty where theory fixes the value."""
    return f"{name} = {size_text(value, uncertainty, unit)}"


def size_text(value: float, uncertainty: float, unit: str) -> str:
    """``31.0(8) us``: a value in SI units with its standard uncertainty, as people read it."""
    factor, shown = readable(max(abs(value), uncertainty), unit)
    return concise(value * factor, uncertainty * factor, shown)


def readable(value: float, unit: str) -> tuple[float, str]:
    """Factor to the unit in which people read a value, and this unit."""
    if unit == "s" and abs(value) >= 1.0:
        return 1.0, "s"  # a time constant, not an echo
    return _READABLE.get(unit, (1.0, "" if unit == "1" else unit))


def shown(name: str, values: Column) -> tuple[Column, str]:
    """Values in the unit that people read, and the label of the axis."""
    unit, factor = _SHOWN.get(name, ("", 1.0))
    return values * factor, f"{spoken(name)} [{unit}]" if unit else spoken(name)


def spoken(name: str) -> str:
    """Name of a column in a sentence: a quantity of echocal in words, any other name unchanged."""
    return QUANTITIES[name].words if name in QUANTITIES else name


@dataclass(frozen=True, eq=False)
class Recorded:
    """Recorded columns, and the ranks of some of their rows, computed once.

    Attributes
    ----------
    columns : mapping of str to ndarray, shape (n,)
    """

    columns: Mapping[str, Column]
    _known: dict[str, Column | None] = field(default_factory=dict, init=False, repr=False)

    def ranks(self, name: str) -> Column | None:
        """Ranks of some rows of a column; None if a row is missing or all values are equal."""
        if name not in self._known:
            column = self.columns[name]
            some = _some(column)
            varies = np.isfinite(column).all() and np.ptp(some) > 0
            self._known[name] = _ranks(some) if varies else None
        return self._known[name]


def most_correlated(signal: Column, against: Recorded) -> str | None:
    """Name of the column with the largest rank correlation with a signal."""
    best, name = 0.0, None
    if np.ptp(signal) < _SAME:
        return None
    ranks = _ranks(_some(signal))
    for candidate in against.columns:
        if (own := against.ranks(candidate)) is not None:
            strength = abs(float(np.corrcoef(ranks, own)[0, 1]))
            if strength > best + 0.02:  # a tie goes to the column that comes first
                best, name = strength, candidate
    return name


def _some(values: Column) -> Column:
    return values[:: max(1, len(values) // _ENOUGH)]


def _ranks(values: Column) -> Column:
    return np.unique(values, return_inverse=True)[1].astype(float)


def tendency(left: Column, signal: Column, against: Recorded) -> str:
    """Compare what a cause predicts with the residual of the base and the other causes.

    Parameters
    ----------
    left : ndarray, shape (n,)
        Reading less base less every other cause [m].
    signal : ndarray, shape (n,)
        What the cause adds [m].
    """
    name = most_correlated(signal, against)
    mean = abs(float(np.mean(signal)))
    if name is None or np.ptp(signal) < _EVEN * mean:
        return (
            f"the mean residual is {1e3 * np.mean(left):+.2f} mm; this cause predicts nearly the same error "
            f"in all rows, {1e3 * np.mean(signal):+.2f} mm"
        )
    low, high = quantiles(signal, [0.2, 0.8])
    lowest, highest = np.flatnonzero(signal <= low), np.flatnonzero(signal >= high)
    found = 1e3 * (left[highest].mean() - left[lowest].mean())
    predicted = 1e3 * (signal[highest].mean() - signal[lowest].mean())
    ends = [quantity_text(name, median(against.columns[name][rows])) for rows in (lowest, highest)]
    return (
        f"the fifth of the rows with {spoken(name)} around {ends[1]} has a mean residual of {found:+.2f} mm "
        f"relative to the fifth around {ends[0]}; this cause predicts {predicted:+.2f} mm"
    )


def first_against_others(left: Column, signal: Column, position: Column) -> str:
    """Compare the first rows of bursts with the others of the same bursts.

    Each burst is compared with itself, because its distance may have an error of its own.
    """
    first = position == 0
    burst = np.cumsum(first)
    counts = np.bincount(burst[~first], minlength=burst[-1] + 1)
    whole = np.flatnonzero(counts[1:]) + 1  # rows before the first burst belong to none
    if not len(whole):
        burst, counts, whole = np.zeros_like(burst), np.array([(~first).sum()]), np.array([0])

    def ahead(values: Column) -> float:
        one, rest = (_means(burst[rows], values[rows], len(counts))[whole] for rows in (first, ~first))
        return 1e3 * float(np.mean(one - rest))

    return (
        f"in {len(whole)} burst{'s' if len(whole) > 1 else ''}, the first ping reads {ahead(left):+.2f} mm "
        f"relative to the mean of the others; this cause predicts {ahead(signal):+.2f} mm"
    )


def _means(places: NDArray[np.int64], values: Column, number: int) -> Column:
    """Mean of the values of each place, 0 where there are none."""
    return np.bincount(places, values, number) / np.maximum(np.bincount(places, minlength=number), 1)
