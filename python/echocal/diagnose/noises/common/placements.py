"""Placements of the target, and stretches of rows inside them with one offset."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from echocal.diagnose.noises.common.trace import group_medians
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.preprocess.units import visits

__all__ = ["as_one_segment", "labelings", "some_of_each", "whole_steps"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


def labelings(
    table: Table, lefts: Iterable[Column], period: Column, window: int
) -> Iterator[tuple[Labels, float, Labels | None]]:
    """Number the stations; then the visits to them; then the stretches inside of visits.

    Parameters
    ----------
    table : Table
    lefts : iterable of ndarray, shape (n,)
        Residuals of probable hypotheses, and of none [m]: visits are divided where they step.
    period : ndarray, shape (n,)
        Length of one period [m].
    window : int
        Least rows of a stretch.

    Yields
    ------
    ndarray of int, shape (n,)
        Label of each row, numbered from 0 without a gap.
    float
        Log prior probability of the rows at which the stretches begin.
    ndarray of int, or None
        Periods of each stretch from the most usual level of its visit.
    """
    if table.reference is not None:
        yield table.groups, 0.0, None
    visit = visits(table)
    if visit[-1] > table.groups.max():
        yield visit, 0.0, None
    seen: set[bytes] = set()
    for left in lefts:
        hops, level = _hops(visit, left, period, window)
        if hops.any() and hops.tobytes() not in seen:
            seen.add(hops.tobytes())
            rows, count = len(hops), int(hops.sum())
            places = gammaln(rows + 1) - gammaln(count + 1) - gammaln(rows - count + 1)
            labels = np.cumsum(hops | (np.diff(visit, prepend=visit[0]) > 0), dtype=np.int64)
            yield labels, -float(places), np.round(group_medians(level, labels)).astype(np.int64)


def some_of_each(labels: Labels, most: int) -> Labels:
    """Rows, ascending: of each label all, or so many, evenly spaced."""
    order = np.argsort(labels, kind="stable")
    count = np.bincount(labels)
    taken = np.minimum(count, most)
    firsts, begins = np.cumsum(count) - count, np.cumsum(taken) - taken
    label = np.repeat(np.arange(len(count)), taken)
    place = np.arange(int(taken.sum())) - begins[label]
    return np.sort(order[firsts[label] + place * count[label] // taken[label]])


def whole_steps(table: Table, period: Column, fewest: int, alike: float) -> bool:
    """Whether the steps of an unknown level may be whole periods: the phases of their heights are alike."""
    at = np.flatnonzero(np.diff(table.groups)) + 1
    if len(at) < fewest:
        return False
    level = group_medians(table.indication, table.groups)
    phase = (level[table.groups[at]] - level[table.groups[at - 1]]) / period[at]
    return bool(np.abs(np.exp(2j * np.pi * phase).mean()) > alike and np.cos(2 * np.pi * phase).mean() > 0)


def as_one_segment(table: Table) -> Table:
    """The table with one unknown level; its series begin where they did."""
    return replace(table, groups=np.zeros_like(table.groups), steps=table.steps[:0])


def _hops(visit: Labels, left: Column, period: Column, window: int) -> tuple[NDArray[np.bool_], Column]:
    """First rows of stretches a period or more from the rows before; level of each row in periods."""
    import pandas as pd  # takes long to import

    turn = 2 * np.pi * left / period
    phase = np.arctan2(np.bincount(visit, np.sin(turn)), np.bincount(visit, np.cos(turn)))  # of most rows
    level = np.round((turn - phase[visit]) / (2 * np.pi))
    level -= np.round(group_medians(level, visit))[visit]
    smooth = pd.Series(level).rolling(window, center=True, min_periods=1).median().round().to_numpy()
    hops = np.zeros(len(left), dtype=bool)
    hops[1:] = (np.diff(smooth) != 0) & (np.diff(visit) == 0)
    ends = np.flatnonzero(hops | (np.diff(visit, prepend=-1) > 0))
    length = np.diff(np.append(ends, len(left)))
    short = ends[length < window // 2]
    hops[short] = False
    return hops, level
