"""The verdict, and everything that a person is told about it."""

import time
import warnings

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.alias import Geometry
from echocal.diagnose.claims import Claim, Ranking, alternatives, claims, parameters, posterior_sets, rank
from echocal.diagnose.gain import errors
from echocal.diagnose.hypotheses import posterior
from echocal.diagnose.judge import Judgment, judge
from echocal.diagnose.next_measurements import propose
from echocal.diagnose.notes import because, notes, unexplained
from echocal.diagnose.result import Cause, Diagnosis, Parameter, Traces, Verdict
from echocal.diagnose.study import Study
from echocal.errors import DomainWarning
from echocal.observations import Observations
from echocal.registry import find_effect

__all__ = ["conclude"]

NAMED = 0.9
"""Probability of one class from which on it is named."""

_CREDIBLE = 0.95


def conclude(study: Study, observations: Observations, start: float) -> Diagnosis:
    """Weigh, claim, judge, and say it."""
    stack = study.stack(study.folds.fit)
    weighed, carried = posterior(study.found, stack)
    ranking = rank(weighed)
    best = ranking.best()
    noise, products = carried.likeliest(best)
    claimed = claims(ranking, study.found, Geometry(products, best.variance))
    believed = [c for c in claimed if c.probability >= 0.5]  # the rest is listed, not modeled
    judgment = judge(study, best, believed or claimed, noise)
    remainder = unexplained(study, ranking)
    verdict = _verdict(ranking, judgment, remainder is not None)
    with warnings.catch_warnings(action="always", record=True) as caught:
        traces = _traces(study, judgment)
    outside = dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, DomainWarning))
    others = alternatives(ranking, claimed) if verdict == "ambiguous" else []
    return Diagnosis(
        verdict=verdict,
        causes=tuple(_cause(study, claim, judgment) for claim in (*judgment.kept, *others)),
        posterior=tuple(posterior_sets(ranking).items()),
        credible_set=_credible(ranking),
        unexplained=remainder,
        refuted=judgment.refuted,
        gain=judgment.gain,
        next_measurements=propose(study, judgment, others, best.variance),
        rows={
            "total": len(observations),
            "used": len(study.table),
            "unusable": dict(study.table.unusable),
            "level_steps_at_rows": study.table.steps.tolist(),
        },
        base=study.base.to_dict(),
        noise={
            "standard_deviation_m": best.variance**0.5,
            "autoregression": noise.rho,
            "moving_average": noise.memory,
            "stand_variance_ratio": noise.stand_ratio,
        },
        notes=(*notes(study, observations, judgment, stack), *outside),
        seconds=time.perf_counter() - start,
        model=judgment.model,
        traces=traces,
    )


def _verdict(ranking: Ranking, judgment: Judgment, remainder: bool) -> Verdict:
    if any(claim.probability >= NAMED for claim in judgment.kept):
        return "named"
    if remainder:
        return "unknown"
    return "ambiguous" if judgment.kept else "nothing"


def _credible(ranking: Ranking) -> tuple[tuple[str, ...], ...]:
    total, chosen = 0.0, []
    for ids, p in ranking.sets:
        chosen.append(ids)
        total += p
        if total >= _CREDIBLE:
            break
    return tuple(chosen)


def _cause(study: Study, claim: Claim, judgment: Judgment) -> Cause:
    in_model = claim in judgment.kept
    value = judgment.model.effects[claim.cause] if in_model else parameters(claim.variant, claim.mean)
    uncertainty = dict(zip(claim.variant.names, claim.deviation * claim.variant.scales, strict=False))
    values = tuple(
        Parameter(p.name, value[p.name], float(uncertainty.get(p.name, 0.0)), p.unit)
        for p in find_effect(claim.cause).parameters
        if p.name in value
    )
    text = because(study, claim, judgment)
    return Cause(claim.cause, "effect", claim.probability, values, claim.rivals, text, in_model)


def _traces(study: Study, judgment: Judgment) -> Traces:
    table = study.table
    fit: NDArray[np.bool_] = study.folds.fit[study.folds.blocks]
    return Traces(
        row=table.row,
        before=errors(table, study.base.model(), fit),
        after=errors(table, judgment.model, fit),
        held_out=~fit,
        against=table.against(),
    )
