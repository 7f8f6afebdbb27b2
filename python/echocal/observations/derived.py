"""Influence quantities that a table derives from its rows, for effects that depend on other rows."""

from collections.abc import Iterator, Mapping

import numpy as np

from echocal.arrays import Column, Labels

_WINDOW = 30.0  # s: what a rate is taken over at least, so that a thermometer's steps are no rates
_LATER = 5  # rows
_TREND = 10  # rows at the end of a table that say how it goes on


def derived(conditions: Mapping[str, Column], labels: Mapping[str, Labels]) -> dict[str, Column]:
    """Derive rates of change, later temperatures and positions in bursts, where the table allows it.

    From recorded influence quantities, codes of ``group`` and values of ``order``. By name of the influence
    quantity; NaN where a row lacks what it is derived from.

    Examples
    --------
    >>> import numpy as np
    >>> seconds = np.array([0.0, 60.0, 120.0])
    >>> found = derived({"elapsed_time": seconds, "temperature": 20 + 0.01 * seconds}, {})
    >>> found["temperature_rate"].round(6).tolist(), found["temperature_later_1"].round(1).tolist()
    ([0.01, 0.01, 0.01], [20.6, 21.2, 21.8])
    """
    found: dict[str, Column] = {}
    elapsed, temperature = conditions.get("elapsed_time"), conditions.get("temperature")
    if elapsed is not None and temperature is not None:
        found["temperature_rate"] = _rate(elapsed, temperature)
        found |= {f"temperature_later_{rows}": later for rows, later in _later(elapsed, temperature)}
    if elapsed is not None and "radiation" in conditions:
        found["radiation_rate"] = _rate(elapsed, conditions["radiation"])
    if "order" in labels or "group" in labels:
        found["position_in_group"] = _position(labels)
    return found


def _rate(elapsed: Column, values: Column) -> Column:
    """Rate of change at each row, from the row before to the row after.

    Over `_WINDOW` if the rows are closer. At either end of the table only half of the window is known.
    """
    rate = np.full(len(values), np.nan)
    half = 0.5 * _WINDOW
    wait = np.diff(elapsed)
    if len(wait) and wait.min() >= half and np.isfinite(values).all() and np.isfinite(elapsed).all():
        # in order and far enough apart: from neighbor to neighbor
        inner = np.subtract(values[2:], values[:-2], out=rate[1:-1])
        inner /= elapsed[2:] - elapsed[:-2]
        rate[0], rate[-1] = (values[1] - values[0]) / wait[0], (values[-1] - values[-2]) / wait[-1]
        return rate
    known = np.flatnonzero(np.isfinite(elapsed) & np.isfinite(values))
    order = known[np.argsort(elapsed[known], kind="stable")]
    time, value = elapsed[order], values[order]
    if len(order):
        early = np.maximum(time - np.maximum(half, np.diff(time, prepend=time[0])), time[0])
        late = np.minimum(time + np.maximum(half, np.diff(time, append=time[-1])), time[-1])
        span = late - early
        rise = np.interp(late, time, value) - np.interp(early, time, value)
        rate[order] = np.divide(rise, span, out=np.zeros_like(rise), where=span > 0)
    return rate


def _later(elapsed: Column, values: Column) -> Iterator[tuple[int, Column]]:
    """Value so many rows later in time; beyond the end, on the straight line of the last rows."""
    in_order = bool(
        np.isfinite(values).all() and (np.diff(elapsed) >= 0.0).all() and np.isfinite(elapsed).all()
    )
    if in_order:
        known = values
    else:
        rows = np.flatnonzero(np.isfinite(elapsed) & np.isfinite(values))
        order = rows[np.argsort(elapsed[rows], kind="stable")]
        known = values[order]
    last = known[-_TREND:]
    beyond = np.full(_LATER, np.nan)
    if len(last):
        ahead = np.arange(len(last), len(last) + _LATER)
        beyond = np.polynomial.Polynomial.fit(np.arange(len(last)), last, min(1, len(last) - 1))(ahead)
    whole = np.append(known, beyond)
    for count in range(1, _LATER + 1):
        moved = whole[count : count + len(known)]
        if not in_order:
            later = np.full(len(values), np.nan)
            later[order] = moved
            moved = later
        yield count, moved


def _position(labels: Mapping[str, Labels]) -> Column:
    """Position in the burst, 0 for the first row: as recorded, else counted from each change of group."""
    order = labels.get("order")
    if order is None:
        group = labels["group"]
        row = np.arange(len(group))
        starts = np.concatenate([[True], np.diff(group) != 0])
        return (row - np.maximum.accumulate(np.where(starts, row, 0))).astype(np.float64)
    recorded = order >= 0
    position = np.where(recorded, order.astype(np.float64), np.nan)
    return position - order[recorded].min() if recorded.any() else position
