"""Series: consecutive rows whose noise may be autocorrelated."""

import numpy as np
from numpy.typing import NDArray

from echocal.observations.quantiles import median

__all__ = ["gaps", "series_starts"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]


def series_starts(elapsed: Column | None, breaks: Mask, gap: float) -> Mask:
    """Find the first rows of series: those after a gap in time or a break."""
    starts = breaks.copy()
    starts[:1] = True
    return starts if elapsed is None else starts | gaps(elapsed, gap)


def gaps(elapsed: Column, longest: float) -> Mask:
    """Rows before which the time has a gap of so many usual intervals, or decreases."""
    late = np.zeros(len(elapsed), dtype=bool)
    if len(elapsed) < 2:
        return late
    wait = np.diff(elapsed)
    usual = median(wait) if np.isfinite(wait).all() else float(np.nanmedian(wait))
    if usual > 0:
        late[1:] = ~((wait >= 0) & (wait <= longest * usual))
    return late
