"""When the voltage first exceeds the threshold: crest by crest, then exactly within the cycle."""

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench.waveform.received import Received
from echocal.virtual_bench.waveform.sensor import Comparator

__all__ = ["first_crossing"]

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]
Labels = NDArray[np.int64]

_SLACK = 0.85  # of the threshold: the height of a crest is known to 2 % before it is looked at closely
_PIECES = 4  # of the half period before a crest: a straight line in each is true to 1e-4 of the amplitude
_HALVINGS = 11  # of such a piece: 1.5 ns at 40 kHz


def first_crossing(received: Received, start: Column, cycles: int, comparator: Comparator) -> Column:
    """Find the first time at which the voltage is above the threshold in a window.

    The window is searched half period by half period, on whose ends the noise has its values. Crests that
    may be high enough are looked at closely, one after the other.

    Parameters
    ----------
    received : Received
        Of n readings.
    start : ndarray, shape (n,)
        Of the window, since the burst began [s].
    cycles : int
        Of the window.
    comparator : Comparator

    Returns
    -------
    ndarray, shape (n,)
        Since the burst began [s], NaN where nothing crosses. A voltage that is above the threshold at the
        start crosses there. The output tells it later, by the comparator's response time, and only if the
        voltage is above the threshold for as long.
    """
    omega = 2 * np.pi * received.response.frequency
    ends = start[:, None] + np.arange(2 * cycles + 1) * np.pi / omega
    phasors = received.on_grid(start, np.pi / omega, 2 * cycles + 1)
    # The carrier turns by half a turn from end to end.
    turned = phasors * np.exp(1j * omega * start)[:, None]
    turned[:, 1::2] *= -1
    found = np.where(turned[:, 0].real > comparator.at(start), start, np.nan)
    found = _lasting(found, received, comparator)
    above = _candidates(turned, ends, omega, comparator)
    rows = np.flatnonzero(above.any(axis=1) & np.isnan(found))
    while len(rows):
        at = above[rows].argmax(axis=1)
        crest = _crest(ends[rows, at], phasors[rows, at], phasors[rows, at + 1], omega)
        found[rows] = _rising(crest, ends[rows, at], start[rows], received.at(rows), comparator)
        above[rows, at] = False
        rows = rows[np.isnan(found[rows]) & above[rows].any(axis=1)]
    # The crest of a voltage that is above the threshold at the end may come after the end.
    rows = np.flatnonzero(np.isnan(found) & (turned[:, -1].real > comparator.at(ends[:, -1])))
    found[rows] = _rising(ends[rows, -1], ends[rows, -2], start[rows], received.at(rows), comparator)
    return _stepped(found, ends[:, 0], ends[:, -1], received, comparator) + comparator.response_time


def _lasting(found: Column, received: Received, comparator: Comparator) -> Column:
    """Those crossings after which the voltage stays above the threshold until the output has answered.

    A crest that is above a steady threshold at two times is above it between them. Where the threshold steps
    between them, the crest must be above it on both sides of the step.
    """
    rows = np.flatnonzero(~np.isnan(found))
    if len(rows) and comparator.response_time:
        here, since = received.at(rows), found[rows]
        later = since + comparator.response_time
        stays = here.voltage(later) > comparator.at(later)
        for until, _ in comparator.steps:
            threshold = comparator.at(np.array([np.nextafter(until, 0.0), until])).max()
            above = here.voltage(np.full(len(rows), until)) > threshold
            stays &= above | (until <= since) | (later < until)
        found[rows[~stays]] = np.nan
    return found


def _stepped(found: Column, start: Column, end: Column, received: Received, comparator: Comparator) -> Column:
    """Crossings where the threshold steps below a voltage, in the middle of a cycle."""
    for until, _ in comparator.steps:
        rows = np.flatnonzero((start < until) & (until < end) & ~(found < until))
        if len(rows):
            here = received.at(rows)
            at_once = here.voltage(np.full(len(rows), until)) > comparator.at(np.array(until))
            stepped = _lasting(np.where(at_once, until, np.nan), here, comparator)
            found[rows] = np.fmin(found[rows], stepped)
    return found


def _candidates(turned: Phasor, ends: Column, omega: float, comparator: Comparator) -> NDArray[np.bool_]:
    """Half periods with a crest that may be above the threshold, shape (n, 2 cycles)."""
    first, last = turned[:, :-1], turned[:, 1:]
    # The slope of the voltage is that of the carrier and that of the amplitude: it must fall from end to end.
    growth = (first + last) / np.pi
    falls, rises = -first.imag - growth.real, last.imag - growth.real
    ahead = first.real - growth.imag
    part = 0.5 - 0.5 * ahead / np.maximum(np.abs(ahead) + np.abs(falls), 1e-300)  # of half a turn, to 0.02
    high = np.abs((1 - part) * first - part * last)
    near = 0.3 * high  # a crest on an end is looked at from both sides
    threshold = comparator.at(ends)
    wide = np.cos(0.5 * omega * comparator.response_time)  # of a crest that lasts for so long
    enough = wide * high > _SLACK * np.minimum(threshold[:, :-1], threshold[:, 1:])
    return np.asarray(enough & (falls > -near) & (rises > -near))


def _crest(time: Column, first: Phasor, last: Phasor, omega: float) -> Column:
    """Time of the crest in the half period after a time, whose phasor changes in a straight line."""
    slope = (last - first) * omega / np.pi
    lead = 1j * slope / omega  # a growing amplitude crests later than its carrier
    found = time + np.mod(-np.angle((first - lead) * np.exp(1j * omega * time)) + 0.5, 2 * np.pi) / omega
    found -= 0.5 / omega
    for _ in range(2):
        phasor = first + slope * (found - time) - lead
        found = found - np.angle(phasor * np.exp(1j * omega * found)) / omega
    return np.asarray(found)


def _rising(top: Column, bend: Column, start: Column, received: Received, comparator: Comparator) -> Column:
    """Crossings that last, in the half period up to a top, shape (n,); NaN where there is none.

    The slope of the noise changes at a bend: no piece goes across it.
    """
    omega = 2 * np.pi * received.response.frequency
    times = top[:, None] + np.linspace(-np.pi / omega, 0.0, _PIECES + 1)
    times = np.sort(np.column_stack([times, np.minimum(bend, top)]))
    times = np.maximum(times, start[:, None])
    return _lasting(_between(times, received.phasor(times), omega, comparator), received, comparator)


def _between(times: Column, phasors: Phasor, omega: float, comparator: Comparator) -> Column:
    """First crossing on the pieces up to a crest, shape (n,); NaN where the crest is below."""
    above = (phasors * np.exp(1j * omega * times)).real > comparator.at(times)
    rows, at = np.arange(len(times)), np.maximum(above.argmax(axis=1), 1)
    low, high = times[rows, at - 1], times[rows, at]
    first, origin = phasors[rows, at - 1], low
    slope = (phasors[rows, at] - first) / np.maximum(high - low, 1e-12)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        voltage = ((first + slope * (middle - origin)) * np.exp(1j * omega * middle)).real
        over = voltage > comparator.at(middle)
        high = np.where(over, middle, high)
        low = np.where(over, low, middle)
    return np.where(above.any(axis=1), high, np.nan)
