"""Smooth shapes without a cause: what competes when no effect of the catalogue fits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import UNKNOWN, Candidates, Variant
from echocal.observations.quantiles import quantiles, spread

__all__ = ["DEGREES", "HOUR", "Basis", "column_of", "degrees_of", "shape_candidates"]

Column = NDArray[np.float64]

HOUR = "hour of day"
"""Name of the periodic shape that is tried where a table spans days."""

DEGREES = (4, 16)
"""Of the polynomials: a bend or a hump, cheaply; and waves or a narrow hump."""

_VALUES = 2  # distinct values of the column per degree: freer, a shape would be an error of each value
_HARMONICS = 2
_SIZE = 3e-3  # m, one prior standard deviation of the leading term: shot noise times two
_SCALES = tuple(_SIZE / degree for degree in range(1, max(DEGREES) + 1))
_WAVES = tuple(_SIZE / multiple for multiple in range(1, _HARMONICS + 1))
_DAY = 86400.0
_NEARLY_ALL = (0.005, 0.995)
_LEVELS = 6  # fewer distinct values cannot show a smooth shape


@dataclass(frozen=True)
class Basis:
    """Smooth functions of one column.

    Attributes
    ----------
    against : str
    low, high : float
        Range of the column that the functions are made for: nearly all of its values.
    """

    against: str
    low: float
    high: float

    @classmethod
    def of(cls, against: str, column: Column) -> "Basis":
        """Functions for a column; for the time of day, of the time [s]."""
        if against == HOUR:
            return cls(HOUR, 0.0, 24.0)
        low, high = quantiles(spread(column), _NEARLY_ALL)  # a few far values must not bend the shape
        return cls(against, low, high)

    def at(self, values: Column) -> list[Column]:
        """Every function, in units of its prior standard deviation [m]."""
        if self.against == HOUR:
            phase = 2 * np.pi * values / 24.0
            return [size * wave(k * phase) for k, size in enumerate(_WAVES, 1) for wave in (np.sin, np.cos)]
        scaled = (2 * values - self.low - self.high) / max(self.high - self.low, 1e-300)
        legendre = np.polynomial.legendre.legvander(np.clip(scaled, -1.5, 1.5), len(_SCALES)).T[1:]
        return [scale * function for scale, function in zip(_SCALES, legendre, strict=True)]


def column_of(name: str, against: Mapping[str, Column]) -> Column:
    """Values of a column that a shape is a function of; the hour of the day comes from the time."""
    return against["time"] % _DAY / 3600.0 if name == HOUR else against[name]


def shape_candidates(found: Candidates, against: Mapping[str, Column], *, known_distance: bool) -> None:
    """Add a smooth shape against each column that could show one.

    A shape has a mean: who does not know what it is cannot know that its mean is nought, and an
    offset would be named for it. Against the distance it has neither mean nor straight line, for
    there an offset and a scale are causes of the catalog. Whether they are more than what such a
    shape would have of its own is asked later, of the candidates' `line`.

    Parameters
    ----------
    found : Candidates
        Extended in place.
    against : mapping of str to ndarray, shape (n,)
        Columns by the name that a person knows them by. ``"time"`` in seconds also gives the
        hour of the day, where it spans more than two days.
    known_distance : bool
        Of every row; an unknown level has the mean already.
    """
    constant = np.full(len(next(iter(against.values()))), _SIZE)
    mean = [found.columns.store(constant)] if known_distance else []
    line = list(mean)
    for name, column in against.items():
        if most := degrees_of(column):
            basis = Basis.of(name, column)
            own, first = mean, 1
            if name == "distance":
                line += found.columns.legendre(column, basis.low, basis.high, [_SIZE])
                own, first = [], 2
            shapes = found.columns.legendre(
                column, basis.low, basis.high, _SCALES[first - 1 : most], first=first
            )
            for degree in sorted({min(degree, most) for degree in DEGREES}):
                found.variants.append(_shape([*own, *shapes[: degree + 1 - first]], name))
    if line:
        found.line = replace(_shape(line, ""), scales=(_SIZE,) * len(line))
    elapsed = against.get("time")
    if elapsed is not None and np.isfinite(elapsed).all() and np.ptp(elapsed) > 2 * _DAY:
        waves = found.columns.waves(elapsed, _DAY, _WAVES)
        found.variants.append(_shape([*mean, *waves], HOUR))


def degrees_of(column: Column) -> int:
    """Highest degree of a shape against a column; 0 where it has gaps or too few values to show one."""
    values = _distinct(column) if np.isfinite(column).all() else 0
    return min(max(DEGREES), values // _VALUES) if values >= _LEVELS else 0


def _distinct(column: Column) -> int:
    """Number of distinct values, or more than any shape asks for."""
    few = len(np.unique(column[:1000]))
    return few if few >= _VALUES * max(DEGREES) else len(np.unique(column[: 10**5]))


def _shape(columns: Sequence[int], name: str) -> Variant:
    return Variant(UNKNOWN, free=tuple(columns), bounds=((-np.inf, np.inf),) * len(columns), against=name)
