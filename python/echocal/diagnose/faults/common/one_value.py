"""Far rows with about one value: a constant of the device, echoes of one thing, or wild."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import finest, log_choices, log_constant
from echocal.diagnose.faults.common.values import expected_everywhere, far, limit_of, recorded
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["OneValue", "one_value"]

Column = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OneValue:
    """The most far rows with about one value, and how probable each kind makes them: Eq. 31b.

    Attributes
    ----------
    rows : ndarray of int, shape (k,)
    expected : ndarray, shape (k,)
        What they should read [m].
    longest : float
        Of the readings of other rows [m].
    others : int
        Other far rows.
    as_constant, as_echoes, as_wild : float
        Log density of the values; of the first two without that of the level itself.
    as_frozen : float
        The same, if each stretch of these rows repeats the good reading before it.
    """

    rows: NDArray[np.int64]
    expected: Column
    longest: float
    others: int
    as_constant: float
    as_echoes: float
    as_wild: float
    as_frozen: float


def one_value(
    view: View, among: NDArray[np.bool_], values: Column, settings: FaultSettings, reason: str
) -> OneValue | None:
    """Find the value that most of these far rows have; docs/method/faults.md, Eq. 31b.

    Parameters
    ----------
    view : View
    among : ndarray of bool, shape (n,)
        Far rows.
    values : ndarray, shape (n,)
        Positive in these rows.
    settings : FaultSettings
    reason : str
        Why the rows are left out.
    """
    if not among.any():
        return None
    window = settings.constant.window
    logs = np.log(np.where(values > 0, values, np.nan))
    ordered = np.sort(logs[among])
    ends = np.searchsorted(ordered, ordered + window, side="right")
    first = int((ends - np.arange(len(ordered))).argmax())
    inside = view.good & (np.abs(logs - np.median(ordered[first : ends[first]])) <= window)
    rest = view.after(view.without(inside, reason))
    if not rest.good.any():
        return None
    expected = view.expected if view.known else expected_everywhere(rest)
    limit = limit_of(rest.scatter, expected, settings.far)
    rows = np.flatnonzero(inside & (np.abs(view.indication - expected) > limit))
    if not len(rows):
        return None
    place, least = view.indication[rows], finest(view.indication[rows], view.resolution)
    off = np.abs(place - expected[rows])
    good = rest.indication[rest.good]
    slow = 0.0 if view.known else MAD_TO_SD * float(np.median(np.abs(good - np.median(good))))
    half = 0.5 * float(np.log(max(slow / rest.scatter, 1.0)))  # of the way from scatter to slow changes
    spread = float(np.hypot(settings.constant.of_echoes, half))
    jitter = rest.scatter * np.exp(half) / float(np.median(place)), spread
    orders = np.maximum(np.log(off / limit[rows]), 1.0)
    return OneValue(
        rows,
        expected[rows],
        float(good.max()),
        int(far(rest, settings.far).sum()),
        log_constant(values[rows], least, settings.constant),
        log_constant(values[rows], least, settings.constant, jitter),
        float(np.log(0.5 / settings.constant.range + 0.5 * place / (2 * off * orders)).sum()),
        _as_frozen(view, rows, least, settings),
    )


def _as_frozen(view: View, rows: NDArray[np.int64], least: float, settings: FaultSettings) -> float:
    """Log density of values that repeat a good row before them exactly: docs/method/faults.md, Eq. 31d."""
    good = np.flatnonzero(view.good)
    concerned, new = np.isin(good, rows), np.diff(recorded(view)[good], prepend=np.nan) != 0
    run = np.cumsum(new)
    frozen = np.unique(run[concerned])
    if (concerned & new).any():  # a run that begins with such a row repeats none
        return -np.inf
    any_level = float(np.log(least * np.sqrt(2 * np.pi / len(rows))))  # but here the level is known
    as_one_value = log_constant(recorded(view)[rows], least, settings.constant) - any_level
    return as_one_value - log_choices(len(frozen), len(good))
