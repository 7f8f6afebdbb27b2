"""Quantiles of long columns: numpy's, three times as fast.

`numpy.median` asks for two places and for the end, where NaN would stand, and its partition is
fastest for one place alone; the neighbor of that place is the extreme of the rest.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["median", "quantiles"]

Column = NDArray[np.float64]


def median(values: Column) -> float:
    """Median, NaN if any of the numbers is; the same as `numpy.median`.

    Examples
    --------
    >>> import numpy as np
    >>> median(np.array([3.0, 1.0, 2.0])), median(np.array([4.0, 1.0, 2.0, 3.0]))
    (2.0, 2.5)
    """
    count = len(values)
    ordered = np.partition(values, count // 2)
    high = float(ordered[count // 2])
    if np.isnan(ordered[count // 2 :].max()):
        return np.nan
    return high if count % 2 else 0.5 * (float(ordered[: count // 2].max()) + high)


def quantiles(values: Column, parts: Sequence[float]) -> list[float]:
    """Quantiles, with linear interpolation, of numbers of which none is NaN; as `numpy.quantile`.

    Examples
    --------
    >>> import numpy as np
    >>> quantiles(np.array([3.0, 0.0, 1.0, 2.0]), [0.0, 0.5, 1.0])
    [0.0, 1.5, 3.0]
    """
    found = []
    for part in parts:
        at = part * (len(values) - 1)
        place = min(int(at), max(len(values) - 2, 0))
        ordered = np.partition(values, place)
        low = float(ordered[place])
        high = float(ordered[place + 1 :].min()) if place + 1 < len(values) else low
        rest = at - place
        # from the nearer end, as numpy does
        found.append(low + (high - low) * rest if rest < 0.5 else high - (high - low) * (1 - rest))
    return found
