"""When the voltage first exceeds the threshold: crest by crest, then exactly within the cycle."""

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench.waveform.received import Received
from echocal.virtual_bench.waveform.sensor import Comparator

__all__ = ["first_crossing"]

Column = NDArray[np.float64]

_HALVINGS = 13  # of half a period: 1.5 ns at 40 kHz


def first_crossing(received: Received, start: Column, cycles: int, comparator: Comparator) -> Column:
    """Find the first time at which the voltage rises above the threshold in a window.

    Within a period the envelope is nearly a straight line: over half a period of 40 kHz its bend is 1e-3 of
    the amplitude behind resonances of quality 20, which is 3 ns. So each crest is found from the ends of its
    period, and the crossing before it from those of half a period.

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
        Since the burst began [s], NaN where nothing crosses.
    """
    omega = 2 * np.pi * received.response.frequency
    crests, heights = _crests(received, start, cycles)
    above = (heights > comparator.at(crests)) & (crests > comparator.blanking)
    found = np.full(len(start), np.nan)
    rows = np.flatnonzero(above.any(axis=1))
    while len(rows):
        at = above[rows].argmax(axis=1)
        some = received.at(rows)
        crest = crests[rows, at]
        crest = crest - np.angle(some.phasor(crest) * np.exp(1j * omega * crest)) / omega
        low = np.maximum(crest - np.pi / omega, comparator.blanking)
        ends = np.stack([low, crest], axis=1)
        crossed = _between(ends, some.phasor(ends), omega, comparator)
        found[rows] = crossed
        above[rows, at] = False
        rows = rows[np.isnan(crossed) & above[rows].any(axis=1)]
    return found


def _crests(received: Received, start: Column, cycles: int) -> tuple[Column, Column]:
    """Times [s] and heights of the crests, one a period, shape (n, cycles)."""
    frequency = received.response.frequency
    ends = start[:, None] + np.arange(cycles + 1) / frequency
    turned = received.phasor(ends) * np.exp(2j * np.pi * frequency * start)[:, None]
    first, last = turned[:, :-1], turned[:, 1:]
    part = np.mod(-np.angle(first), 2 * np.pi) / (2 * np.pi)
    between = first + part * (last - first)
    return ends[:, :-1] + part / frequency, np.abs(between)


def _between(ends: Column, phasors: NDArray[np.complex128], omega: float, comparator: Comparator) -> Column:
    """Halve the time between a trough, or the end of the blanking, and a crest; NaN where that is below."""
    low, high = ends[:, 0].copy(), ends[:, 1].copy()
    origin, slope = low.copy(), (phasors[:, 1] - phasors[:, 0]) / np.maximum(high - low, 1e-12)

    def above(time: Column) -> NDArray[np.bool_]:
        turned = (phasors[:, 0] + slope * (time - origin)) * np.exp(1j * omega * time)
        return np.asarray(turned.real > comparator.at(time))

    reached = above(high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        over = above(middle)
        high = np.where(over, middle, high)
        low = np.where(over, low, middle)
    return np.where(reached, high, np.nan)
