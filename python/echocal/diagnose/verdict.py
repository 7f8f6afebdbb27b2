"""The verdict, and everything that a person is told about it."""

import time
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import UNKNOWN
from echocal.diagnose.experiment_design.members import members
from echocal.diagnose.experiment_design.next_measurements import propose
from echocal.diagnose.experiment_design.ranges import Ranges
from echocal.diagnose.faults import Faults
from echocal.diagnose.findings.parts import Cause, Parameter, Traces, Verdict
from echocal.diagnose.inference.case import Case
from echocal.diagnose.progress import Steps
from echocal.diagnose.results.level_steps import steps_of
from echocal.diagnose.results.notes import because, notes
from echocal.diagnose.results.result import Diagnosis
from echocal.diagnose.selection.claims import Claim, alternatives, parameters
from echocal.diagnose.selection.infer import Belief, believe
from echocal.diagnose.selection.joint import NAMED, Joint, join
from echocal.diagnose.validation.gain import errors
from echocal.diagnose.validation.refute import Judgment, judge
from echocal.diagnose.validation.unexplained_term import with_its_shape
from echocal.errors import DomainWarning
from echocal.observations import Observations
from echocal.registry import find_effect

__all__ = ["conclude"]

_CREDIBLE = 0.95


def conclude(
    case: Case,
    observations: Observations,
    faults: Faults,
    can_vary: Ranges | None,
    start: float,
    work: Steps,
) -> Diagnosis:
    """Weigh, claim, judge, and say it."""
    belief = believe(case, faults, work)
    work.begin("judging on rows never fitted")
    judgment = judge(case, belief.best, belief.claims, belief.noise)
    joint = join(belief.ranking, faults.found, belief.shares, belief.carried)
    work.begin("planning measurements")
    possible = members(case, belief.ranking, belief.listed, judgment, belief.carried)
    kept = [claim.cause for claim in judgment.kept]
    remainder = belief.remainder
    verdict = _verdict(judgment, belief, joint)
    return Diagnosis(
        verdict=verdict,
        causes=_causes(case, belief, judgment, joint, verdict),
        posterior=tuple(joint.sets.items()),
        credible_set=_credible(joint),
        unexplained=remainder and with_its_shape(case, remainder, judgment, belief.noise),
        refuted=judgment.refuted,
        gain=judgment.gain,
        next_measurements=propose(case, possible, kept, belief.noise, belief.best.variance, can_vary),
        rows=_rows(case, observations),
        base=case.base.to_dict(),
        noise=_noise(belief),
        notes=(
            *belief.varying.values(),
            *_passed_over(belief, judgment),
            *notes(case, observations, judgment, belief.stack),
            *_outside(case, len(observations), judgment),
        ),
        seconds=time.perf_counter() - start,
        model=judgment.model,
        traces=_traces(case, judgment),
        members=possible,
    )


def _causes(
    case: Case, belief: Belief, judgment: Judgment, joint: Joint, verdict: Verdict
) -> tuple[Cause, ...]:
    others = alternatives(belief.ranking, belief.listed) if verdict == "ambiguous" else []
    return (
        *(_cause(case, claim, judgment, belief.varying.get(claim.cause, "")) for claim in judgment.kept),
        *(_cause(case, claim, judgment) for claim in others),
        *joint.causes,
    )


def _passed_over(belief: Belief, judgment: Judgment) -> list[str]:
    """Say why a cause that is likely in the posterior is none of the claims."""
    told = {id_ for claim in belief.claims for id_ in (claim.cause, *claim.rivals)}
    told |= {*belief.varying, *(refuted.id for refuted in judgment.refuted)}
    likely = sorted({id_ for ids, _ in belief.ranking.sets for id_ in ids} - {UNKNOWN, *told})
    return [
        f"{id_} is likely in the posterior and not claimed: beside what nobody explains, a second smooth "
        "shape or an offset explains these rows as well"
        for id_ in likely
        if belief.remainder is not None and belief.ranking.of([id_]) >= NAMED
    ]


def _rows(case: Case, observations: Observations) -> dict[str, Any]:
    return {
        "total": len(observations),
        "used": len(case.table),
        "unusable": dict(case.table.unusable),
        "level_steps_at_rows": (case.table.steps + 1).tolist(),
        "level_steps": steps_of(case.table, observations),
    }


def _noise(belief: Belief) -> dict[str, float]:
    return {
        "standard_deviation_m": belief.best.variance**0.5,
        "autoregression": belief.noise.rho,
        "moving_average": belief.noise.memory,
        "growth_with_distance": belief.noise.growth,
        "stand_variance_ratio": belief.noise.stand_ratio,
    }


def _verdict(judgment: Judgment, belief: Belief, joint: Joint) -> Verdict:
    """What is to be said first.

    A noise or a fault of rows is no answer where something shifts the readings and no cause of that
    is claimed, or none that has one size: then it is listed, and the shift stays open. Where something
    shifts the readings, the verdict is not `nothing` either, even if held-out rows refute every cause.
    """
    steady = [c.probability for c in judgment.kept if c.cause not in belief.varying]
    if any(probability >= NAMED for probability in steady):
        return "named"
    is_open = len(steady) < len(judgment.kept) or (not judgment.kept and _shifted(belief))
    if not is_open and any(f.probability >= NAMED for f in joint.telling):
        return "named"
    if belief.remainder is not None:
        return "unknown"
    return "ambiguous" if is_open or judgment.kept or joint.telling else "nothing"


def _shifted(belief: Belief) -> bool:
    """Whether the rows that were fitted leave no doubt that something shifts the readings."""
    return sum(p for ids, p in belief.ranking.sets if not ids) < 1 - NAMED


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
        before=errors(table, case.base.plain, fit),
        after=errors(table, judgment.model, fit),
        held_out=~fit,
        against=table.against(),
    )
