"""Readings of a sensor in a scene: what its comparator makes of the waveforms."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.received import HEARD, Noise, NoiseAlone, Received, first_crossing
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Sensor

Column = NDArray[np.float64]

_CHUNK = 2000  # readings at a time: their arrays stay in the cache
_WINDOWS = ((0, 8), (8, 16))  # first period after a beginning, and how many: most cross in the first window
_SIGMAS = 6.0  # of the noise: what is rarer is left to the noise alone


@dataclass(frozen=True)
class Echoes:
    """What a sensor says, a value for each reading.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Length of the ECHO pulse [s], NaN without an echo.
    delay : ndarray, shape (n,)
        From the front of the echo to its detection [s].
    amplitude : ndarray, shape (n,)
        Of the echo of the target, in units of the comparator.
    """

    time: Column
    delay: Column
    amplitude: Column


def measure(
    scene: Scene,
    sensor: Sensor | None = None,
    random: np.random.Generator | None = None,
    threads: int | None = None,
) -> Echoes:
    """Measure all readings of a scene.

    Parameters
    ----------
    scene : Scene
        Of n readings.
    sensor : Sensor, optional
        An HC-SR04 by default.
    random : numpy.random.Generator, optional
        Of noise and bursts. The same generator gives the same readings, whatever the number of threads.
    threads : int, optional
        As many as there are processors by default.

    Returns
    -------
    Echoes

    Examples
    --------
    >>> import numpy as np
    >>> from echocal.virtual_bench import Scene, measure
    >>> echoes = measure(Scene(np.array([0.5, 1.0])), random=np.random.default_rng(1))
    >>> bool((echoes.time > 2.7e-3).all())
    True
    """
    sensor, random = sensor or Sensor(), random or np.random.default_rng()
    parts = [np.arange(first, min(first + _CHUNK, len(scene))) for first in range(0, len(scene), _CHUNK)]
    work = zip(parts, random.spawn(len(parts)), strict=True)
    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        found = list(pool.map(lambda one: _some(scene.at(one[0]), sensor, one[1]), work))
    if not found:
        return Echoes(*[np.zeros(0)] * 3)
    return Echoes(*(np.concatenate(values) for values in zip(*found, strict=True)))


def received(scene: Scene, sensor: Sensor, random: np.random.Generator | None = None) -> Received:
    """Compute what arrives in a scene, without noise; with random numbers no burst is like another."""
    warm = scene.temperature if scene.device_temperature is None else scene.device_temperature
    response = BurstResponse.of(sensor.chain, sensor.frequency, sensor.cycles, warm)
    delays, sizes = scene.paths(sensor)
    if random is not None:
        sizes = sizes * np.exp(sensor.burst_scatter * random.normal(size=(len(scene), 1)))
    return Received(response, delays, sizes)


def _some(scene: Scene, sensor: Sensor, random: np.random.Generator) -> tuple[Column, Column, Column]:
    """Measure few readings."""
    signal = received(scene, sensor, random)
    target = signal.delays[:, 1]
    if sensor.comparator.ideal:
        crossed = target + _jitter(signal, sensor, random)
        risen = 0.0
    else:
        crossed = _crossed(signal, sensor, random)
        risen = sensor.zero
    pulse = np.round(np.maximum(crossed - risen, 0.0) / sensor.tick) * sensor.tick
    pulse[crossed > sensor.timeout] = np.nan
    return pulse, crossed - target, np.abs(signal.sizes[:, 1])


def _crossed(signal: Received, sensor: Sensor, random: np.random.Generator) -> Column:
    """Search from where something begins on: an echo, the listening, a step of the threshold."""
    comparator, period = sensor.comparator, 1 / sensor.frequency
    steps = [until for until, _ in comparator.steps if until > comparator.blanking]
    fixed = np.broadcast_to([comparator.blanking, *steps], (len(signal.delays), 1 + len(steps)))
    begins = np.sort(np.hstack([fixed, np.maximum(signal.delays, comparator.blanking)]), axis=1)
    alone = NoiseAlone(sensor, len(begins), random)
    found, searched, peak = np.full(len(begins), np.nan), np.zeros(len(begins)), signal.response.peak
    for start in begins.T:
        for first, cycles in _WINDOWS:
            begin = np.maximum(start, searched) if first == 0 else searched
            end = begin + cycles * period
            wanted = (begin < sensor.timeout) & np.isnan(found) & ~(alone.time < begin)
            rows = np.flatnonzero(wanted & _loud(signal, peak, begin, end, sensor))
            searched = np.where(wanted, end, searched)
            if len(rows):
                noise = Noise.draw(sensor, begin[rows], 2 * cycles + 1, random)
                here = replace(signal.at(rows), noise=noise)
                found[rows] = first_crossing(here, begin[rows], cycles, comparator)
                alone.skip(rows, begin[rows], end[rows])
    return np.asarray(np.fmin(found, alone.time))


def _loud(signal: Received, peak: float, begin: Column, end: Column, sensor: Sensor) -> NDArray[np.bool_]:
    """Whether what is heard in a window may reach the threshold: seldom does the burst on the board."""
    heard = (signal.delays < end[:, None]) & (signal.delays > begin[:, None] - HEARD)
    most = peak * (np.abs(signal.sizes) * heard).sum(axis=1) + _SIGMAS * sensor.noise
    return np.asarray(most > np.minimum(sensor.comparator.at(begin), sensor.comparator.at(end)))


def _jitter(signal: Received, sensor: Sensor, random: np.random.Generator) -> Column:
    """Scatter of a detector that knows the front: the noise over the steepest slope of the carrier."""
    slope = 2 * np.pi * sensor.frequency * np.abs(signal.sizes[:, 1]) * signal.response.peak
    return np.asarray(random.normal(size=len(slope)) * sensor.noise / slope)


def waveform(
    scene: Scene,
    sensor: Sensor | None = None,
    random: np.random.Generator | None = None,
    sample_rate: float = 1e6,
) -> tuple[Column, Column]:
    """Sample the voltage before the comparator, from the burst to the time-out.

    Parameters
    ----------
    scene : Scene
        Of n readings.
    sensor : Sensor, optional
        An HC-SR04 by default.
    random : numpy.random.Generator, optional
        Of noise and bursts; None: no noise, and one burst like another.
    sample_rate : float
        [Hz].

    Returns
    -------
    elapsed : ndarray, shape (k,)
        Since the burst began [s].
    voltage : ndarray, shape (n, k)
        In units of the comparator.
    """
    sensor = sensor or Sensor()
    elapsed = np.arange(0.0, sensor.timeout, 1 / sample_rate)
    signal = received(scene, sensor, random)
    if random is not None:
        count = 2 * int(np.ceil(sensor.timeout * sensor.frequency)) + 1
        signal = replace(signal, noise=Noise.draw(sensor, np.zeros(len(scene)), count, random))
    return elapsed, signal.voltage(np.broadcast_to(elapsed, (len(scene), len(elapsed))))
