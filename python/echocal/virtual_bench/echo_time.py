"""When the echo comes back on the bench."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.virtual_bench.air import speed_of_sound

__all__ = ["echo_time"]


def echo_time(
    distance: ArrayLike,
    temperature: ArrayLike,
    relative_humidity: ArrayLike = 0.0,
    pressure: ArrayLike = 101325.0,
) -> NDArray[np.float64]:
    """Echo time out and back, as an ideal module has it: 2 d / c.

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

    Returns
    -------
    ndarray
        Echo time [s].

    Examples
    --------
    >>> f"{echo_time(2.0, 20.0) * 1e6:.0f} us"
    '11653 us'
    """
    return 2.0 * np.asarray(distance) / speed_of_sound(temperature, relative_humidity, pressure)
