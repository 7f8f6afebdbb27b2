"""The decision to claim a cause, or none, before held-out rows are asked."""

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
    beside_a_remainder,
    claims,
    resized,
    without,
)
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.remainder import sized_apart, unexplained
from echocal.diagnose.selection.steadiness import unsteady

__all__ = ["Selection", "select"]


@dataclass(frozen=True)
class Selection:
    """What is claimed, before held-out rows are asked.

    Attributes
    ----------
    best : HypothesisFit
        The hypothesis whose causes are claimed, sized as the model has them.
    listed : sequence of Claim
        Every claim.
    claims : sequence of Claim
        Those that the model may have.
    noise : Noise
        The likeliest beside the best hypothesis.
    remainder : Unexplained or None
        A smooth function that no cause accounts for.
    varying : mapping of str to str
        Claims that have no one size, and the sizes found.
    """

    best: HypothesisFit
    listed: Sequence[Claim]
    claims: Sequence[Claim]
    noise: Noise
    remainder: Unexplained | None
    varying: Mapping[str, str]


def select(case: Case, ranking: Ranking, shares: NoisePosterior, carried: Stack) -> Selection:
    """Claim the causes of the best hypothesis, and doubt the claims."""
    settings = case.settings.claims
    best, listed = _claimed(case, ranking, carried, shares)
    whole = best
    noise, _ = carried.likeliest(best)
    remainder = unexplained(case, ranking)
    if remainder is not None:
        against = remainder.against
        listed = beside_a_remainder(listed, case.found, carried, against, remainder.rms_m, settings)
        best, listed = sized_apart(best, listed, carried, settings.blurred)
    likely = [c for c in listed if c.probability >= settings.modeled_from] or listed  # the rest is listed
    varying = unsteady(case, likely, noise, whole)
    if remainder is not None:  # what changes its size bends after what nobody explains
        best, likely = _spared(best, likely, varying, carried)
    return Selection(best, listed, likely, noise, remainder, varying)


def _claimed(
    case: Case, ranking: Ranking, carried: Stack, shares: NoisePosterior
) -> tuple[HypothesisFit, list[Claim]]:
    """Claims of the best hypothesis.

    Some effect is claimed where no effect is in doubt, however the probability is shared. Causes
    that these data cannot tell apart share what probability their class has: a set of causes wins
    over one cause more only if it wins over the whole class of that cause.
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
    """Probability of no effect below which some effect is claimed."""
    settings = ranking.settings.claims
    guards = [{id_: p * q for id_, q in shares.nuisance_of(ids).items()} for ids, p in ranking.sets]
    there = (sum(found.get(guard.facts.id, 0.0) for found in guards) for guard in registry.nuisances())
    if max(there, default=0.0) > settings.noisy_from:
        return settings.claim_below_amid_noise
    return settings.claim_below_of_few if rows < settings.few_rows else settings.claim_below


def _spared(
    best: HypothesisFit, believed: Sequence[Claim], left_out: Container[str], carried: Stack
) -> tuple[HypothesisFit, list[Claim]]:
    """Leave out some claims and size the rest anew: what no model has must take nothing from them."""
    hypothesis = best.hypothesis
    for claim in believed:
        if claim.cause in left_out:
            hypothesis = without(hypothesis, claim.cause)
    if hypothesis is best.hypothesis:
        return best, list(believed)
    best = fit_hypothesis(hypothesis, carried)
    return best, resized([claim for claim in believed if claim.cause not in left_out], best)


def _of(fit: HypothesisFit, case: Case, ranking: Ranking, carried: Stack, beyond: Ids = ()) -> list[Claim]:
    _, products = carried.likeliest(fit)
    return claims(ranking, fit, case.found, Geometry(products, fit.variance), beyond)
