"""The unexplained term that is reported, and the causes beside it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Candidates, Variant
from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, fit_hypothesis
from echocal.diagnose.selection.claims import Claim, Ranking, without
from echocal.diagnose.selection.slow_noise import LeastFavorable
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["beside_a_term", "imitated", "term_is_told", "unexplained"]

_ANY = (-np.inf, np.inf)


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
    probable = sum(ranking.unexplained_terms().values()) >= PROBABLE
    return probable and (slow is None or slow.nothing < settings.claim_below_amid_noise)


def _described(case: Case, against: str, signal: NDArray[np.float64], probability: float) -> Unexplained:
    rms = float(np.std(signal))
    text = f"{1e3 * rms:.1f} mm against {against}"  # replaced once the model is known
    return Unexplained(against, rms, min(probability, 1.0), text)


def beside_a_term(made: Sequence[Claim], found: Candidates, stack: Stack, term: Unexplained) -> list[Claim]:
    """Limit the probability of causes that are claimed beside an unexplained term.

    docs/method/checks.md, Eq. 27.

    A cause may fit what the unexplained term, a function of one column, does not reach. It keeps
    its probability only as far as it fits better than a second term against each other column.
    All stay in the model, which is fitted and judged as a whole.
    """
    whole = Hypothesis((*(claim.variant for claim in made), found.terms[term.against]), 1.0)
    with_it = _evidence(whole.variants, stack)
    substitutes = _substitutes(found, term)
    doubted = []
    for claim in made:
        less = without(whole, claim.cause).variants
        rival = max((_evidence((*less, other), stack) for other in substitutes), default=-np.inf)
        better = 1 / (1 + np.exp(np.clip(rival - with_it, -700, 700)))
        doubted.append(replace(claim, probability=min(claim.probability, float(better))))
    return sorted(doubted, key=lambda claim: -claim.probability)


def imitated(made: Sequence[Claim], ranking: Ranking) -> dict[str, str]:
    """Find claims that a second smooth function fits as well: ids, each with a sentence."""
    named = ranking.settings.claims.named
    return {
        claim.cause: f"a smooth function of another column fits as well as {claim.cause} beside what is not "
        f"explained, so {claim.cause} is not named"
        for claim in made
        if claim.probability < named <= ranking.of([claim.cause, *claim.rivals])
    }


def _substitutes(found: Candidates, term: Unexplained) -> list[Variant]:
    """Terms against other columns without their means; against the distance, with an offset and a tilt."""
    line = found.line
    mean = () if line is None else line.free[:1]
    functions = {
        name: tuple(column for column in one.free if column not in mean)
        for name, one in found.terms.items()
        if name != term.against
    }
    terms = {
        name: replace(found.terms[name], free=free, bounds=(_ANY,) * len(free))
        for name, free in functions.items()
    }
    if line is not None:  # polynomials of degree 0 and 1, of a mean square of 1 and 1/3, as large as the term
        most = [term.rms_m / scale * (2 * degree + 1) ** 0.5 for degree, scale in enumerate(line.scales)]
        curve = functions.get("distance", ())
        bounds = (*((-size, size) for size in most), *(_ANY for _ in curve))
        terms["distance"] = replace(line, free=(*line.free, *curve), bounds=bounds)
    return list(terms.values())


def _evidence(variants: tuple[Variant, ...], stack: Stack) -> float:
    return fit_hypothesis(Hypothesis(variants, 1.0), stack, one_width=True).log_evidence
