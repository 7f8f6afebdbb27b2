"""The pool on one screen: from the inference of each table to the pooled diagnosis."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Gain, Parameter, Verdict
from echocal.diagnose.pooling.choice import Choice, SharedClaim, choose
from echocal.diagnose.pooling.explain import recurrence
from echocal.diagnose.pooling.hierarchy import Sizes
from echocal.diagnose.pooling.models import model_of_table, shared_model
from echocal.diagnose.pooling.parts import (
    InTable,
    PooledCause,
    PooledParameter,
    Role,
    SkippedTable,
    TableResult,
)
from echocal.diagnose.pooling.result import PooledDiagnosis
from echocal.diagnose.pooling.search import Pool, SharedSet, search
from echocal.diagnose.pooling.shared_forms import SharedForm
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.pooling.transfer import transfer
from echocal.diagnose.selection.claims import parameters, posterior_sets
from echocal.diagnose.settings import Settings
from echocal.diagnose.verdict import credible_set
from echocal.registry import find_effect

__all__ = ["pooled"]

Array = NDArray[np.floating[Any]]


def pooled(
    tables: Sequence[TableInference], skipped: tuple[SkippedTable, ...], settings: Settings, seed: int
) -> PooledDiagnosis:
    """Compare the sets of causes that the tables may share, claim, judge on tables left out, and size."""
    pool = Pool(tables, settings)
    sets = search(pool)
    choice = choose(pool, sets)
    by_size = [form.cause for form in choice.best.forms if not form.is_by_name]
    gain, transfers, residual = transfer(pool, sets, by_size, seed)
    refuted = bool(by_size) and gain.rms_after_m > gain.rms_before_m
    modeled = pool.evaluated(()) if refuted else choice.best
    claims = () if refuted else choice.claims
    taken = {id_ for claim in claims for id_ in (claim.cause, *claim.rivals)}
    provenance = {"made_by": "echocal diagnose", "tables": [table.name for table in tables]}
    results: dict[str, TableResult] = {}
    for place, table in enumerate(tables):
        model = model_of_table(pool, modeled, claims, place, {**provenance, "of": table.name})
        own = tuple(c.id for c in table.diagnosis.causes if c.kind == "effect" and c.in_model)
        own = tuple(id_ for id_ in own if id_ not in taken)
        results[table.name] = TableResult(table.diagnosis, model, own, transfers[place])
    drawn = choice.best.population.drawn(pool.likelihoods(choice.best.forms))
    causes = tuple(_cause(pool, choice.best, claim, drawn, gain, refuted=refuted) for claim in choice.claims)
    model = shared_model(pool, modeled, {**provenance, "gain": asdict(gain)}, range(len(tables)))
    return PooledDiagnosis(
        verdict=_verdict(pool, choice, causes),
        causes=causes,
        posterior=tuple(posterior_sets(choice.ranking).items()),
        credible_set=credible_set(choice.ranking.sets, settings.claims.credible),
        gain=gain,
        tables=results,
        skipped=skipped,
        base=tables[0].base.to_dict(),
        notes=tuple(_notes(pool, results)),
        settings=settings,
        model=model.with_residual_uncertainty(residual),
    )


def _cause(
    pool: Pool, shared: SharedSet, claim: SharedClaim, drawn: Sequence[Sizes], gain: Gain, *, refuted: bool
) -> PooledCause:
    form, population = shared.form(claim.cause), shared.population
    each = _in_tables(pool, shared, claim.cause, drawn)
    recurs = tuple(one.table for one in each if one.role == "supports")
    tested = sum(one.role != "not tested" for one in each)
    place = shared.place(claim.cause)
    parameters: tuple[PooledParameter, ...] = ()
    if not form.is_by_name:
        table = next(table for table in pool.tables if table.of_forms(form))
        size, deviation = population.mean.mean[place], population.mean.deviation[place]
        between = dict(zip(form.names, population.between[place] * form.scales, strict=True))
        parameters = tuple(
            PooledParameter(p.name, p.value, p.standard_uncertainty, p.unit, between.get(p.name, 0.0))
            for p in _parameters(form, table, size, deviation)
        )
    return PooledCause(
        id=claim.cause,
        kind="effect",
        probability=claim.probability,
        parameters=parameters,
        indistinguishable_from=claim.rivals,
        because=recurrence(each),
        in_model=not (refuted or form.is_by_name),
        doubt=_doubt(pool, shared, form, (len(recurs), tested), gain, refuted=refuted),
        probability_alone=claim.alone,
        shares="name" if form.is_by_name else "sizes",
        tables=each,
        recurs_in=recurs,
        tested_in=tested,
    )


def _doubt(
    pool: Pool, shared: SharedSet, form: SharedForm, recurs: tuple[int, int], gain: Gain, *, refuted: bool
) -> str:
    largest = float(np.abs(shared.population.mean.mean[shared.place(form.cause)]).max(initial=0.0))
    low, high = (1e3 * end for end in gain.interval_95)
    if recurs[0] < pool.settings.pooling.fewest_tables:
        return f"only {recurs[0]} of {recurs[1]} tables that test it support it by themselves"
    if largest > pool.settings.claims.implausible:
        return f"its mean size is {largest:.2g} times the usual one"
    if form.is_by_name:
        return "tables share only its name; the gain of each table must judge it"
    if refuted:
        return (
            f"on tables left out, the shared causes increase the error from {1e3 * gain.rms_before_m:.2f} to "
            f"{1e3 * gain.rms_after_m:.2f} mm, so the shared model is the base"
        )
    if not gain.earned:
        return (
            f"on tables left out, the shared causes gain {low:.2f} to {high:.2f} mm over the base (95 % "
            "interval), which is not above 0"
        )
    return ""


def _in_tables(pool: Pool, shared: SharedSet, cause: str, drawn: Sequence[Sizes]) -> tuple[InTable, ...]:
    less = pool.evaluated(tuple(form for form in shared.forms if form.cause != cause))
    form, place = shared.form(cause), shared.place(cause)
    likelihoods = pool.likelihoods((form,))
    found = []
    for number, table in enumerate(pool.tables):
        log = _own_part(shared, number) - _own_part(less, number)
        role, why = _role(table, cause, log, pool.settings.pooling.speaks)
        alone: tuple[Parameter, ...] = ()
        pooled: tuple[Parameter, ...] = ()
        if cause in table.competing and not form.is_by_name:
            precision = likelihoods.precision[number] + 1e-6 * np.eye(len(form.names))  # flat: very uncertain
            covariance = np.linalg.inv(precision)
            own = Sizes(covariance @ likelihoods.information[number], covariance)
            alone = _parameters(form, table, own.mean, own.deviation)
            pooled = _parameters(form, table, drawn[number].mean[place], drawn[number].deviation[place])
        found.append(InTable(table.name, role, log, alone, pooled, why))
    return tuple(found)


def _own_part(shared: SharedSet, place: int) -> float:
    """Log evidence of a table, given the others."""
    return shared.population.log_evidence - float(shared.others[place])


def _role(table: TableInference, cause: str, log: float, least: float) -> tuple[Role, str]:
    if cause not in table.competing:
        return "not tested", table.skipped.get(cause, "not tried")
    if abs(log) < least:
        return "undecided", ""
    return ("supports" if log > 0.0 else "contradicts"), ""


def _parameters(
    form: SharedForm, table: TableInference, size: Array, deviation: Array
) -> tuple[Parameter, ...]:
    """Parameters of a shared cause in a table, in SI units."""
    value = parameters(form.variant(0, table.of_forms(form)[0]), size)
    uncertain = dict(zip(form.names, (deviation * form.scales).tolist(), strict=True))
    return tuple(
        Parameter(p.name, value[p.name], uncertain.get(p.name, 0.0), p.unit)
        for p in find_effect(form.cause).parameters
        if p.name in value
    )


def _verdict(pool: Pool, choice: Choice, causes: Sequence[PooledCause]) -> Verdict:
    claims = pool.settings.claims
    if any(cause.probability >= claims.named and not cause.doubt for cause in causes):
        return "named"
    terms = [t.diagnosis.unexplained.against for t in pool.tables if t.diagnosis.unexplained is not None]
    if (
        not causes
        and max((terms.count(name) for name in terms), default=0) >= pool.settings.pooling.fewest_tables
    ):
        return "unknown"
    shared = sum(p for ids, p in choice.ranking.sets if ids)
    return "ambiguous" if causes or shared > claims.named else "nothing"


def _notes(pool: Pool, results: dict[str, TableResult]) -> list[str]:
    """Causes of the tables' own, and columns of unexplained terms that recur."""
    own: dict[str, list[str]] = {}
    for name, result in results.items():
        for id_ in result.own_causes:
            own.setdefault(id_, []).append(name)
    said = [f"{id_} is a cause of {_listed(names)} alone" for id_, names in own.items()]
    terms: dict[str, list[str]] = {}
    for table in pool.tables:
        if table.diagnosis.unexplained is not None:
            terms.setdefault(table.diagnosis.unexplained.against, []).append(table.name)
    said += [
        f"an unexplained term against {against} is in {_listed(names)}" for against, names in terms.items()
    ]
    return said


def _listed(names: Sequence[str], most: int = 6) -> str:
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} others"
