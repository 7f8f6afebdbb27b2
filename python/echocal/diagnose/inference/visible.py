"""Candidates that cannot show in a table: they do not compete."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Candidates
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings import PriorSettings

__all__ = ["INVISIBLE", "drop_infinite", "drop_invisible"]

INVISIBLE = "cannot show in these data"
"""Why a cause was left out that no size would make visible."""


def drop_infinite(found: Candidates, sums: Sums) -> Sums:
    """Drop causes whose columns are not finite in these data; return the sums without these columns."""
    sums, finite = sums.without_infinite()
    if finite.all():
        return sums
    broken = {v.cause for v in found.variants if not finite[list(v.columns)].all()}
    found.skipped.update(dict.fromkeys(broken, "not finite in these data"))
    found.variants[:] = [v for v in found.variants if v.cause not in broken]
    return sums


def drop_invisible(
    found: Candidates, sums: Sums, residual: NDArray[np.float64], settings: PriorSettings
) -> None:
    """Drop causes that could not show in these data even at three times their usual size.

    Fitting them would only spread probability over causes that nobody can see.
    """
    used = np.ones(len(sums.rows), dtype=bool)
    products = sums.whiten(Noise(0.0, 0.0, 0.0, 1.0), used).products
    variance = min(_of_steps(residual, sums.order), products[-1, -1] / sums.degrees())
    geometry = Geometry(products, max(variance, VARIANCE_FLOOR**2))
    shown = settings.usual_multiple * geometry.visibilities(found.variants)
    visible = shown > settings.fewest_snr
    kept = {v.cause for v, shows in zip(found.variants, visible, strict=True) if shows or v.cause == UNKNOWN}
    for variant in found.variants:
        if variant.cause not in kept:
            found.skipped[variant.cause] = INVISIBLE
    found.variants[:] = [v for v in found.variants if v.cause in kept]


def _of_steps(residual: NDArray[np.float64], order: Order) -> float:
    """Variance of the noise alone [m^2], whatever slow effects there are: half the mean square step."""
    steps = np.diff(residual)[~order.starts[1:]]
    return float(np.nansum(steps**2)) / 2 / max(len(steps), 1)
