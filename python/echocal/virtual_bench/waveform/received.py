"""The voltage before the comparator: echoes over all paths, the burst on the board, and noise."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.sensor import Sensor

__all__ = ["HEARD", "Noise", "NoiseAlone", "Received"]

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]

_EDGES = 200  # of the stretches in which the threshold counts as constant, 3 % of the time each
_NEVER = 1e-9  # expected crossings
HEARD = 6e-3  # s, after which a burst has died away: exp(-pi f t / Q) is 1e-11 at 40 kHz and a quality of 30


@dataclass(frozen=True)
class Noise:
    """Band-limited noise: random phasors every half period, turned into each other between.

    The last resonance of the chain, taken twice and tuned to the carrier, shapes it.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Time of the first value since the burst began [s].
    step : float
        [s].
    values : ndarray of complex, shape (n, k)
        Envelope beside the carrier.
    angle : float
        Its cosine is the correlation of a value with the next one [rad].
    """

    start: Column
    step: float
    values: Phasor
    angle: float

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

    Attributes
    ----------
    time : ndarray, shape (n,)
        Of the first such crossing [s]; NaN: none before the time-out.
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
    """All that arrives after a burst: `Re[phasor(t) exp(2 pi i f t)]`.

    Attributes
    ----------
    response : BurstResponse
        The burst behind all resonances.
    delays : ndarray, shape (n, p)
        Of the paths [s]; infinite where a reading has fewer.
    sizes : ndarray of complex, shape (n, p)
        Of their echoes.
    noise : Noise or None
    """

    response: BurstResponse
    delays: Column
    sizes: Phasor
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
