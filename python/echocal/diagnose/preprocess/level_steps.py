"""Steps of an unknown level, which divide the rows into segments."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.outliers import robust
from echocal.diagnose.preprocess.segments import gaps
from echocal.diagnose.settings.rows import RowSettings

__all__ = ["level_steps"]

Column = NDArray[np.float64]


def level_steps(
    indication: Column, elapsed: Column | None, temperature: Column | None, settings: RowSettings
) -> NDArray[np.int64]:
    """Find rows at which the level changes in a step, because the target moved.

    A step is large compared with the usual difference of neighboring medians. A slow change is
    not a step, even if it is large. Across a gap in time the air may change by any amount that is
    physically possible, so only a larger step counts there.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    elapsed : ndarray, shape (n,), or None
        Time of each row [s].
    temperature : ndarray, shape (n,), or None
        Air temperature [degC]; limits the possible change by the air across a gap.

    Returns
    -------
    ndarray of int
        First row of each new segment, ascending.
    """
    size = 2 * settings.half_window + 1
    if len(indication) < 4 * size:
        return np.empty(0, dtype=np.int64)
    jump = _jumps(indication, size)
    height = np.where(np.isnan(jump), 0.0, np.abs(jump))
    warming = np.full(len(jump), 100.0) if temperature is None else np.abs(_jumps(temperature, size))
    air = np.abs(indication) * (settings.air_anyhow + settings.per_kelvin * warming)
    for gap in np.flatnonzero(gaps(elapsed, settings.gap)).tolist() if elapsed is not None else ():
        near = slice(max(0, gap - size), gap + size)
        height[near] = np.where(height[near] > air[near], height[near], 0.0)
    quiet = ~np.isnan(jump)  # and not near a step, which must not widen the usual difference
    steps: list[int] = []
    while quiet.any() and (usual := robust(jump[quiet])[1]) > 0.0:
        limit = np.where(height > air, settings.level_step_of_no_air, settings.level_step)
        clear = height > usual * limit
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
