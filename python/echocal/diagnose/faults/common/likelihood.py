"""How likely rows are where a law says they should be, with a few strays: docs/method/faults.md, Eq. 30c."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.view import View
from echocal.observations import Observations
from echocal.observations.quantiles import median

__all__ = ["STRAY", "by_echoes", "independent", "log_density", "log_likelihood"]

Column = NDArray[np.float64]

STRAY = 0.02
"""Part of the rows that are anywhere, whatever the others do."""

_WITNESSES = 60.0
"""Rows that count as independent, at most, where neighbors are alike."""


def log_density(off: Column, scatter: float, wide: float, stray: float = STRAY) -> Column:
    """Log density of deviations: normal, or anywhere in a range as wide as that of the readings."""
    normal = np.log1p(-stray) - 0.5 * (off / scatter) ** 2 - np.log(scatter * np.sqrt(2 * np.pi))
    with np.errstate(invalid="ignore"):  # a row that is not known stays so
        return np.asarray(np.logaddexp(normal, np.log(stray / wide)))


def log_likelihood(view: View, rows: NDArray[np.bool_]) -> float:
    """Log likelihood of some rows of a table as it stands, with its own smooth error and scatter."""
    wide = float(np.ptp(view.indication[rows])) + view.scatter
    return float(log_density(view.deviation[rows], view.scatter, wide).sum())


def independent(off: Column) -> float:
    """Part of the rows that count: of an autoregression of the first order, (1 - rho) / (1 + rho)."""
    off = off - np.median(off)
    rho = float(off[1:] @ off[:-1]) / max(float(off @ off), 1e-300)
    return (1 - rho) / (1 + rho) if rho > 0.0 else 1.0


def by_echoes(view: View, repaired: Observations, rows: NDArray[np.bool_]) -> float:
    """Log Bayes factor of another air in some rows, from recorded echo times.

    They know the air; a reading does not, since the device knew its own.
    """
    reference, good = view.reference, view.good & rows
    if reference is None or view.observations.reading is not None or not good.any():
        return 0.0
    others = view.good & ~rows
    center = median((view.indication - reference)[others]) if others.any() else 0.0
    misfits = [np.abs(look.indication - reference - center)[good] for look in (view, view.after(repaired))]
    as_it_is, otherwise = (median(misfit[np.isfinite(misfit)]) + view.scatter for misfit in misfits)
    return 0.5 * min(_WITNESSES, float(good.sum())) * float(np.log(as_it_is / otherwise))
