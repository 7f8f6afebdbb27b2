"""How far off a row is more probably wild than of the noise."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.density import log_density
from echocal.diagnose.settings.rows import RowSettings

__all__ = ["wild_beyond"]

Column = NDArray[np.float64]

_WILD = 4.0  # robust standard deviations: nobody calls a row wild that is less far off
_LEAST = 1e-5  # m, below the scatter of such sensors
_KERNELS = (np.inf, 8.0, 4.0, 2.5)  # degrees of freedom of the noise: normal, and heavier tails
_FIRST, _RATIO = 0.05, 0.04  # end of the first bin of deviations [robust sd], and its log ratio to the next
_BINS = np.append(0.0, _FIRST * np.exp(_RATIO * np.arange(430)))
_SCALES = np.geomspace(0.25, 2.0, 40)[:, None, None]  # of the noise, in the same unit
_NEGLIGIBLE = 1e-4  # weight of noises beside the likeliest one that decide nothing
_PARTS = np.append(0.0, np.geomspace(1e-4, 0.1, 10))[:, None]  # of rows that are wild


def wild_beyond(off: Column, spread: float, way: float, step: float, settings: RowSettings) -> float:
    """Deviation from which on a row is wild, more probably than not: docs/method/faults.md, Eq. 2b.

    Parameters
    ----------
    off : ndarray, shape (n,)
        Deviations without a sign [m].
    spread : float
        Their robust standard deviation [m].
    way : float
        Usual distance [m]: the largest deviation of a wild row.
    step : float
        Step of the readings [m].
    settings : RowSettings

    Returns
    -------
    float
        [m]; infinite where heavy tails explain all rows.
    """
    spread = max(spread, step / 12**0.5, _LEAST)
    if not _WILD * spread < way:
        return np.inf
    bins = np.log(np.maximum(off / (_FIRST * spread), 1e-3)) / _RATIO + 1.0
    counts = np.bincount(np.clip(bins, 0.0, len(_BINS) - 1).astype(np.int64), minlength=len(_BINS))
    some = np.flatnonzero(counts)
    orders = np.log(way / spread / _WILD)
    prior = np.log(np.where(_PARTS[:, 0] > 0, settings.wild / (len(_PARTS) - 1), 1.0 - settings.wild))
    at = np.maximum(_BINS * np.exp(0.5 * _RATIO), 0.5 * _FIRST)
    each = np.where(at > _WILD, 1.0 / (at * orders), 0.0)  # any order of magnitude
    wild = _PARTS * each[some]
    noise = np.stack([(1.0 - _PARTS) * _density(at[some], _SCALES, nu) for nu in _KERNELS])
    log = (counts[some] * np.log(noise + wild + 1e-300)).sum(axis=-1) + prior
    weight = np.exp(log - log.max())
    probable = np.zeros(len(_BINS))  # of a row in each bin, whether one is there or not
    for kernel, scale, part in np.argwhere(weight > _NEGLIGIBLE):
        width, share = float(_SCALES[scale, 0, 0]), float(_PARTS[part, 0])
        usual = (1.0 - share) * _density(at, width, _KERNELS[kernel])
        probable += weight[kernel, scale, part] * share * each / (usual + share * each + 1e-300)
    usual_bins = np.flatnonzero(probable < 0.5 * weight[weight > _NEGLIGIBLE].sum())
    beyond = int(usual_bins[-1]) + 1 if len(usual_bins) else 0
    return float(_BINS[beyond] * spread) if beyond < len(_BINS) else np.inf


def _density(off: Column, scale: Column | float, freedom: float) -> Column:
    """Density of the absolute value of noise."""
    return 2.0 * np.exp(log_density(off, scale, freedom))
