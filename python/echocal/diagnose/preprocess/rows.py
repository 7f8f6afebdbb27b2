"""Rows that cannot be what they seem, and stretches of constant level."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.observations.quantiles import Grouped, median

__all__ = ["far_as_a_whole", "far_from_stand", "far_rows", "level_steps", "series_starts"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

_MAD_TO_SD = 1.4826  # of a normal distribution
_HALF_WINDOW = 6  # rows on each side that vouch for a level
_FAR = 20.0  # robust standard deviations that no sensor's noise reaches
_FAR_RELATIVE = 0.02  # and part of the reading, below which a deviation may be physics
_EXCEPTIONS = 5  # rows that may stand alone
_PER_KELVIN = 0.002  # part of the reading that a kelvin changes where nobody compensates
_ANYHOW = 0.005  # and what else the air may do across a gap
_GAP = 5.0  # usual intervals between rows
_OFF_STAND = 10.0  # robust standard deviations that no noise of one target reaches
_CYCLES = 0.018  # m, four cycles of the carrier: more than a comparator misses
_AS_A_WHOLE = 0.5  # part of the rows from the first far one on
_VOUCH = 8  # rows of one stand that vouch for its level
_STEP = 7.0  # robust standard deviations of the difference of neighboring medians
_STEP_OF_NO_AIR = 4.5  # the same, where the air cannot have made it


def _robust(values: Column) -> tuple[float, float]:
    """Median and robust standard deviation."""
    known = values if np.isfinite(values).all() else values[~np.isnan(values)]
    center = median(known)
    return center, _MAD_TO_SD * median(np.abs(known - center))


def far_rows(indication: Column, expected: Column | None, orders: Callable[[], Sequence[Column]]) -> Mask:
    """Find rows far outside anything that noise or the air could do.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    expected : ndarray, shape (n,), or None
        Readings that the base simulation predicts [m]; None where the distance is not known, and
        the neighbors are the only witnesses.
    orders : callable
        ``orders()`` are columns, shape (n,), that a deviation may be a function of.

    Returns
    -------
    ndarray of bool, shape (n,)
        Also rows that physics might reach, where none of the neighbors does.
    """
    if len(indication) <= 2 * _HALF_WINDOW:
        return np.zeros(len(indication), dtype=bool)
    if expected is None:
        import pandas as pd  # takes long to import

        window = pd.Series(indication).rolling(2 * _HALF_WINDOW + 1, center=True, min_periods=1)
        expected = window.median().to_numpy()
    deviation = indication - expected
    center, spread = _robust(deviation)
    usual = _FAR * spread
    if max(center - np.fmin.reduce(deviation), np.fmax.reduce(deviation) - center) <= usual:
        return np.zeros(len(indication), dtype=bool)
    off = np.abs(deviation - center)
    far = np.asarray(off > np.maximum(usual, _FAR_RELATIVE * np.abs(expected)))
    limit = max(usual, _CYCLES)
    odd = np.flatnonzero((off > limit) & ~far)
    if 0 < len(odd) <= _EXCEPTIONS:  # more of them have a cause
        far[odd[_alone(deviation, odd, orders(), limit)]] = True
    return far


def _alone(deviation: Column, odd: NDArray[np.intp], orders: Sequence[Column], limit: float) -> Mask:
    """Whether rows deviate as none of their neighbors does, in whichever order one looks.

    Whatever a cause is a function of, rows alike in it deviate alike: a row that stands alone in
    time, by distance and by temperature is a wild one, also where physics could reach as far.
    """
    alone = np.zeros(len(odd), dtype=bool)
    for i, row in enumerate(odd):
        others = np.delete(deviation, row)
        apart = (np.abs(np.delete(order, row) - order[row]) for order in orders)
        near = (np.argpartition(gap, _HALF_WINDOW)[:_HALF_WINDOW] for gap in apart)
        alone[i] = all(abs(deviation[row] - np.median(others[rows])) > limit for rows in near)
    return alone


def far_as_a_whole(far: Mask, stands: Labels) -> Mask:
    """Find the rows of stands that are far for the most part: an error of the stand, no wild rows.

    Parameters
    ----------
    far : ndarray of bool, shape (n,)
    stands : ndarray of int, shape (n,)
        Placement of the target of each row.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    members = np.bincount(stands)
    most = (np.bincount(stands, far) > _AS_A_WHOLE * members) & (members >= _VOUCH)
    return np.asarray(most[stands])


