"""Noise models that compete: autocorrelated noise, and an error that the rows of a station share."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import NamedTuple

from echocal.diagnose.settings.noise_models import VARIANCE_FLOOR, NoiseModelSettings

__all__ = [
    "VARIANCE_FLOOR",
    "WHITE",
    "Convection",
    "Noise",
    "NoiseCorrelation",
    "all_convections",
    "growing_noises",
    "noises",
]


class Convection(NamedTuple):
    """Warm cells in the path: white noise, and autocorrelated noise that grows with the distance.

    docs/method/noises.md, Eq. 4. With a coefficient of 0 it is noise without autocorrelation that grows.

    Attributes
    ----------
    rho : float
        Autoregressive coefficient of the autocorrelated part.
    growth : float
        Variance of the autocorrelated part over that of the white one, at one meter.
    whole_path : bool
        Whether the air is alike along the whole path: the variance grows with the square of the distance.
    """

    rho: float
    growth: float
    whole_path: bool = False


NoiseCorrelation = float | Convection | None
"""What a pass over the rows sums: a moving-average coefficient, a convection, or None for white noise."""

WHITE: NoiseCorrelation = None
"""Noise without a correlation."""


@dataclass(frozen=True)
class Noise:
    """White noise on a first-order autoregression, with a random error per station.

    Attributes
    ----------
    moving_average, rho : float
        Moving-average and autoregressive coefficient; ``rho > moving_average``, or both zero.
    station_ratio : float
        Variance of the error that all rows of a station share, over that of the innovations.
    prior : float
        Probability before the data.
    growth : float
        Where not 0, the noise is that of a `Convection`; its growth at one meter.
    whole_path : bool
        Whether that convection is alike along the whole path.
    slow_air : float
        Standard deviation of the temperature along the path less that of the thermometer, which changes
        slowly [K].
    """

    moving_average: float
    rho: float
    station_ratio: float
    prior: float
    growth: float = 0.0
    whole_path: bool = False
    slow_air: float = 0.0

    @property
    def correlation(self) -> NoiseCorrelation:
        """What a pass over the rows must sum for it."""
        if self.growth:
            return Convection(self.rho, self.growth, self.whole_path)
        return self.moving_average if self.rho else WHITE

    @property
    def white_part(self) -> float:
        """Variance of the white part of a convection, in units of the noise; see `Convection` of the core."""
        return 1.0 / (1.0 + self.growth) if self.whole_path else 1.0

    @property
    def first_weight(self) -> float:
        """Innovation variance over the variance of the process: the weight of a series' first row.

        The square of the factor of docs/method.md, Eq. 3. Of a convection it is 1, for the variance is
        counted in that of its white part.
        """
        if self.growth:
            return 1.0
        theta = self.moving_average
        return (1 - self.rho**2) / (1 - 2 * self.rho * theta + theta**2)


def all_convections(settings: NoiseModelSettings) -> tuple[Convection, ...]:
    """List the convections considered, where rows are at different distances."""
    cells = product(settings.convection_rhos, settings.convection_growths)
    whole = product(settings.whole_path_rhos, settings.whole_path_growths)
    return (*(Convection(*one) for one in cells), *(Convection(*one, whole_path=True) for one in whole))


def growing_noises(settings: NoiseModelSettings) -> tuple[Convection, ...]:
    """List the noises without autocorrelation whose variance grows with the distance."""
    return tuple(Convection(0.0, growth, whole_path=True) for growth in settings.white_growths)


@lru_cache(maxsize=8)
def noises(
    settings: NoiseModelSettings,
    stations: bool,
    convections: tuple[Convection, ...] = (),
    levels: bool = False,
    slow_air: bool = False,
) -> tuple[Noise, ...]:
    """List the noise models considered: the grid of docs/method/noises.md.

    Parameters
    ----------
    settings : NoiseModelSettings
    stations : bool
        Whether stations may err, each by itself.
    convections : tuple of Convection
        Those that are considered. If there are any, the other convections lose their prior. Those without
        autocorrelation have half the prior of white noise.
    levels : bool
        Whether the stations are the levels of a column, whose errors may be larger.
    slow_air : bool
        Whether each is considered with air that differs from the thermometer, too.

    Returns
    -------
    tuple of Noise
    """
    alike = [(m, r) for m, rhos in settings.autoregressions for r in rhos if r]
    correlated = 1.0 - settings.usual
    drifting, growing = ([c for c in convections if bool(c.rho) == moves] for moves in (True, False))
    half = correlated / 2 if drifting else correlated
    white = settings.usual / 2 if growing else settings.usual
    rows = [(0.0, 0.0, 0.0, False, white)]
    rows += [(m, r, 0.0, False, half / len(alike)) for m, r in alike]
    rows += [(0.0, *c, half / len(all_convections(settings))) for c in drifting]
    rows += [(0.0, *c, white / len(growing)) for c in growing]
    grid = settings.level_ratios if levels else settings.station_ratios
    none = settings.usual
    ratios = {s: none if s == 0.0 else (1.0 - none) / (len(grid) - 1) for s in grid}
    each = ratios.items() if stations else [(0.0, 1.0)]
    each = [*each]
    air = [(0.0, settings.usual if slow_air else 1.0)]
    if slow_air:
        air += [(kelvin, (1.0 - settings.usual) / len(settings.slow_airs)) for kelvin in settings.slow_airs]
    return tuple(
        Noise(m, r, s, p * q * a, growth, whole, slow)
        for slow, a in air
        for m, r, growth, whole, p in rows
        for s, q in each
    )
