"""Readings of a sensor in a scene: what its comparator makes of the waveforms."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.crossing import first_crossing
from echocal.virtual_bench.waveform.received import Noise, Received, noise_rate
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Sensor

__all__ = ["Echoes", "measure", "waveform"]

Column = NDArray[np.float64]

_CHUNK = 2000  # readings at a time: their arrays stay in the cache
_WINDOWS = ((0, 8), (8, 20))  # periods after the front of an echo: most cross in the first window


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
        Of the noise. The same generator gives the same readings, whatever the number of threads.
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
    >>> bool((echoes.time > 2.8e-3).all())
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


def received(scene: Scene, sensor: Sensor) -> Received:
    """Compute what arrives in a scene, without noise."""
    warm = scene.temperature if scene.device_temperature is None else scene.device_temperature
    response = BurstResponse.of(sensor.chain, sensor.frequency, sensor.cycles, warm)
    delays, sizes = scene.paths(sensor)
    return Received(response, delays, sizes)


def _some(scene: Scene, sensor: Sensor, random: np.random.Generator) -> tuple[Column, Column, Column]:
    """Measure few readings."""
    signal = received(scene, sensor)
    target = signal.delays[:, 1]
    if sensor.comparator.ideal:
        crossed = target + _jitter(signal, sensor, random)
        risen = 0.0
    else:
        crossed = _crossed(signal, sensor, random)
        risen = sensor.zero
    pulse = np.round((crossed - risen) / sensor.tick) * sensor.tick
    pulse[crossed > sensor.timeout] = np.nan
    return pulse, crossed - target, np.abs(signal.sizes[:, 1])


def _crossed(signal: Received, sensor: Sensor, random: np.random.Generator) -> Column:
    """Search path after path, in the order of their arrival."""
    found = _by_noise(signal, sensor, random)
    order = np.argsort(signal.delays, axis=1)
    for place in range(order.shape[1]):
        start = np.take_along_axis(signal.delays, order[:, place, None], axis=1)[:, 0]
        start = np.maximum(start, sensor.comparator.blanking)
        for first, cycles in _WINDOWS:
            begin = start + first / sensor.frequency
            # What noise brings after this time is no longer the first thing that crosses.
            rows = np.flatnonzero((begin < sensor.timeout) & ~(found < begin))
            if len(rows):
                noise = Noise.draw(sensor, begin[rows], cycles, random)
                here = replace(signal.at(rows), noise=noise)
                crossed = first_crossing(here, begin[rows], cycles, sensor.comparator)
                found[rows] = np.fmin(found[rows], crossed)
    return found


def _jitter(signal: Received, sensor: Sensor, random: np.random.Generator) -> Column:
    """Scatter of a detector that knows the front: the noise over the slope of the carrier."""
    slope = 2 * np.pi * sensor.frequency * np.abs(signal.sizes[:, 1]) * 0.4
    return np.asarray(random.normal(size=len(slope)) * sensor.noise / slope)


def _by_noise(signal: Received, sensor: Sensor, random: np.random.Generator) -> Column:
    """When noise alone crosses the threshold, NaN where it does not before the time-out.

    The envelope rises through u standard deviations `sqrt(2 pi) b u exp(-u^2 / 2)` times a second, b the
    effective bandwidth [Hz]: Rice 1945, doi:10.1002/j.1538-7305.1945.tb00453.x, eq. (4.1).
    """
    comparator = sensor.comparator
    edges = np.unique([comparator.blanking, *[until for until, _ in comparator.steps], sensor.timeout])
    edges = edges[(edges >= comparator.blanking) & (edges <= sensor.timeout)]
    height = comparator.at(0.5 * (edges[1:] + edges[:-1])) / max(sensor.noise, 1e-30)
    band = noise_rate(sensor) / (2 * np.pi)
    rate = np.sqrt(2 * np.pi) * band * height * np.exp(-0.5 * np.minimum(height, 30.0) ** 2)
    expected = np.concatenate([[0.0], np.cumsum(rate * np.diff(edges))])
    drawn = random.exponential(size=len(signal.delays))
    reached = np.interp(drawn, expected, edges)
    return np.where(drawn < expected[-1], reached, np.nan)


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
        Of the noise; None: no noise.
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
    signal = received(scene, sensor)
    if random is not None:
        cycles = int(np.ceil(sensor.timeout * sensor.frequency)) + 1
        signal = replace(signal, noise=Noise.draw(sensor, np.zeros(len(scene)), cycles, random))
    return elapsed, signal.voltage(np.broadcast_to(elapsed, (len(scene), len(elapsed))))
