"""Whether few rows show more than slow noise: docs/method/checks.md, section 7, Eq. 25a."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.selection.claims import Ranking

__all__ = ["LeastFavorable", "least_favorable"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class LeastFavorable:
    """What stays probable whichever single autoregression the noise may be, if it is not white.

    Attributes
    ----------
    no_effect : float
        Largest probability of no effect, with or without an unexplained term.
    nothing : float
        Largest probability of no effect and no unexplained term.
    rho : float
        Autoregressive coefficient of the largest `no_effect`.
    """

    no_effect: float
    nothing: float
    rho: float


def least_favorable(case: Case, ranking: Ranking, reduced: Stack) -> LeastFavorable | None:
    """Give all the prior of correlated noise to one first-order autoregression, each in turn.

    The grid of noises spreads this prior. A single slow autoregression then has so little of it that an
    effect which only follows the noise is the more probable explanation. An autoregression under which the
    rows are far less probable, whatever acts, takes no part.

    Parameters
    ----------
    case : Case
    ranking : Ranking
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.

    Returns
    -------
    LeastFavorable or None
        None if there are rows enough to detect autocorrelated noise, or if no autoregression is probable.
    """
    weights, rhos = _weights(case, reduced.noises)
    if len(case.table) >= case.settings.claims.few_rows or not rhos:
        return None
    log = np.array([fit.log_posterior for fit in ranking.fits])
    share = np.exp(log - log.max())[:, None] * (np.array([fit.noise for fit in ranking.fits]) @ weights)
    total = share.sum(axis=0)
    usual = total >= total.max() * np.exp(-case.settings.claims.strong)
    share = share[:, usual] / total[usual]

    def of(kind: Callable[[Hypothesis], bool]) -> Matrix:
        return np.asarray(share[[kind(fit.hypothesis) for fit in ranking.fits]].sum(axis=0))

    no_effect = of(lambda one: not one.effects)
    return LeastFavorable(
        no_effect=float(no_effect.max()),
        nothing=float(of(lambda one: not one.variants).max()),
        rho=float(np.array(rhos)[usual][no_effect.argmax()]),
    )


def _weights(case: Case, noises: tuple[Noise, ...]) -> tuple[Matrix, list[float]]:
    """New prior over old prior of each noise (rows) if one autoregression has all (columns)."""
    whole = 1.0 - case.settings.noise_models.usual
    plain = [n for n in case.usual_noises if n.moving_average == 0.0]
    usual = {(n.rho, n.station_ratio, n.slow_air): n.prior for n in plain}
    rhos = sorted({n.rho for n in noises if n.rho > 0.0 and n.moving_average == 0.0 and not n.growth})
    weights = np.zeros((len(noises), len(rhos)))
    for row, noise in enumerate(noises):
        if noise.rho == 0.0:
            weights[row] = 1.0
        elif noise.moving_average == 0.0 and not noise.growth:
            own = sum(prior for (rho, *_), prior in usual.items() if rho == noise.rho)
            share = usual[noise.rho, noise.station_ratio, noise.slow_air] / own
            weights[row, rhos.index(noise.rho)] = whole * share / noise.prior
    return weights, rhos
