"""The model that all tables share, and the model of each table."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, fit_hypothesis
from echocal.diagnose.pooling.choice import SharedClaim
from echocal.diagnose.pooling.search import Pool, SharedSet
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.selection.claims import extended
from echocal.diagnose.validation.gain import HeldOut, errors
from echocal.diagnose.validation.residual_uncertainty import residual_uncertainty
from echocal.model import Model
from echocal.registry import find_effect

Array = NDArray[np.floating[Any]]

__all__ = ["model_of_table", "shared_model"]


def shared_model(
    pool: Pool,
    shared: SharedSet,
    provenance: Mapping[str, Any],
    tables: Sequence[int],
    use: TableInference | None = None,
) -> Model:
    """Base and shared causes, with the sizes that some tables share; if given, for the use in one table.

    Without causes of which tables share only the name, and those that the one table has no columns for.
    """
    some = np.zeros(len(pool.tables), dtype=bool)
    some[list(tables)] = True
    sizes = (shared.population if some.all() else pool.population(shared.forms, some)).mean
    variants: list[Variant] = []
    at: list[int] = []
    for form in shared.forms:
        if not form.is_by_name and (use is None or use.can_have(form.cause)):
            first = pool.tables if use is None else (use, *pool.tables)
            own = next(found for table in first for found in table.of_forms(form))
            variants.append(form.variant(len(at), own))
            place = shared.place(form.cause)
            at += range(place.start, place.stop)
    covariance = sizes.covariance[np.ix_(at, at)]
    hypothesis = Hypothesis(tuple(variants), 1.0)
    fit = HypothesisFit(hypothesis, 0.0, sizes.mean[at], covariance, np.ones(1), 1.0)
    return _model([pool.tables[place] for place in tables], fit, provenance)


def _model(tables: Sequence[TableInference], fit: HypothesisFit, provenance: Mapping[str, Any]) -> Model:
    """Base and causes; air that is not measured is the median of the tables."""
    base = tables[0].base
    airs = [table.table.air() for table in tables]
    names = sorted({name for air in airs for name in air})
    medians = {name: float(np.median([air[name] for air in airs if name in air])) for name in names}
    unknown = {name for id_ in fit.hypothesis.effects for name in find_effect(id_).excludes}
    medians = {name: value for name, value in medians.items() if name not in unknown}
    own = replace(base, air={**base.air, **medians})
    return extended(own, fit, provenance=dict(provenance))


def model_of_table(
    pool: Pool,
    shared: SharedSet,
    claims: Sequence[SharedClaim],
    place: int,
    provenance: Mapping[str, Any],
) -> Model:
    """Base, shared causes with the sizes of this table, and causes that are its own.

    The sizes of shared causes are drawn to their mean; the others are fitted beside them.
    """
    table = pool.tables[place]
    sizes = shared.population.drawn(pool.likelihoods(shared.forms))[place]
    spoken = [form for form in shared.forms if form.cause in table.competing]
    fit = _with_own(table, spoken, {id_ for claim in claims for id_ in (claim.cause, *claim.rivals)})
    given: list[int] = []
    at: list[int] = []
    units: list[float] = []
    for form, own, unit in table.shared(spoken, fit.hypothesis):
        of_set = shared.place(form.cause)
        given += range(of_set.start, of_set.stop)
        at += range(own.start, own.stop)
        units += unit.tolist()
    unit = np.array(units)
    drawn = sizes.covariance[np.ix_(given, given)] * unit[:, None] * unit
    fit = _conditioned(fit, at, sizes.mean[given] * unit, drawn)
    model = _model([table], fit, provenance)
    rows = table.table.rows
    left = HeldOut(errors(rows, model, np.ones(len(rows), dtype=bool)))
    residual = residual_uncertainty(rows, model, left, "the rows of the table")
    return model.with_residual_uncertainty(residual)


def _with_own(table: TableInference, spoken: Sequence[Any], taken: set[str]) -> HypothesisFit:
    """Fit the shared causes in their best form here, and the table's own causes in that of its diagnosis."""
    own_ids = {c.id for c in table.diagnosis.causes if c.kind == "effect" and c.in_model} - taken
    shared = {v.cause: v for v in table.with_forms(spoken)[0].hypothesis.variants} if spoken else {}
    variants = [shared[form.cause] for form in spoken]
    best = next((fit for fit in table.fits if own_ids <= set(fit.hypothesis.effects)), None)
    if best is not None:
        variants += [v for v in best.hypothesis.variants if v.cause in own_ids and v.cause != UNKNOWN]
    return fit_hypothesis(Hypothesis(tuple(variants), 1.0), table.reduced)


def _conditioned(fit: HypothesisFit, at: Sequence[int], mean: Array, covariance: Array) -> HypothesisFit:
    """A hypothesis, some of whose sizes have another distribution; the others follow."""
    if not len(at):
        return fit
    gain = fit.covariance[:, at] @ np.linalg.inv(fit.covariance[np.ix_(at, at)])
    moved = fit.mean + gain @ (mean - fit.mean[at])
    rest = fit.covariance - gain @ fit.covariance[at, :] + gain @ covariance @ gain.T
    return HypothesisFit(fit.hypothesis, fit.log_evidence, moved, rest, fit.noise, fit.variance)
