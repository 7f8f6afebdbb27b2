"""Whether the columns can remove more of an error than chance, though nothing is claimed."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from echocal.diagnose.findings.parts import Remainder, SmoothCorrection
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.least_squares import principal
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.settings.priors import WIDEST
from echocal.diagnose.validation.turns import FAR, FAR_FROM_CHANCE, in_turns
from echocal.diagnose.validation.validate import Validation

__all__ = ["explained", "remainder"]

Matrix = NDArray[np.float64]


def remainder(
    case: Case, ranking: Ranking, judgment: Validation, smooth: SmoothCorrection | None, noise: Noise
) -> Remainder | None:
    """Test whether the floor is far below the error of the model: docs/method/checks.md, Eq. 34.

    Parameters
    ----------
    case : Case
    ranking : Ranking
        Of it, the probability that there is no effect is told.
    judgment : Validation
    smooth : SmoothCorrection or None
        If it is offered, something is left to explain, whatever the floor is.
    noise : Noise
        The most probable one beside the best hypothesis.

    Returns
    -------
    Remainder or None
        None if neither the columns nor rows that take turns remove enough.
    """
    gain = judgment.gain
    none = sum(p for ids, p in ranking.sets if not ids)
    if turns := in_turns(case, judgment.model):
        found = turns.rms_m, turns.p_value, turns.degrees
        return Remainder(gain.rms_after_m, *found, none, (), by_chance=False, turns=turns.said)
    offered = smooth is not None and smooth.offered
    far = gain.rms_after_m**2 - gain.rms_floor_m**2 > FAR * gain.rms_after_m**2
    if not far and not offered:
        return None
    (products,) = case.whitened(noise, case.folds.fit).products
    width = WIDEST
    p_value, degrees = explained(products, case.sums.degrees(case.folds.fit), width)
    by_chance = p_value >= FAR_FROM_CHANCE and not offered
    against = tuple(case.found.terms)
    return Remainder(gain.rms_after_m, gain.rms_floor_m, p_value, degrees, none, against, by_chance)


def explained(products: Matrix, rows: int, width: float) -> tuple[float, tuple[float, float]]:
    """Probability that noise alone lets the columns remove as much, and effective degrees of freedom.

    Parameters
    ----------
    products : ndarray, shape (k, k)
        Of whitened columns; the last is explained by all others but the first.
    rows : int
        Rows less unknown levels.
    width : float
        Prior standard deviation of each column's coefficient.
    """
    square = max(products[-1, -1], rows * VARIANCE_FLOOR**2)
    values, turned = principal(products)
    ridge = square / rows / width**2
    shrunk = values / (values + ridge)
    effective = float(np.sum(2 * shrunk - shrunk**2))
    mean = turned / (values + ridge)
    left = max(square - 2 * mean @ turned + mean**2 @ values, rows * VARIANCE_FLOOR**2)
    degrees = effective, rows - effective
    if min(degrees) < 1.0:
        return 1.0, degrees
    ratio = (square - left) / degrees[0] / (left / degrees[1])
    return float(fdtrc(*degrees, max(ratio, 0.0))), degrees