def far_from_stand(indication: Column, stands: Labels, temperature: Column | None) -> Mask:
    """Find rows far from what the same target mostly read: what another echo answered to.

    A last part of the table that is far as a whole is a step, not a lot of wild rows.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    stands : ndarray of int, shape (n,)
        Placement of the target of each row.
    temperature : ndarray, shape (n,), or None
        Air temperature [degC]; tells how much the air could have done.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    none = np.zeros(len(indication), dtype=bool)
    members = np.bincount(stands)
    if np.median(members[members > 0]) < _VOUCH:
        return none
    by_stand = Grouped(stands)
    centers, usual, farthest = by_stand.scatter(indication)
    least = max(_OFF_STAND * _MAD_TO_SD * float(np.nanmedian(usual)), _CYCLES)
    if farthest <= least:
        return none
    off = np.abs(indication - centers[stands])
    limit = np.full(len(indication), least)
    if temperature is not None:
        warming = temperature - by_stand.median(temperature)[stands]
        limit += _PER_KELVIN * np.abs(warming * indication)
    far = (off > limit) & (members[stands] >= _VOUCH)
    first = int(far.argmax())
    is_step = len(far) - first >= _VOUCH and far[first:].mean() > _AS_A_WHOLE
    return none if far.any() and is_step else np.asarray(far)


def level_steps(indication: Column, elapsed: Column | None, temperature: Column | None) -> NDArray[np.int64]:
    """Find rows at which the level jumps: a moved target, not the air.

    A step stands out from how much neighboring medians differ anyhow, so a slow change, however
    large, is none. Across a gap in time the air may change as much as it likes, so there only a
    step that no air can make counts.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    elapsed : ndarray, shape (n,), or None
        Time of each row [s].
    temperature : ndarray, shape (n,), or None
        Air temperature [degC]; tells how much the air could have done across a gap.

    Returns
    -------
    ndarray of int
        First row of each new stretch, ascending.
    """
    size = 2 * _HALF_WINDOW + 1
    if len(indication) < 4 * size:
        return np.empty(0, dtype=np.int64)
    jump = _jumps(indication, size)
    height = np.where(np.isnan(jump), 0.0, np.abs(jump))
    warming = np.full(len(jump), 100.0) if temperature is None else np.abs(_jumps(temperature, size))
    air = np.abs(indication) * (_ANYHOW + _PER_KELVIN * warming)
    for gap in np.flatnonzero(_gaps(elapsed)).tolist() if elapsed is not None else ():
        near = slice(max(0, gap - size), gap + size)
        height[near] = np.where(height[near] > air[near], height[near], 0.0)
    quiet = ~np.isnan(jump)  # and away from steps, which must not widen what is usual
    steps: list[int] = []
    while quiet.any() and (usual := _robust(jump[quiet])[1]) > 0.0:
        clear = height > usual * np.where(height > air, _STEP_OF_NO_AIR, _STEP)
        if not clear.any():
            break
        row = _sharpest(indication, int((height * clear).argmax()), size)
        steps.append(row)
        height[max(0, row - 2 * size) : row + 2 * size] = 0.0
        quiet[max(0, row - size) : row + size] = False
    return np.array(sorted(steps), dtype=np.int64)


def _jumps(values: Column, size: int) -> Column:
    """Median of the `size` rows from each row on, less that of the rows before it; NaN at the ends."""
    import pandas as pd  # takes long to import

    medians = pd.Series(values).rolling(size).median().to_numpy()
    jumps = np.full(len(values), np.nan)
    jumps[size:-size] = medians[2 * size - 1 : -1] - medians[size - 1 : -size - 1]
    return jumps


def _sharpest(indication: Column, near: int, size: int) -> int:
    """Place a step between the two rows near `near` that split the window best."""
    first = max(1, near - size)
    rows = range(first, min(len(indication) - 1, near + size))
    low, high = max(0, near - 2 * size), near + 2 * size

    def cost(row: int) -> float:
        left, right = indication[low:row], indication[row:high]
        spread = np.abs(left - np.median(left)).sum() + np.abs(right - np.median(right)).sum()
        return float(spread)

    return min(rows, key=cost)


def series_starts(elapsed: Column | None, breaks: Mask) -> Mask:
    """Find rows whose noise owes nothing to the row before: after a gap or a break."""
    starts = breaks.copy()
    starts[:1] = True
    return starts if elapsed is None else starts | _gaps(elapsed)


def _gaps(elapsed: Column) -> Mask:
    """Rows before which time stands still for long, or runs backward."""
    gaps = np.zeros(len(elapsed), dtype=bool)
    if len(elapsed) < 2:
        return gaps
    wait = np.diff(elapsed)
    usual = median(wait) if np.isfinite(wait).all() else float(np.nanmedian(wait))
    if usual > 0:
        gaps[1:] = ~((wait >= 0) & (wait <= _GAP * usual))
    return gaps
