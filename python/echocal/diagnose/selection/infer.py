"""What is believed of a table before the rows that no fit saw are asked."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

from echocal.diagnose.faults import Faults
from echocal.diagnose.findings.parts import Unexplained
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Stack, Weighed, weigh
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.posterior import posterior
from echocal.diagnose.noises.convection import convections
from echocal.diagnose.noises.weighing import GUARDS, NoiseShares, weigh_noises
from echocal.diagnose.progress import Steps
from echocal.diagnose.selection.claims import (
    Claim,
    Ranking,
    beside_a_remainder,
    claims,
    rank,
    resized,
    without,
)
from echocal.diagnose.selection.parsimony import Ids
from echocal.diagnose.selection.remainder import told_apart, unexplained
from echocal.diagnose.selection.steadiness import unsteady

__all__ = ["Belief", "believe"]

_IN_DOUBT = 0.6  # probability of no effect below which some effect is told, though each may be unlikely
_IN_DOUBT_OF_FEW = 0.44  # the same, of too few rows to tell whether their noise remembers
_FEW = 100  # rows
_IN_DOUBT_AMID_NOISE = 0.25  # the same, where noise remembers or stands err: what else does it do?
_UNUSUAL = 0.5  # probability from which on such noise is reckoned to be there
_LIKELY = 0.5  # probability from which on a claim enters the model; if none is, all do


@dataclass(frozen=True)
class Belief:
    """What the rows that a fit may see say.

    Attributes
    ----------
    stack, carried : Stack
        Products under every noise, and under those that any hypothesis allows.
    shares : NoiseShares
    ranking : Ranking
    best : Weighed
        The hypothesis whose causes are claimed, sized as the model has them.
    listed : sequence of Claim
        Every claim.
    claims : sequence of Claim
        Those that the model may have.
    noise : Noise
        The likeliest beside the best hypothesis.
    remainder : Unexplained or None
        A shape that no cause accounts for.
    varying : mapping of str to str
        Claims that have no one size, and the sizes found.
    """

    stack: Stack
    carried: Stack
    shares: NoiseShares
    ranking: Ranking
    best: Weighed
    listed: Sequence[Claim]
    claims: Sequence[Claim]
    noise: Noise
    remainder: Unexplained | None
    varying: Mapping[str, str]


def believe(case: Case, faults: Faults, work: Steps) -> Belief:
    """Weigh what competes, claim the best, and doubt the claims."""
    work.begin("weighing causes")
    stack = case.stack(case.folds.fit)
    weighed, carried = posterior(case.found, stack)
    if drifting := convections(case, weighed, carried):
        case.sums.remember(case.found.columns, drifting)
        del stack, weighed, carried  # of a wide table these are large: not beside what takes their place
        stack = case.stack(case.folds.fit)
        weighed, carried = posterior(case.found, stack)
    steps = [f.cause for f in faults.accepted if f.facts.kind == "noise"]
    work.begin("weighing noises")
    shares = weigh_noises(case, weighed, carried, steps)
    ranking = rank(shares.weighed, case.found.competing)
    best, listed = _claimed(case, ranking, carried, shares)
    whole = best
    noise, _ = carried.likeliest(best)
    remainder = unexplained(case, ranking)
    if remainder is not None:
        listed = beside_a_remainder(listed, case.found, carried, remainder.against, remainder.rms_m)
        best, listed = told_apart(best, listed, carried)
    likely = [c for c in listed if c.probability >= _LIKELY] or listed  # the rest is listed, not modeled
    varying = unsteady(case, likely, noise, whole)
    if remainder is not None:  # what changes its size bends after what nobody explains
        best, likely = _spared(best, likely, varying, carried)
    return Belief(stack, carried, shares, ranking, best, listed, likely, noise, remainder, varying)


def _claimed(
    case: Case, ranking: Ranking, carried: Stack, shares: NoiseShares
) -> tuple[Weighed, list[Claim]]:
    """Claims of the best hypothesis.

    Some effect is claimed where no effect is in doubt, however the probability is shared. Causes
    that these data cannot tell apart share what probability their class has: a set of causes wins
    over one cause more only if it wins over the whole class of that cause.
    """
    best = ranking.best()
    if best is None:
        raise RuntimeError("no hypothesis was weighed")
    claimed = _of(best, case, ranking, carried)
    while (grown := ranking.best(beyond=best.hypothesis.effects)) is not None:
        ids = best.hypothesis.effects
        (more,) = _of(grown, case, ranking, carried, ids)
        alone, beside = ranking.more(ids, (more.cause, *more.rivals))
        if beside <= alone if ids else alone >= _in_doubt(len(case.table), ranking, shares):
            break
        best, claimed = grown, _of(grown, case, ranking, carried)
    return best, claimed


def _in_doubt(rows: int, ranking: Ranking, shares: NoiseShares) -> float:
    """Probability of no effect below which some effect is told."""
    guards = [{id_: p * q for id_, q in shares.guard_of(ids).items()} for ids, p in ranking.sets]
    there = (sum(found.get(guard.FACTS.id, 0.0) for found in guards) for guard in GUARDS)
    if max(there) > _UNUSUAL:
        return _IN_DOUBT_AMID_NOISE
    return _IN_DOUBT_OF_FEW if rows < _FEW else _IN_DOUBT


def _spared(
    best: Weighed, believed: Sequence[Claim], left_out: Container[str], carried: Stack
) -> tuple[Weighed, list[Claim]]:
    """Leave out some claims and size the rest anew: what no model has must take nothing from them."""
    hypothesis = best.hypothesis
    for claim in believed:
        if claim.cause in left_out:
            hypothesis = without(hypothesis, claim.cause)
    if hypothesis is best.hypothesis:
        return best, list(believed)
    best = weigh(hypothesis, carried)
    return best, resized([claim for claim in believed if claim.cause not in left_out], best)


def _of(weighed: Weighed, case: Case, ranking: Ranking, carried: Stack, beyond: Ids = ()) -> list[Claim]:
    _, products = carried.likeliest(weighed)
    return claims(ranking, weighed, case.found, Geometry(products, weighed.variance), beyond)
