"""When the echo comes back on the bench."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import UsageError
from echocal.virtual_bench.air import speed_of_sound
from echocal.virtual_bench.waveform.measure import measure
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Sensor

__all__ = ["DETECTORS", "echo_time", "scene_of"]

DETECTORS = ("ideal", "comparator")
"""Which module times the echo: one that tells `2 d / c`, or an HC-SR04 with its comparator."""


def echo_time(
    distance: ArrayLike,
    temperature: ArrayLike,
    relative_humidity: ArrayLike = 0.0,
    pressure: ArrayLike = 101325.0,
    *,
    detector: str = "ideal",
    seed: int | None = None,
) -> NDArray[np.float64]:
    """Compute how long a module holds ECHO.

    Parameters
    ----------
    distance : array_like
        Distance of the target [m].
    temperature : array_like
        Air temperature [degC].
    relative_humidity : array_like
        Relative humidity [1].
    pressure : array_like
        Pressure [Pa].
    detector : {"ideal", "comparator"}
        "ideal": 2 d / c, c the speed of a burst at 40 kHz. "comparator": an HC-SR04 before a wall of 0.6 m.
    seed : int, optional
        Of the noise of the comparator and of the bursts; default: no noise, and one burst like another.

    Returns
    -------
    ndarray
        Echo time [s], NaN without an echo.

    Raises
    ------
    UsageError
        If there is no such detector.

    Examples
    --------
    >>> f"{echo_time(2.0, 20.0) * 1e6:.0f} us"
    '11645 us'
    """
    if detector not in DETECTORS:
        message = f"detector is {' or '.join(DETECTORS)}, not '{detector}'"
        raise UsageError(message)
    air = (temperature, relative_humidity, pressure)
    if detector == "ideal":
        return 2.0 * np.asarray(distance) / speed_of_sound(*air, frequency=Sensor.frequency, group=True)
    scene = scene_of(distance, *air)
    sensor = Sensor() if seed is not None else Sensor(noise=0.0, burst_scatter=0.0)
    return measure(scene, sensor, np.random.default_rng(seed)).time


def scene_of(
    distance: ArrayLike, temperature: ArrayLike, relative_humidity: ArrayLike, pressure: ArrayLike
) -> Scene:
    """Put a wall into still air, a reading each."""
    given = np.broadcast_arrays(distance, temperature, relative_humidity, pressure)
    far, warm, damp, dense = (np.atleast_1d(np.asarray(one, dtype=np.float64)) for one in given)
    return Scene(far, temperature=warm, relative_humidity=damp, pressure=dense)
