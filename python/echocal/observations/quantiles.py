"""Quantiles of long columns: numpy's, three times as fast.

`numpy.median` asks for two places and for the end, where NaN would stand, and its partition is
fastest for one place alone; the neighbor of that place is the extreme of the rest.
"""

from collections.abc import Sequence

import numpy as np

from echocal.arrays import Column, Labels

MAD_TO_SD = 1.4826
"""Standard deviation over median absolute deviation, of a normal distribution: 1 / Phi^-1(3/4)."""

_ENOUGH = 100_000  # rows that a mean, a line or a quantile is taken over
_RUN = 97  # rows that follow each other among those: a prime, so that no period of a table is missed
_LARGE = 1000  # rows of a group that are worth a partition of their own


def spread(values: Column) -> Column:
    """Numbers of a column; of very many, those of evenly spread runs.

    Examples
    --------
    >>> import numpy as np
    >>> len(spread(np.zeros(100_000))), len(spread(np.zeros(1_000_000)))
    (100000, 99910)
    """
    skip = -(-len(values) // _ENOUGH)
    if skip <= 1:
        return values
    runs = values[: len(values) // (_RUN * skip) * _RUN * skip].reshape(-1, _RUN * skip)
    return np.ascontiguousarray(runs[:, :_RUN]).ravel()


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
    found, ordered, known = [], values.copy(), 0  # so many numbers are the smallest
    for part in parts:
        at = part * (len(values) - 1)
        place = min(int(at), max(len(values) - 2, 0))
        known = known if known <= place else 0
        ordered[known:].partition(place - known)
        known = place
        low = float(ordered[place])
        high = float(ordered[place + 1 :].min()) if place + 1 < len(values) else low
        rest = at - place
        # from the nearer end, as numpy does
        found.append(low + (high - low) * rest if rest < 0.5 else high - (high - low) * (1 - rest))
    return found


class Grouped:
    """Medians of groups of rows, which are numbered from 0 on.

    Examples
    --------
    >>> import numpy as np
    >>> Grouped(np.array([0, 1, 0, 1, 0])).median(np.array([1.0, 5.0, 3.0, 7.0, 2.0])).tolist()
    [2.0, 6.0]
    """

    def __init__(self, labels: Labels) -> None:
        self._labels = labels
        self._members = np.bincount(labels)
        self._order: Labels | None = None
        groups = len(self._members)
        if groups * _LARGE < len(labels) and groups < 1 << 16:
            self._order = np.argsort(labels.astype(np.uint16), kind="stable")  # 16 bits: by radix

    def median(self, values: Column) -> Column:
        """Median of each group's values that are not NaN, shape (groups,); NaN where there are none."""
        medians = _medians(self._parts(values))
        if len(medians) and not np.isnan(medians).any():
            return medians
        import pandas as pd  # takes long to import

        found = pd.Series(values).groupby(self._labels).median()
        return np.asarray(found.reindex(range(len(self._members))), dtype=np.float64)

    def scatter(self, values: Column) -> tuple[Column, Column, float]:
        """Median of each group, how far its values are from it in the median, and the farthest of all.

        Examples
        --------
        >>> import numpy as np
        >>> centers, usual, farthest = Grouped(np.array([0, 1, 0, 1, 0])).scatter(
        ...     np.array([1.0, 5.0, 3.0, 7.0, 2.0])
        ... )
        >>> centers.tolist(), usual.tolist(), farthest
        ([2.0, 6.0], [1.0, 1.0], 1.0)
        """
        parts = self._parts(values)
        centers = _medians(parts)
        if not parts or np.isnan(centers).any():
            centers = self.median(values)
            off = np.abs(values - centers[self._labels])
            return centers, self.median(off), float(np.fmax.reduce(off))
        apart = [np.abs(part - center) for part, center in zip(parts, centers, strict=True)]
        return centers, _medians(apart), max(float(off.max()) for off in apart)

    def _parts(self, values: Column) -> list[Column]:
        """Values of each group, where these are few; else nothing."""
        if self._order is None:
            return []
        return np.split(values[self._order], np.cumsum(self._members)[:-1])


def _medians(parts: Sequence[Column]) -> Column:
    return np.array([median(part) if len(part) else np.nan for part in parts])
