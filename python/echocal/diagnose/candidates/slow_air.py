"""Air along the path that differs from that at the thermometer, slowly: a part of the noise."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.variant import Candidates
from echocal.diagnose.settings.noise_models import NoiseModelSettings

__all__ = ["slow_air_columns"]

Column = NDArray[np.float64]

_TIMES = 200  # at which the covariance is taken
_MOST = 8  # functions of time that the difference is made of
_LEAST = 0.02  # of its variance, that such a function has


def slow_air_columns(found: Candidates, scene: Scene) -> tuple[int, ...]:
    """Add what warmer air along the path does to the readings, as functions of time.

    docs/method/noises.md, Eq. 5a.

    Returns
    -------
    tuple of int
        Columns of one kelvin each [m]. None without recorded times, and where the table is much
        longer than the difference lasts: it averages out.
    """
    settings = scene.settings.noise_models
    columns = scene.columns()
    warmer = columns[columns.tangent("temperature_offset", {"offset": 0.0}, "offset", 1.0)]
    if not np.isfinite(warmer).all() or not warmer.any():
        return ()
    time = scene.conditions.get("elapsed_time")
    parts = [] if time is None else _parts(np.asarray(time), settings)
    return tuple(found.columns.store(warmer * part) for part in parts)


def _parts(time: Column, settings: NoiseModelSettings) -> list[Column]:
    """Largest principal components of exponential correlations in time, each times its deviation."""
    taken = np.unique(np.quantile(time, np.linspace(0.0, 1.0, _TIMES)))
    return [np.interp(time, taken, part) for part in _components(taken.tobytes(), settings.slow_air_times)]


@lru_cache(maxsize=4)  # a diagnosis takes those of one table several times
def _components(times: bytes, lasts: tuple[float, ...]) -> tuple[Column, ...]:
    """The same at the times that they are taken at, the largest first.

    The mean over the rows is taken off: what lasts as long as the table is an error of the thermometer.
    """
    from scipy.linalg import eigh  # takes long to import

    taken = np.frombuffer(times)
    apart = np.abs(taken[:, None] - taken)
    centered = np.eye(len(taken)) - 1.0 / len(taken)
    alike = np.mean([np.exp(-apart / one) for one in lasts], axis=0)
    largest = max(len(taken) - _MOST, 0), len(taken) - 1
    shares, vectors = eigh(centered @ alike @ centered / len(taken), subset_by_index=largest)
    each = zip(shares[::-1].tolist(), vectors.T[::-1], strict=True)
    return tuple(np.sqrt(share * len(taken)) * part for share, part in each if share >= _LEAST)
