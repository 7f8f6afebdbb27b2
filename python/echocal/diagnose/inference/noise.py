"""Noise that the engine reckons with before it names anything: memory, and an error per stand."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import NamedTuple

__all__ = ["CONVECTIONS", "FINEST", "RHO", "WHITE", "Convection", "Memory", "Noise", "noises"]

FINEST = 1e-9
"""Standard deviation below which no noise is believed [m]; data of a simulation may have none."""

RHO: dict[float, tuple[float, ...]] = {
    0.0: (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98),
    0.5: (0.7, 0.85, 0.95, 0.99),
    0.8: (0.9, 0.95, 0.98, 0.995),
    0.9: (0.95, 0.98, 0.995),
}
_STAND_RATIO = (0.0, 0.1, 1.0, 10.0)  # variance of a stand's own error over the noise's


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


CONVECTIONS = tuple(
    Convection(rho, growth) for rho in (0.6, 0.8, 0.9, 0.95, 0.98) for growth in (0.1, 0.3, 1.0, 3.0)
)
"""The convections considered, where rows are at different distances."""

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


def noises(stands: bool, convections: Collection[Convection] = ()) -> tuple[Noise, ...]:
    """List the noises considered.

    Parameters
    ----------
    stands : bool
        Whether stands may err, each by itself.
    convections : collection of Convection
        Those of `CONVECTIONS` that are considered; if any are, the prior of the others is nobody's.

    Returns
    -------
    tuple of Noise
    """
    # half of the prior on uncorrelated rows, the usual assumption; half on stands without an error
    alike = [(m, r) for m, rhos in RHO.items() for r in rhos if r]
    half = 0.25 if convections else 0.5
    rows = [(0.0, 0.0, 0.0, 0.5), *((m, r, 0.0, half / len(alike)) for m, r in alike)]
    rows += [(0.0, c.rho, c.growth, half / len(CONVECTIONS)) for c in convections]
    ratios = {s: 0.5 if s == 0.0 else 0.5 / (len(_STAND_RATIO) - 1) for s in _STAND_RATIO}
    each = ratios.items() if stands else [(0.0, 1.0)]
    return tuple(Noise(m, r, s, p * q, growth) for m, r, growth, p in rows for s, q in each)
