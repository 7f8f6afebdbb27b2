"""The voltage before the comparator: echoes over all paths, the burst on the board, and noise."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.sensor import Comparator, Sensor

Labels = NDArray[np.int64]

_SLACK = 0.85  # of the threshold: the height of a crest is known to 2 % before it is looked at closely
_PIECES = 4  # of the half period before a crest: a straight line in each is true to 1e-4 of the amplitude
_HALVINGS = 11  # of such a piece: 1.5 ns at 40 kHz

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]

_EDGES = 200  # of the stretches in which the threshold counts as constant, 3 % of the time each
_NEVER = 1e-9  # expected crossings
HEARD = 6e-3  # s, after which a burst has died away: exp(-pi f t / Q) is 1e-11 at 40 kHz and a quality of 30


@dataclass(frozen=True)
class Noise:
    """Band-limited noise: random phasors every half period, turned into each other between.

    The last resonance of the chain, taken twice and tuned to the carrier, shapes it.
    """

    start: Column  # time of the first value since the burst began [s]; shape (n,)
    step: float  # [s]
    values: Phasor  # envelope beside the carrier; shape (n, k)
    angle: float  # its cosine is the correlation of a value with the next one [rad]

    @classmethod
    def draw(cls, sensor: Sensor, start: Column, count: int, random: np.random.Generator) -> Self:
        """Draw so many values from a time on."""
        step, keep, angle = cls._kept(sensor)
        white = random.normal(size=(2, len(start), count))
        before = random.normal(size=(2, len(start), 2))
        scale = sensor.noise * np.sqrt((1 - keep**2) ** 3 / (1 + keep**2))
        # The two values before the first one, as correlated as any: the noise is stationary at once.
        last = sensor.noise * before[..., :1]
        second = np.cos(angle) * last + np.sin(angle) * sensor.noise * before[..., 1:]
        state = np.concatenate([2 * keep * last - keep**2 * second, -(keep**2) * last], axis=-1)
        colored, _ = lfilter([1.0], [1.0, -2 * keep, keep**2], scale * white, zi=state)
        return cls(start, step, colored[0] + 1j * colored[1], angle)

    @staticmethod
    def _kept(sensor: Sensor) -> tuple[float, float, float]:
        """Step [s], what a pole keeps of a value to the next, and the angle between the two."""
        step = 0.5 / sensor.frequency
        keep = float(np.exp(-np.pi * sensor.frequency / sensor.chain[-1].quality * step))
        return step, keep, float(np.arccos(2 * keep / (1 + keep**2)))

    @classmethod
    def rate(cls, sensor: Sensor) -> float:
        """How often a second the noise rises through zero: its rate through `u` is that times exp(-u^2 / 2).

        `u` is in standard deviations. Rice 1945, doi:10.1002/j.1538-7305.1945.tb00453.x, eq. (3.3-11): the
        carrier turns, and so do the phasors.
        """
        step, _, angle = cls._kept(sensor)
        return float(np.hypot(sensor.frequency, angle / (2 * np.pi * step)))

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return that of some rows."""
        return replace(self, start=self.start[rows], values=self.values[rows])

    def envelope(self, elapsed: Column) -> Phasor:
        """Compute it at times since the burst began, shape (n, ...).

        The weights are those of a turn, not of a straight line, so that the variance is the same everywhere.
        """
        shape = (slice(None), *(None,) * (elapsed.ndim - 1))
        place = np.clip((elapsed - self.start[shape]) / self.step, 0.0, self.values.shape[1] - 1.000001)
        left = place.astype(np.int64)
        part, rows = (place - left) * self.angle, np.arange(len(elapsed))[shape]
        here, there = np.sin(self.angle - part), np.sin(part)
        return np.asarray(
            (self.values[rows, left] * here + self.values[rows, left + 1] * there) / np.sin(self.angle)
        )


