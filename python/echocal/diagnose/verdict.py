"""The verdict, and everything that a person is told about it."""

import time
import warnings
from collections.abc import Container, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.alias import Geometry
from echocal.diagnose.case import Case
from echocal.diagnose.claims import (
    Claim,
    Ranking,
    alternatives,
    beside_a_remainder,
    claims,
    effects_named,
    parameters,
    rank,
    resized,
    without,
)
from echocal.diagnose.evidence import Stack, Weighed, weigh
from echocal.diagnose.faults import Faults
from echocal.diagnose.gain import errors
from echocal.diagnose.hypotheses import posterior
from echocal.diagnose.joint import NAMED, Joint, join
from echocal.diagnose.judge import Judgment, judge
from echocal.diagnose.level_steps import steps_of
from echocal.diagnose.members import members
from echocal.diagnose.next_measurements import propose
from echocal.diagnose.noises.weighing import weigh_noises
from echocal.diagnose.notes import because, notes, unexplained
from echocal.diagnose.parts import Cause, Parameter, Traces, Verdict
from echocal.diagnose.progress import Steps
from echocal.diagnose.ranges import Ranges
from echocal.diagnose.remainder import told_apart, with_its_shape
from echocal.diagnose.result import Diagnosis
from echocal.diagnose.steadiness import unsteady
from echocal.errors import DomainWarning
from echocal.observations import Observations
from echocal.registry import find_effect

__all__ = ["conclude"]

_CREDIBLE = 0.95
_IN_DOUBT = 0.4  # probability of no effect below which some effect is told, though each may be unlikely


def conclude(
    case: Case,
    observations: Observations,
    faults: Faults,
    can_vary: Ranges | None,
    start: float,
    work: Steps,
) -> Diagnosis:
    """Weigh, claim, judge, and say it."""
    work.begin("weighing causes")
    stack = case.stack(case.folds.fit)
    weighed, carried = posterior(case.found, stack)
    steps = [f.cause for f in faults.accepted if f.facts.kind == "noise"]
    work.begin("weighing noises")
    shares = weigh_noises(case, weighed, carried, steps)
    ranking = rank(shares.weighed, case.found.competing)
    best, claimed = _claimed(case, ranking, carried)
    whole = best
    noise, _ = carried.likeliest(best)
    remainder = unexplained(case, ranking)
    if remainder is not None:
        claimed = beside_a_remainder(claimed, case.found, carried, remainder.against, remainder.rms_m)
        best, claimed = told_apart(best, claimed, carried)
    believed = [c for c in claimed if c.probability >= 0.5] or claimed  # the rest is listed, not modeled
    varying = unsteady(case, believed, noise, whole)
    if remainder is not None:  # what changes its size bends after what nobody explains
        best, believed = _spared(best, believed, varying, carried)
    work.begin("judging on rows never fitted")
    judgment = judge(case, best, believed, noise)
    joint = join(ranking, faults.found, shares, carried)
    verdict = _verdict(judgment, varying, remainder is not None, joint)
    others = alternatives(ranking, claimed) if verdict == "ambiguous" else []
    work.begin("planning measurements")
    possible = members(case, ranking, claimed, judgment, carried)
    return Diagnosis(
        verdict=verdict,
        causes=(
            *(_cause(case, claim, judgment, varying.get(claim.cause, "")) for claim in judgment.kept),
            *(_cause(case, claim, judgment) for claim in others),
            *joint.causes,
        ),
        posterior=tuple(joint.sets.items()),
        credible_set=_credible(joint),
        unexplained=None if remainder is None else with_its_shape(case, remainder, judgment.model, noise),
        refuted=judgment.refuted,
        gain=judgment.gain,
        next_measurements=propose(
            case, possible, [c.cause for c in judgment.kept], noise, best.variance, can_vary
        ),
        rows={
            "total": len(observations),
            "used": len(case.table),
            "unusable": dict(case.table.unusable),
            "level_steps_at_rows": (case.table.steps + 1).tolist(),
            "level_steps": steps_of(case.table, observations),
        },
        base=case.base.to_dict(),
        noise={
            "standard_deviation_m": best.variance**0.5,
            "autoregression": noise.rho,
            "moving_average": noise.memory,
            "stand_variance_ratio": noise.stand_ratio,
        },
        notes=(
            *varying.values(),
            *notes(case, observations, judgment, stack),
            *_outside(case, len(observations), judgment),
        ),
        seconds=time.perf_counter() - start,
        model=judgment.model,
        traces=_traces(case, judgment),
        members=possible,
    )


