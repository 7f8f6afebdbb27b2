"""Where the level itself moves, only what happens within a day shows a cause."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.selection.claims import Claim

__all__ = ["unseen_within_days"]

Column = NDArray[np.float64]

_DAY = 86400.0  # s


def unseen_within_days(
    case: Case, claims: Sequence[Claim], best: HypothesisFit, noise: Noise
) -> dict[str, str]:
    """Find claims that only follow the slow movement of a level: docs/method.md, "A level that moves".

    All claims are fitted together to the rows less the mean of each day, whitened for the autocorrelation
    of the noise. A cause has the size 1 there, in units of its size in the whole table.

    Parameters
    ----------
    case : Case
    claims : sequence of Claim
    best : HypothesisFit
        The hypothesis that they belong to.
    noise : Noise

    Returns
    -------
    dict of str to str
        Ids, each with a sentence on its size within days.
    """
    time = case.table.conditions.get("elapsed_time")
    causes = [(variant, at) for variant, at in best.hypothesis.placed if variant.cause != UNKNOWN]
    if time is None or not claims or not causes:
        return {}
    rows = np.flatnonzero(case.folds.fitted)
    days = np.floor((time[rows] - time[rows[0]]) / _DAY)
    if len(np.unique(days)) < 2:
        return {}
    part = np.unique(np.column_stack([case.table.groups[rows], days]), axis=0, return_inverse=True)[1].ravel()
    signals = [case.signal(variant, best.mean[at])[rows] for variant, at in causes]
    x, y = np.column_stack([_within(one, part, noise.rho) for one in signals]), case.residual[rows]
    y = _within(y, part, noise.rho)
    inverse = np.linalg.pinv(x.T @ x)
    sizes = inverse @ (x.T @ y)
    left = y - x @ sizes
    freedom = max(len(y) - len(np.unique(part)) - len(sizes), 1)
    deviations = np.sqrt(np.diag(inverse) * (left @ left) / freedom)
    settings = case.settings.claims
    said = {}
    for claim in claims:
        place = next((i for i, (variant, _) in enumerate(causes) if variant.cause == claim.cause), None)
        if place is None:
            continue
        size, u = float(sizes[place]), float(deviations[place])
        seen = size > settings.within_days * u
        other = abs(size - 1.0) > max(settings.within_days * u, settings.within_days_apart)
        if not seen or other:
            said[claim.cause] = (
                f"the level itself moves, so only changes within a day show a cause. There the size of "
                f"{claim.cause} is {size:.2f} +/- {u:.2f} times that of the whole table, so {claim.cause} "
                "is not named: it may stand in for the movement of the level"
            )
    return said


def _within(values: Column, part: NDArray[np.int64], rho: float) -> Column:
    """Values whitened for an autoregression, less the mean of each day."""
    white = values.copy()
    follows = part[1:] == part[:-1]
    white[1:][follows] -= rho * values[:-1][follows]
    first = np.concatenate([[True], ~follows])
    white[first] *= np.sqrt(1.0 - rho**2)
    weight = np.where(first, np.sqrt(1.0 - rho**2), 1.0 - rho)  # what a level of a day becomes
    level = np.bincount(part, white * weight) / np.bincount(part, weight**2)
    return np.asarray(white - weight * level[part])
