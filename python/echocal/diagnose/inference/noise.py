"""Noise that the engine reckons with before it names anything: memory, and an error per stand."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import NamedTuple

from echocal.diagnose.settings.noise_models import NoiseModelSettings

__all__ = ["VARIANCE_FLOOR", "WHITE", "Convection", "Memory", "Noise", "all_convections", "noises"]

VARIANCE_FLOOR = 1e-9
"""Standard deviation below which no noise is believed [m]; simulated data may have none."""


class Convection(NamedTuple):
    """Memory of warm cells in the path: white noise, and a remembered part that grows with the distance.

    Attributes
    ----------
    rho : float
        Autoregressive coefficient of the remembered part.
    growth : float
        Variance of the remembered part over that of the white one, per distance [1/m].
    """

    rho: float
    growth: float


Memory = float | Convection | None
"""What a pass over the rows remembers: a moving-average coefficient, a convection, or nothing."""

WHITE: Memory = None
"""The memory of white noise."""


@dataclass(frozen=True)
class Noise:
    """White noise on a first-order autoregression, with a random error per stand.

    Attributes
    ----------
    memory, rho : float
        Moving-average and autoregressive coefficient; ``rho > memory``, or both zero.
    stand_ratio : float
        Variance of the error that all rows of a stand share, over that of the innovations.
    prior : float
        Probability before the data.
    growth : float
        Where not 0, the noise is that of a `Convection`, with no other memory [1/m].
    """

    memory: float
    rho: float
    stand_ratio: float
    prior: float
    growth: float = 0.0

    @property
    def remembers(self) -> Memory:
        """What a pass over the rows must remember for it."""
        if self.rho == 0.0:
            return WHITE
        return Convection(self.rho, self.growth) if self.growth else self.memory

    @property
    def first_weight(self) -> float:
        """Innovation variance over the variance of the process: the weight of a series' first row.

        Of a convection that of its white part, which is what its variance is counted in.
        """
        if self.growth:
            return 1.0
        return (1 - self.rho**2) / (1 - 2 * self.rho * self.memory + self.memory**2)


def all_convections(settings: NoiseModelSettings) -> tuple[Convection, ...]:
    """List the convections considered, where rows are at different distances."""
    growths = settings.convection_growths
    return tuple(Convection(rho, growth) for rho in settings.convection_rhos for growth in growths)


def noises(
    settings: NoiseModelSettings, stands: bool, convections: Collection[Convection] = ()
) -> tuple[Noise, ...]:
    """List the noises considered.

    Parameters
    ----------
    settings : NoiseModelSettings
    stands : bool
        Whether stations may err, each by itself.
    convections : collection of Convection
        Those that are considered; if any are, the prior of the others is nobody's.

    Returns
    -------
    tuple of Noise
    """
    alike = [(m, r) for m, rhos in settings.autoregressions for r in rhos if r]
    correlated = 1.0 - settings.white
    half = correlated / 2 if convections else correlated
    rows = [(0.0, 0.0, 0.0, settings.white), *((m, r, 0.0, half / len(alike)) for m, r in alike)]
    rows += [(0.0, c.rho, c.growth, half / len(all_convections(settings))) for c in convections]
    grid, none = settings.station_ratios, settings.no_station_error
    ratios = {s: none if s == 0.0 else (1.0 - none) / (len(grid) - 1) for s in grid}
    each = ratios.items() if stands else [(0.0, 1.0)]
    return tuple(Noise(m, r, s, p * q, growth) for m, r, growth, p in rows for s, q in each)
