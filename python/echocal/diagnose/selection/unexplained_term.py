"""The unexplained term that is reported, and the sizes of the causes beside it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.selection.claims import Claim, Ranking, resized, sizes, without
from echocal.diagnose.selection.slow_noise import LeastFavorable

__all__ = ["sized_apart", "term_is_told", "unexplained"]


def unexplained(case: Case, ranking: Ranking, slow: LeastFavorable | None = None) -> Unexplained | None:
    """The most probable unexplained term, if the terms together are probable enough.

    Of columns that are about equally probable, one of a known quantity: a counter of rows follows the time.

    In few rows, noise alone must be improbable under each single autoregression, too (`slow`).
    """
    terms = ranking.unexplained_terms()
    total = sum(terms.values())
    if not term_is_told(ranking, slow):
        return None
    near = ranking.settings.claims.nearly * max(terms.values())
    known = case.table.known
    against = max(
        (name for name in terms if terms[name] >= near), key=lambda name: (name in known, terms[name])
    )
    for fit in ranking.fits:
        for variant, place in fit.hypothesis.placed:
            if variant.cause == UNKNOWN and variant.against == against:
                signal = case.signal(variant, fit.mean[place])
                return _described(case, against, signal, total)
    return None


def term_is_told(ranking: Ranking, slow: LeastFavorable | None) -> bool:
    """Whether unexplained terms are probable enough to be reported."""
    settings = ranking.settings.claims
    probable = sum(ranking.unexplained_terms().values()) >= settings.unexplained_from
    return probable and (slow is None or slow.nothing < settings.claim_below_amid_noise)


def _described(case: Case, against: str, signal: NDArray[np.float64], probability: float) -> Unexplained:
    rms = float(np.std(signal))
    text = f"{1e3 * rms:.1f} mm against {against}"  # replaced once the model is known
    return Unexplained(against, rms, min(probability, 1.0), text)


def sized_apart(
    best: HypothesisFit, claimed: Sequence[Claim], stack: Stack, undetermined_from: float
) -> tuple[HypothesisFit, list[Claim]]:
    """Fit the sizes of the causes without the unexplained term, where the data do not separate them.

    Beside a term against the column that a cause depends on, the size of the cause is nearly
    undetermined. Then the cause gets all that it can explain, and the term the rest.
    """
    bare = without(best.hypothesis, UNKNOWN)
    if bare.causes == best.hypothesis.causes or not claimed:
        return best, list(claimed)
    fit = fit_hypothesis(bare, stack)
    own = sizes(fit)
    undetermined = any((c.deviation > undetermined_from * own[c.cause][1]).any() for c in claimed)
    if not undetermined:
        return best, list(claimed)
    return fit, resized(claimed, fit)
