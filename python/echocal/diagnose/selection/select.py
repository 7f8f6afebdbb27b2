"""The decision which causes to claim, before the validation."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.posterior import NoisePosterior
from echocal.diagnose.selection.claims import (
    Claim,
    Ranking,
    beside_a_term,
    claims,
    resized,
    without,
)
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.steadiness import unsteady
from echocal.diagnose.selection.unexplained_term import sized_apart, unexplained

__all__ = ["Selection", "select"]


@dataclass(frozen=True)
class Selection:
    """The claims before the validation.

    Attributes
    ----------
    best : HypothesisFit
        The hypothesis whose causes are claimed, with the sizes that the model has.
    listed : sequence of Claim
        All claims.
    claims : sequence of Claim
        Those that may enter the model.
    noise : Noise
        The most likely noise beside the best hypothesis.
    term : Unexplained or None
        The unexplained term.
    varying : mapping of str to str
        Claims whose size is not constant, each with a sentence on its sizes.
    """

    best: HypothesisFit
    listed: Sequence[Claim]
    claims: Sequence[Claim]
    noise: Noise
    term: Unexplained | None
    varying: Mapping[str, str]


def select(case: Case, ranking: Ranking, shares: NoisePosterior, carried: Stack) -> Selection:
    """Claim the causes of the best hypothesis, then check the claims."""
    settings = case.settings.claims
    best, listed = _claimed(case, ranking, carried, shares)
    whole = best
    noise, _ = carried.likeliest(best)
    term = unexplained(case, ranking)
    if term is not None:
        against = term.against
        listed = beside_a_term(listed, case.found, carried, against, term.rms_m, settings)
        best, listed = sized_apart(best, listed, carried, settings.blurred)
    likely = [c for c in listed if c.probability >= settings.modeled_from] or listed
    varying = unsteady(case, likely, noise, whole)
    if term is not None:  # a cause whose size varies fits a part of the unexplained term
        best, likely = _left_out(best, likely, varying, carried)
    return Selection(best, listed, likely, noise, term, varying)


def _claimed(
    case: Case, ranking: Ranking, carried: Stack, shares: NoisePosterior
) -> tuple[HypothesisFit, list[Claim]]:
    """Claims of the best hypothesis: docs/method.md, Eq. 25.

    An effect is claimed if "no effect" is improbable enough, even if each single effect is
    improbable. Causes that the data cannot separate share the probability of their class. A further
    cause is therefore added if its whole class is more probable than the set without it.
    """
    best = ranking.best()
    if best is None:
        raise RuntimeError("no hypothesis was fitted")
    claimed = _of(best, case, ranking, carried)
    while (grown := ranking.best(beyond=best.hypothesis.effects)) is not None:
        ids = best.hypothesis.effects
        (more,) = _of(grown, case, ranking, carried, ids)
        alone, beside = ranking.more(ids, (more.cause, *more.rivals))
        if beside <= alone if ids else alone >= _in_doubt(len(case.table), ranking, shares):
            break
        best, claimed = grown, _of(grown, case, ranking, carried)
    return best, claimed


def _in_doubt(rows: int, ranking: Ranking, shares: NoisePosterior) -> float:
    """Probability of no effect below which an effect is claimed."""
    settings = ranking.settings.claims
    found = [{id_: p * q for id_, q in shares.nuisance_of(ids).items()} for ids, p in ranking.sets]
    present = (sum(one.get(noise.facts.id, 0.0) for one in found) for noise in registry.nuisances())
    if max(present, default=0.0) > settings.noisy_from:
        return settings.claim_below_amid_noise
    return settings.claim_below_of_few if rows < settings.few_rows else settings.claim_below


def _left_out(
    best: HypothesisFit, claimed: Sequence[Claim], left_out: Container[str], carried: Stack
) -> tuple[HypothesisFit, list[Claim]]:
    """Leave out some claims and fit the sizes of the others again, without them."""
    hypothesis = best.hypothesis
    for claim in claimed:
        if claim.cause in left_out:
            hypothesis = without(hypothesis, claim.cause)
    if hypothesis is best.hypothesis:
        return best, list(claimed)
    best = fit_hypothesis(hypothesis, carried)
    return best, resized([claim for claim in claimed if claim.cause not in left_out], best)


def _of(fit: HypothesisFit, case: Case, ranking: Ranking, carried: Stack, beyond: Ids = ()) -> list[Claim]:
    _, products = carried.likeliest(fit)
    return claims(ranking, fit, case.found, Geometry(products, fit.variance), beyond)