def _claimed(case: Case, ranking: Ranking, carried: Stack) -> tuple[Weighed, list[Claim]]:
    """Claims of the best hypothesis.

    Causes that these data cannot tell apart share what probability their class has: a set of causes,
    or nothing, wins over one cause more only if it wins over the whole class of that cause; and
    nothing, only where it is not in doubt.
    """
    best = ranking.best()
    if best is None:
        raise RuntimeError("no hypothesis was weighed")
    claimed = _of(best, case, ranking, carried)
    while (grown := ranking.best(beyond=effects_named(best.hypothesis))) is not None:
        instead = _of(grown, case, ranking, carried)
        ids = effects_named(best.hypothesis)
        (more,) = (claim for claim in instead if claim.cause not in ids)
        alone, beside = ranking.more(ids, (more.cause, *more.rivals))
        if beside <= alone and (ids or alone >= _IN_DOUBT):
            break
        best, claimed = grown, instead
    return best, claimed


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


def _of(weighed: Weighed, case: Case, ranking: Ranking, carried: Stack) -> list[Claim]:
    _, products = carried.likeliest(weighed)
    return claims(ranking, weighed, case.found, Geometry(products, weighed.variance))


def _verdict(judgment: Judgment, varying: Container[str], remainder: bool, joint: Joint) -> Verdict:
    steady = [c.probability for c in judgment.kept if c.cause not in varying]
    if any(probability >= NAMED for probability in steady):
        return "named"
    unsteady_claims = len(steady) < len(judgment.kept)
    if not unsteady_claims and any(f.probability >= NAMED for f in joint.telling):
        return "named"
    if remainder:
        return "unknown"
    return "ambiguous" if judgment.kept or joint.telling else "nothing"


def _credible(joint: Joint) -> tuple[tuple[str, ...], ...]:
    total, chosen = 0.0, []
    for ids, p in joint.sets.items():
        chosen.append(ids)
        total += p
        if total >= _CREDIBLE:
            break
    return tuple(chosen)


def _cause(case: Case, claim: Claim, judgment: Judgment, doubt: str = "") -> Cause:
    in_model = claim in judgment.kept
    value = judgment.model.effects[claim.cause] if in_model else parameters(claim.variant, claim.mean)
    named = claim.deviation[: len(claim.variant.scales)]
    uncertainty = dict(zip(claim.variant.names, named * claim.variant.scales, strict=False))
    values = tuple(
        Parameter(p.name, value[p.name], float(uncertainty.get(p.name, 0.0)), p.unit)
        for p in find_effect(claim.cause).parameters
        if p.name in value
    )
    text = because(case, claim, judgment)
    return Cause(claim.cause, "effect", claim.probability, values, claim.rivals, text, in_model, doubt)


def _outside(case: Case, total: int, judgment: Judgment) -> list[str]:
    """Where the extended model is used outside a law's domain, with row numbers of the source."""

    def spread(column: NDArray[np.float64]) -> NDArray[np.float64]:
        if len(column) == total:
            return column
        whole = np.full(total, np.nan)
        whole[case.table.row] = column
        return whole

    recorded = {name: spread(column) for name, column in case.table.conditions.items()}
    with warnings.catch_warnings(action="always", record=True) as caught:
        judgment.model.speed_of_sound(1.0, **recorded)
    return list(dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, DomainWarning)))


def _traces(case: Case, judgment: Judgment) -> Traces:
    table = case.table
    fit: NDArray[np.bool_] = case.folds.fit[case.folds.blocks]
    return Traces(
        row=table.row,
        before=errors(table, case.base.model(), fit),
        after=errors(table, judgment.model, fit),
        held_out=~fit,
        against=table.against(),
    )
