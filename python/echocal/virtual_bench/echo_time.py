"""When the echo comes back on the bench."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import UsageError
from echocal.virtual_bench.air import saturation_pressure, speed_of_sound
from echocal.virtual_bench.waveform.measure import measure
from echocal.virtual_bench.waveform.possible import Limits, check
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Sensor

DETECTORS = ("ideal", "comparator")
"""Which module times the echo: one that tells `2 d / c`, or an HC-SR04 with its comparator."""

# Wider than any outdoor air, and narrower than what a slip of the unit makes of it.
_AIR = {
    "temperature": Limits(-100.0, 100.0, unit="degC", way_out="write degrees Celsius"),
    "relative_humidity": Limits(0.0, 1.0, way_out="it is a fraction; write 0.5 for 50 %"),
    "pressure": Limits(1e4, 1e6, unit="Pa", way_out="1013 hPa are 101300 Pa"),
}


def check_air(temperature: ArrayLike, relative_humidity: ArrayLike, pressure: ArrayLike) -> None:
    """Refuse air that cannot be, or is no air of a bench.

    Raises `UsageError` if a value is out of its range, or the air would hold more vapor than its pressure.
    They are in degC, 1 and Pa.

    Examples
    --------
    >>> check_air(20.0, 0.5, 101325.0)
    """
    for name, value in zip(_AIR, (temperature, relative_humidity, pressure), strict=True):
        check(name, value, _AIR[name])
    vapor = np.asarray(relative_humidity) * saturation_pressure(temperature)
    check("vapor over pressure", vapor / np.asarray(pressure), Limits(0.0, 0.5, way_out="give drier air"))


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

    Raises `UsageError` if there is no such detector, or no such air.

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

    Examples
    --------
    >>> f"{echo_time(2.0, 20.0) * 1e6:.0f} us"
    '11645 us'
    """
    if detector not in DETECTORS:
        raise UsageError(f"detector is {' or '.join(DETECTORS)}, not '{detector}'")
    air = (temperature, relative_humidity, pressure)
    check_air(*air)
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
