"""From the results of the stages to the diagnosis that a user gets."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.findings.parts import (
    Cause,
    NextMeasurement,
    Parameter,
    Remainder,
    SmoothCorrection,
    Traces,
    Verdict,
)
from echocal.diagnose.findings.sentences import Recorded
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.matters import Matters, contribution
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.results.because import because
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.results.fates import Fates
from echocal.diagnose.results.level_steps import LevelStep, steps_of
from echocal.diagnose.results.notes import hidden_causes, notes
from echocal.diagnose.selection.claims import Claim, Ranking, alternatives, parameters
from echocal.diagnose.selection.joint import Joint
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.gain import errors
from echocal.diagnose.validation.judges import HeldOutRows, Judge
from echocal.diagnose.validation.unexplained_term import with_its_function
from echocal.diagnose.validation.validate import Validation
from echocal.diagnose.verdict import credible_set, verdict
from echocal.errors import DomainWarning
from echocal.model import Model
from echocal.model.indicated_speed import INDICATION_SPEED
from echocal.observations import Observations
from echocal.observations.mount import HEIGHT_FITTED, MOUNT_HEIGHT
from echocal.registry import find_effect

__all__ = ["report"]


def report(
    case: Case,
    observations: Observations,
    inference: Inference,
    ranking: Ranking,
    selection: Selection,
    validation: Validation,
    judge: Judge,
    joint: Joint,
    smooth: SmoothCorrection | None,
    left: Remainder | None,
    members: tuple[Member, ...],
    proposals: tuple[NextMeasurement, ...],
    matters: Matters,
) -> Diagnosis:
    """Put the results together."""
    word = verdict(ranking, selection, validation, joint, left, moving=bool(case.moving))
    term, noise = selection.term, selection.noise
    steps = steps_of(case.table, observations)
    fates = Fates.of(case.table, judge.held)
    causes = _causes(case, inference.reduced, ranking, selection, validation, joint, word)
    causes = tuple(replace(cause, matters=matters.told(cause)) for cause in causes)
    origin = {**validation.model.provenance, **_origin(causes, word)}
    if case.base.device_speed is not None:
        origin[INDICATION_SPEED] = case.base.reading_speed
    if observations.reading_speed:
        origin["reading_speed"] = observations.reading_speed
    if observations.mount_height is not None:
        origin[MOUNT_HEIGHT] = observations.mount_height
        origin[HEIGHT_FITTED] = observations.mount_height_fitted
    validation = replace(validation, model=validation.model.with_provenance(origin))
    unexplained = term and with_its_function(case, term, validation, judge, noise)
    shown = left if term is None and word in ("unknown", "nothing") else None
    return Diagnosis(
        verdict=word,
        causes=causes,
        posterior=tuple(joint.sets.items()),
        credible_set=credible_set(joint.sets.items(), case.settings.claims.credible),
        unexplained=unexplained,
        smooth=smooth,
        remainder=shown,
        refuted=validation.refuted,
        gain=validation.gain,
        next_measurements=proposals,
        rows=_rows(case.table, fates, steps),
        base=case.base.to_dict(),
        noise=_noise(selection),
        notes=(
            *_slow_noise(case, ranking, selection),
            *([left.turns] if left is not None and left.turns and shown is None else []),
            *notes(case, observations, validation, inference.stack, steps),
            *_outside(case.table.rows, validation),
        ),
        settings=case.settings,
        model=validation.model,
        traces=replace(_traces(case, judge, validation.model), begin=_begin(observations)),
        fates=fates,
        members=members,
        moved=case.moving,
        hidden=hidden_causes(case),
        matters_mm=1e3 * matters.difference_m,
        matters_because=matters.because,
        good_enough=matters.good_enough(word, causes, unexplained, shown),
    )


def _causes(
    case: Case,
    stack: Stack,
    ranking: Ranking,
    selection: Selection,
    validation: Validation,
    joint: Joint,
    word: Verdict,
) -> tuple[Cause, ...]:
    recorded = Recorded(case.table.against())
    others = alternatives(ranking, selection.claims, case.found, stack) if word == "ambiguous" else []
    refuted = {one.id for one in validation.refuted}
    told = {claim.cause for claim in validation.claims}
    others = [claim for claim in others if claim.cause not in refuted | told]
    return (
        *(
            _cause(case, ranking, claim, validation, recorded, validation.doubts.get(claim.cause, ""))
            for claim in validation.claims
        ),
        *(_cause(case, ranking, claim, validation, recorded) for claim in others),
        *joint.causes,
    )


def _origin(causes: Sequence[Cause], word: Verdict) -> dict[str, Any]:
    """What a model says of its diagnosis: the class and the member of each of its causes."""
    told = ("id", "probability", "probability_alone", "indistinguishable_from", "doubt")
    effects = [cause for cause in causes if cause.kind == "effect" and cause.in_model]
    return {"verdict": word, "causes": [{name: getattr(c, name) for name in told} for c in effects]}


def _cause(
    case: Case,
    ranking: Ranking,
    claim: Claim,
    validation: Validation,
    recorded: Recorded,
    doubt: str = "",
) -> Cause:
    in_model = claim in validation.kept
    value = validation.model.effects[claim.cause] if in_model else parameters(claim.variant, claim.mean)
    uncertainty = _uncertainties(claim, validation.model if in_model else None)
    values = tuple(
        Parameter(p.name, value[p.name], uncertainty.get(p.name, 0.0), p.unit)
        for p in find_effect(claim.cause).parameters
        if p.name in value
    )
    text = because(case, claim, validation, recorded)
    text += "".join(f"; the further thermometer is the column {column}" for _, column in claim.variant.bound)
    alone = min(ranking.of([claim.cause]), claim.probability)
    most = contribution(case, claim)
    return Cause(
        claim.cause, "effect", claim.probability, values, claim.rivals, text, in_model, doubt, alone, most
    )


def _uncertainties(claim: Claim, model: Model | None) -> dict[str, float]:
    """Standard uncertainties of the parameters of a claim: those of the model, if it is in one.

    They have what all rows share, too (type B). The model has not: its corrected distances agree with the
    reference, whatever part of the correction is an error of the reference or of the law.
    """
    variant, scales = claim.variant, np.array(claim.variant.scales)
    of_rows, of_all = (one[: len(scales)] * scales for one in (claim.deviation, claim.type_b))
    found = dict(zip(variant.names, of_rows.tolist(), strict=False))
    if model is not None:
        known = model.standard_uncertainties
        found = {name: known[f"{claim.cause}.{name}"] or 0.0 for name in model.effects[claim.cause]}
    shared = dict(zip(variant.names, of_all.tolist(), strict=False))
    return {name: float(np.hypot(own, shared.get(name, 0.0))) for name, own in found.items()}


def _slow_noise(case: Case, ranking: Ranking, selection: Selection) -> list[str]:
    """Say that few rows show no more than slow noise, where an effect would be claimed otherwise."""
    slow, none, limit = selection.slow, ranking.of_set(()), case.settings.priors.no_cause
    if slow is None or none >= limit or slow.no_effect < limit:
        return []
    return [
        f"an effect has a probability of {1 - none:.2f}, but none is claimed: {len(case.table)} rows do not "
        "separate it from noise that follows the rows before, with a coefficient of "
        f"{slow.rho:.2f}. To separate them, measure the same conditions again in another order, or at a "
        "second distance"
    ]


def _rows(table: Table, fates: Fates, steps: Sequence[LevelStep]) -> dict[str, Any]:
    return {
        "total": table.total,
        "used": fates.used,
        "unusable": dict(fates.counts),
        "level_steps_at_rows": (table.steps + 1).tolist(),
        "level_steps": tuple(steps),
    }


def _noise(selection: Selection) -> dict[str, float]:
    noise = selection.noise
    return {
        "standard_deviation_m": selection.best.variance**0.5,
        "autoregression": noise.rho,
        "moving_average": noise.moving_average,
        "growth_with_distance": noise.growth,
        "stand_variance_ratio": noise.station_ratio,
    }


def _outside(table: Table, validation: Validation) -> list[str]:
    """Rows of the source in which the extended model is outside the domain of its law."""

    def spread(column: NDArray[np.float64]) -> NDArray[np.float64]:
        if len(column) == table.total:
            return column
        whole = np.full(table.total, np.nan)
        whole[table.row] = column
        return whole

    given = {**table.conditions, **table.bound(validation.model)}
    recorded = {name: spread(column) for name, column in given.items()}
    with warnings.catch_warnings(action="always", record=True) as caught:
        validation.model.speed_of_sound(1.0, **recorded)
    return list(dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, DomainWarning)))


def _traces(case: Case, judge: Judge, model: Model) -> Traces:
    table = case.table.rows
    rows = np.ones(len(table), dtype=bool)
    before, after = (errors(table, one, rows) for one in (case.base.plain, model))
    traces = Traces(table.row, before, after, ~rows, table.against())
    if not isinstance(judge, HeldOutRows):
        return traces
    held, (before, after) = judge.held.rows, (judge.errors(one) for one in (case.base.plain, model))
    return _joined(traces, Traces(held.row, before, after, np.ones(len(held), dtype=bool), held.against()))


def _begin(observations: Observations) -> np.datetime64 | None:
    """The instant that elapsed time counts from."""
    if observations.time is None or np.isnat(observations.time).all():
        return None
    begin: np.datetime64 = np.nanmin(observations.time).astype("datetime64[ms]")
    return begin


def _joined(one: Traces, other: Traces) -> Traces:
    """Both, in the order of the source, with the columns that both have."""
    order = np.argsort(np.concatenate([one.row, other.row]), kind="stable")

    def join(*parts: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate(parts)[order]

    return Traces(
        row=join(one.row, other.row),
        before=join(one.before, other.before),
        after=join(one.after, other.after),
        held_out=join(one.held_out, other.held_out),
        against={n: join(one.against[n], other.against[n]) for n in one.against if n in other.against},
    )
