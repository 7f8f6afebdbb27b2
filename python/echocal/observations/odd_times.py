"""Times that a clock gives which was not set, was set anew, stood still, or counts in another unit."""

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.clock import Instants
from echocal.observations.fields import row, rows, span
from echocal.observations.plan import Assignment

__all__ = ["not_set", "refuse_other_clock", "said_of_order"]

Column = NDArray[np.float64]

_FIRST = np.datetime64("1990-01-01", "ns")  # clocks that were not set begin in 1970 or 1980
_SURE = np.datetime64("2000-01-01", "ns")

_LONGEST = 5e9  # s: since 1970 it is the year 2128
_SHORTEST = 1e-3  # s: sound comes back from 17 cm in this time, and a ranger waits for its echo
_FEWEST = 5  # steps
_OFTEN = 3600.0  # s: people who log less often choose whole half hours, hours or days
_NEAR = 0.04  # of these: the clock of a sleeping device is off by some percent
_ROUND = ((6 * 3600.0, 1800.0), (0.97 * 86400.0, 3600.0), (np.inf, 86400.0))
"""Steps below which a person chooses multiples of which time [s]."""

_EVEN = 0.25  # of a step: half of the steps lie within it

_USUAL = (2e-3, 7 * 86400.0)  # s: steps in another unit that are offered


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


def refuse_other_clock(seconds: Column, source: Assignment) -> None:
    """Refuse a count of time whose steps make sense only in another unit.

    A program that counts milliseconds or microseconds makes whole numbers with nearly even steps. Taken for
    seconds, they are hours that are no multiples of half an hour, an hour or a day. Raises `DataError` if
    they are.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Times in the unit that the column's name says [s].
    """
    known = seconds[np.isfinite(seconds)]
    steps = np.abs(np.diff(known))
    steps = steps[steps > 0.0]
    own = source.unit.numerator / source.unit.denominator
    if len(steps) < _FEWEST or (_is_usual(steps, own) and np.abs(known).max() < _LONGEST):
        return
    step = float(np.median(steps))
    units = {
        f"{source.form.role}_{n}": u.numerator / u.denominator for n, u in source.form.units.items() if n
    }
    others = {
        name: step * unit / own
        for name, unit in units.items()
        if (unit < own) == (step >= _SHORTEST) and unit != own
        if _USUAL[0] <= step * unit / own <= _USUAL[1] and np.abs(known).max() * unit / own < _LONGEST
    }
    told = "; ".join(
        f"as {name} a row each {span(time)}" for name, time in {source.name: step, **others}.items()
    )
    ways = [keyword("columns", {source.column: name}) for name in others]
    message = (
        f"column '{source.column}' has usual steps of {step / own:.6g}: {told}. Say which it is: "
        f"{', '.join([*ways, 'or if it is right as it stands'])}: {keyword('trust', [source.column])}"
    )
    raise DataError(message)


def _is_usual(steps: Column, unit: float) -> bool:
    """Whether steps [s] of a count in a unit [s] may be those of a logger."""
    middle = float(np.median(steps))
    if middle < _OFTEN:
        return middle >= _SHORTEST
    counts = steps / unit
    low, high = np.quantile(counts, [0.25, 0.75])
    even = high - low <= _EVEN * middle / unit and np.allclose(counts, np.round(counts), rtol=0.0, atol=1e-6)
    choice = next(multiple for below, multiple in _ROUND if middle < below)
    near = np.abs(steps / choice - np.round(steps / choice)) <= _NEAR
    # equal steps without any jitter may be computed; then only a round count, or a huge one, is of a program
    computed = np.ptp(counts) <= 1e-6 and middle < _USUAL[1] and float(f"{counts[0]:.2g}") != round(counts[0])
    return bool(not even or near.mean() >= 0.5 or computed)
