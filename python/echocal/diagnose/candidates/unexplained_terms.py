"""Unexplained terms: smooth functions of one column without a cause, which compete with the effects."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import legendre, waves
from echocal.diagnose.candidates.variant import UNKNOWN, Candidates, Variant
from echocal.diagnose.settings import TermSettings
from echocal.observations.quantiles import quantiles, spread

__all__ = ["HOUR", "Basis", "column_of", "degrees_of", "smooth_functions", "term_candidates"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

HOUR = "hour of day"
"""Name of the periodic term that is tried if a table spans days."""

_LINEAR = ("echo_quality",)
"""Columns of which a cause with the same name is a linear function: a term is what is left of them."""

VALUES_PER_DEGREE = 2
"""Distinct values for each degree: with fewer, a term would fit an error of each value."""

_FEWEST_VALUES = 6  # distinct ones: with fewer, there is no term, or a line if it is no known quantity
_ROWS_OF_A_VALUE = 8  # that have the least, and the largest, value of a column of few values
_HARMONICS = 2  # of the day
_FEWEST_DAYS = 2.0  # that a table with a term against the hour of the day spans
_DAY = 86400.0  # s
_MOST, _ROWS_EACH = 64, 4  # basis functions of all known quantities together; rows for each of them


@dataclass(frozen=True)
class Basis:
    """Basis functions of one column.

    Attributes
    ----------
    low, high : float
        Range of the functions: nearly all values of the column.
    """

    against: str
    low: float
    high: float
    settings: TermSettings

    @classmethod
    def of(cls, against: str, column: Column, settings: TermSettings) -> "Basis":
        """Basis functions for a column; for `HOUR`, for the time [s]."""
        if against == HOUR:
            return cls(HOUR, 0.0, 24.0, settings)
        low, high = quantiles(spread(column), settings.range)  # a few outliers must not widen the range
        return cls(against, low, high, settings)

    def at(self, values: Column) -> list[Column]:
        """All functions of.

        docs/method/rows-and-candidates.md, Eq. 2a, times their scales, with their means [m].
        """
        if self.against == HOUR:
            scales = _harmonics(self.settings)
            each = zip(scales, waves(values, 24.0, len(scales)), strict=True)
            return [size * wave for size, pair in each for wave in pair]
        scales = _scales(self.settings)
        functions = legendre(values, self.low, self.high, len(scales))[1:]
        return [size * function for size, function in zip(scales, functions, strict=True)]


def _scales(settings: TermSettings) -> list[float]:
    """Prior standard deviation of each degree [m]."""
    return [settings.size / degree for degree in range(1, max(settings.degrees) + 1)]


def _harmonics(settings: TermSettings) -> list[float]:
    """Prior standard deviation of each harmonic [m]."""
    return [settings.size / multiple for multiple in range(1, _HARMONICS + 1)]


def column_of(name: str, against: Mapping[str, Column]) -> Column:
    """Values of the column of a term; the hour of the day is computed from the time."""
    return against["time"] % _DAY / 3600.0 if name == HOUR else against[name]


def smooth_functions(known: Mapping[str, Column], rows: Labels, settings: TermSettings) -> list[Column]:
    """Basis functions of known quantities at some rows, as many as the rows allow."""
    able = [(name, column) for name, column in known.items() if degrees_of(column, settings)]
    each = min(_MOST, len(rows) // _ROWS_EACH) // max(len(able), 1)
    functions: list[Column] = []
    for name, column in able:
        own = Basis.of(name, column[rows], settings).at(column[rows])
        functions += own[: min(each, degrees_of(column, settings))]
    return functions


def term_candidates(
    found: Candidates,
    against: Mapping[str, Column],
    settings: TermSettings,
    *,
    known_distance: bool,
    further: Collection[str] = (),
) -> None:
    """Add an unexplained term against each column with enough values.

    No term has a mean, because an offset is a cause of the catalogue: a term with one would take up a
    delay. A term against the distance has no linear part either, because a scale is a cause, too, nor
    has one against the echo quality, if that cause competes. The candidates' `line` is for the check that
    these two are more than parts of an unknown effect.

    Parameters
    ----------
    found : Candidates
        Extended in place.
    against : mapping of str to ndarray, shape (n,)
        Columns by their names for people. ``"time"`` in seconds also gives the hour of the day, if
        it spans more than two days.
    known_distance : bool
        Whether the distance of every row is known. An unknown level includes the mean.
    further : collection of str
        Columns that are no known quantities.
    """
    constant = np.full(len(next(iter(against.values()))), settings.size)
    line = [found.columns.store(constant)] if known_distance else []
    for name, column in against.items():
        if most := degrees_of(column, settings, further=name in further):
            basis = Basis.of(name, column, settings)
            first = 1
            if name == "distance":
                line += found.columns.legendre(column, basis.low, basis.high, [settings.size])
                first = 2
            elif name in _LINEAR and any(v.cause == name for v in found.variants):
                first = 2
            functions = found.columns.legendre(
                column, basis.low, basis.high, _scales(settings)[first - 1 : most], first=first
            )
            for degree in sorted({min(degree, most) for degree in settings.degrees}):
                found.variants.append(_term(functions[: degree + 1 - first], name))
    if line:
        found.line = replace(_term(line, ""), scales=(settings.size,) * len(line))
    elapsed = against.get("time")
    if elapsed is not None and np.isfinite(elapsed).all() and np.ptp(elapsed) > _FEWEST_DAYS * _DAY:
        daily = found.columns.waves(elapsed, _DAY, _harmonics(settings))
        found.variants.append(_term(daily, HOUR))


def degrees_of(column: Column, settings: TermSettings, *, further: bool = False) -> int:
    """Highest degree of a term against a column; 0 if the column has gaps or too few values.

    A `further` column is no known quantity. With few values it is a switch or a version, and has a line.
    """
    most = max(settings.degrees)
    enough = most * VALUES_PER_DEGREE
    values = _distinct(column, enough) if np.isfinite(column).all() else 0
    if values >= _FEWEST_VALUES:
        return min(most, values // VALUES_PER_DEGREE)
    return int(further and values > 1 and _switches(column, settings))


def _switches(column: Column, settings: TermSettings) -> bool:
    """Whether the ends of a column with few values are of several rows each."""
    low, high = quantiles(spread(column), settings.range)
    return low < high and min(np.sum(column == low), np.sum(column == high)) >= _ROWS_OF_A_VALUE


def _distinct(column: Column, enough: int) -> int:
    """Number of distinct values, or a smaller number that is enough."""
    few = len(np.unique(column[:1000]))
    return few if few >= enough else len(np.unique(column[: 10**5]))


def _term(columns: Sequence[int], name: str) -> Variant:
    return Variant(UNKNOWN, free=tuple(columns), bounds=((-np.inf, np.inf),) * len(columns), against=name)
