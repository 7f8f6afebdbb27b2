"""Smooth shapes without a cause: what competes when no effect of the catalogue fits."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates import UNKNOWN, Candidates, Variant

__all__ = ["HOUR", "shape_candidates"]

Column = NDArray[np.float64]

HOUR = "hour of day"
"""Name of the periodic shape that is tried where a table spans days."""

_DEGREE = 7  # of the polynomial: bends, humps and a few waves
_HARMONICS = 2
_SIZE = 3e-3  # m, one prior standard deviation of the leading term: shot noise times two
_DAY = 86400.0
_LEVELS = 6  # fewer distinct values cannot show a smooth shape


def shape_candidates(found: Candidates, against: Mapping[str, Column]) -> None:
    """Add a smooth shape against each column that could show one.

    Parameters
    ----------
    found : Candidates
        Extended in place.
    against : mapping of str to ndarray, shape (n,)
        Columns by the name that a person knows them by. ``"time"`` in seconds also gives the
        hour of the day, where it spans more than two days.
    """
    for name, column in against.items():
        if np.isfinite(column).all() and len(np.unique(column[: 10**5])) >= _LEVELS:
            _add(found, name, _polynomials(found, column))
    elapsed = against.get("time")
    if elapsed is not None and np.isfinite(elapsed).all() and np.ptp(elapsed) > 2 * _DAY:
        _add(found, HOUR, [found.columns.store(wave) for wave in _harmonics(elapsed)])


def _add(found: Candidates, name: str, shapes: Sequence[int]) -> None:
    free = tuple(shapes)
    unbounded = ((-np.inf, np.inf),) * len(free)
    found.variants.append(Variant(UNKNOWN, free=free, bounds=unbounded, against=name))


def _polynomials(found: Candidates, column: Column) -> list[int]:
    low, high = np.percentile(column, [0.5, 99.5])  # a few far values must not bend the shape
    scales = [_SIZE / degree for degree in range(1, _DEGREE + 1)]
    return found.columns.legendre(column, float(low), float(high), scales)


def _harmonics(elapsed: Column) -> list[Column]:
    phases = [2 * np.pi * k * elapsed / _DAY for k in range(1, _HARMONICS + 1)]
    return [_SIZE / k * wave(p) for k, p in enumerate(phases, 1) for wave in (np.sin, np.cos)]
