"""Times that a clock gives which was not set, was set anew, or stood still."""

import numpy as np
from numpy.typing import NDArray

from echocal.observations.clock import Instants
from echocal.observations.fields import row, rows
from echocal.observations.plan import Assignment

__all__ = ["not_set", "said_of_order"]

Column = NDArray[np.float64]

_FIRST = np.datetime64("1990-01-01", "ns")  # clocks that were not set begin in 1970 or 1980
_SURE = np.datetime64("2000-01-01", "ns")


def not_set(times: Instants) -> NDArray[np.bool_]:
    """Rows before 1990 in a table most of whose rows are from 2000 or later: the clock was not set yet.

    Examples
    --------
    >>> import numpy as np
    >>> not_set(np.array(["1970-01-01", "2024-05-01", "2024-05-02"], dtype="datetime64[ns]")).tolist()
    [True, False, False]
    """
    early = times < _FIRST
    if early.any() and 2 * int((times >= _SURE).sum()) > int((~np.isnat(times)).sum()):
        return np.asarray(early)
    return np.zeros(len(times), dtype=np.bool_)


def said_of_order(elapsed: Column, source: Assignment, *, bursts: bool) -> list[str]:
    """Sentences on times that go back, and on rows at the time of the row before.

    Parameters
    ----------
    elapsed : ndarray, shape (n,)
        Time of each row [s].
    bursts : bool
        Whether rows belong to bursts, which share a time.
    """
    known = np.flatnonzero(np.isfinite(elapsed))
    steps = np.diff(elapsed[known])
    falling, still = np.flatnonzero(steps < 0.0), np.flatnonzero(steps == 0.0)
    said = []
    if 0 < len(falling) <= int((steps > 0.0).sum()):
        first = falling[0]
        said.append(
            f"{source.column} goes back in {rows(len(falling))}, first at {row(known[first + 1])}, by "
            f"{-steps[first]:g} s: a clock that was set, or parts of a log in another order. The rows stay "
            "in their order"
        )
    if len(still) and not bursts:
        said.append(
            f"{source.column} is that of the row before in {rows(len(still))}, first at "
            f"{row(known[still[0] + 1])}: a clock that stood still, or counts too coarsely"
        )
    return said