class NoiseAlone:
    """When the noise crosses the threshold where nobody searches: seldom, and at random.

    The first such crossing is at `time`, shape (n,) [s]; NaN: none before the time-out.
    """

    def __init__(self, sensor: Sensor, count: int, random: np.random.Generator) -> None:
        """Draw for so many readings."""
        comparator = sensor.comparator
        edges = np.geomspace(max(comparator.blanking, 1e-6), sensor.timeout, _EDGES)
        steps = [until for until, _ in comparator.steps if edges[0] < until < sensor.timeout]
        self._edges = np.union1d(edges, steps)
        middle = 0.5 * (self._edges[1:] + self._edges[:-1])
        rate = Noise.rate(sensor)
        lasts = np.cos(np.pi * rate * comparator.response_time)  # a crest must be as much higher
        height = np.minimum(comparator.at(middle) / (lasts * max(sensor.noise, 1e-30)), 38.0)
        rate = rate * np.exp(-0.5 * height**2)
        self._expected = np.concatenate([[0.0], np.cumsum(rate * np.diff(self._edges))])
        self._drawn = random.exponential(size=count)
        self.time = self._times(self._drawn)

    def _times(self, drawn: Column) -> Column:
        return np.where(drawn < self._expected[-1], np.interp(drawn, self._expected, self._edges), np.nan)

    def skip(self, rows: NDArray[np.int64], begin: Column, end: Column) -> None:
        """Take a stretch out, in which somebody searches, before the crossings that are still to come."""
        if self._expected[-1] > _NEVER:
            count = np.interp([begin, end], self._edges, self._expected)
            self._drawn[rows] += count[1] - count[0]
            self.time[rows] = self._times(self._drawn[rows])


@dataclass(frozen=True)
class Received:
    """All that arrives after a burst: `Re[phasor(t) exp(2 pi i f t)]`."""

    response: BurstResponse  # the burst behind all resonances
    delays: Column  # of the paths [s]; infinite where a reading has fewer; shape (n, p)
    sizes: Phasor  # of their echoes; shape (n, p)
    noise: Noise | None = None

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return that of some rows."""
        noise = None if self.noise is None else self.noise.at(rows)
        return replace(
            self,
            response=self.response.at(rows),
            delays=self.delays[rows],
            sizes=self.sizes[rows],
            noise=noise,
        )

    def phasor(self, elapsed: Column) -> Phasor:
        """Compute the envelope beside the carrier at times since the burst began, shape (n, ...)."""
        total = self._echoes(elapsed)
        return total if self.noise is None else total + self.noise.envelope(elapsed)

    def on_grid(self, start: Column, step: float, count: int) -> Phasor:
        """Compute it at so many times from a start on, shape (n, count): faster.

        The noise has its values there: its step and its start are the same.
        """
        total = self._echoes(start[:, None] + step * np.arange(count), step)
        return total if self.noise is None else total + self.noise.values[:, :count]

    def _echoes(self, elapsed: Column, step: float | None = None) -> Phasor:
        omega = 2 * np.pi * self.response.frequency
        shape = (slice(None), *(None,) * (elapsed.ndim - 1))
        total = np.zeros(elapsed.shape, dtype=complex)
        for path in range(self.delays.shape[1]):
            since = elapsed - self.delays[:, path][shape]
            inside = (since > 0) & (since < HEARD)
            heard = np.flatnonzero(inside.any(axis=tuple(range(1, since.ndim))))
            if len(heard) == 0:
                continue
            some = slice(None) if len(heard) == len(since) else heard
            size = self.sizes[some, path] * np.exp(-1j * omega * self.delays[some, path])
            response = self.response if isinstance(some, slice) else self.response.at(heard)
            total[some] += size[shape] * response.envelope(since[some], step)
        return total

    def voltage(self, elapsed: Column) -> Column:
        """Compute the voltage at times since the burst began, shape (n, ...)."""
        turning = np.exp(2j * np.pi * self.response.frequency * elapsed)
        return np.asarray((self.phasor(elapsed) * turning).real)


def first_crossing(received: Received, start: Column, cycles: int, comparator: Comparator) -> Column:
    """Find the first time at which the voltage is above the threshold in a window.

    The window is searched half period by half period, on whose ends the noise has its values. Crests that
    may be high enough are looked at closely, one after the other. `start`, shape (n,), is that of the window
    since the burst began, and so is the result [s]: NaN where nothing crosses. A voltage that is above the
    threshold at the start crosses there. The output tells it later, by the comparator's response time, and
    only if the voltage is above the threshold for as long.
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
