"""The model that all tables share, and the model of each table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, fit_hypothesis
from echocal.diagnose.pooling.choice import SharedClaim
from echocal.diagnose.pooling.search import Pool, SharedSet
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.selection.claims import columns_of, covariance_of, effects_of, parameters
from echocal.diagnose.validation.gain import HeldOut, errors
from echocal.diagnose.validation.residual_uncertainty import residual_uncertainty
from echocal.model import Model
from echocal.registry import find_effect

__all__ = ["Sizes", "model_of_table", "shared_model"]

Array = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Sizes:
    """Sizes of a shared set: a mean and its covariance, in the units of the forms."""

    mean: Array
    covariance: Array

    def of(self, shared: SharedSet, cause: str) -> tuple[Array, Array]:
        """Sizes of one cause and their standard uncertainties."""
        place = _places(shared)[cause]
        return self.mean[place], np.sqrt(np.diag(self.covariance))[place]


def _places(shared: SharedSet) -> dict[str, slice]:
    ends = np.cumsum([0, *(len(form.names) for form in shared.forms)])
    return {form.cause: slice(ends[i], ends[i + 1]) for i, form in enumerate(shared.forms)}


def hypothesis_of(pool: Pool, shared: SharedSet, sizes: Sizes, table: TableInference | None) -> HypothesisFit:
    """The shared causes as a hypothesis, without those of which tables share only the name.

    With a table, without those that it has no columns for.
    """
    places = _places(shared)
    variants: list[Variant] = []
    at: list[int] = []
    for form in (form for form in shared.forms if not form.is_by_name):
        if table is not None and not table.can_have(form.cause):
            continue
        first = () if table is None else (table,)
        source = next(one for one in (*first, *pool.tables) if one.of_forms(form))
        own = source.of_forms(form)[0]
        free = tuple(range(len(at), len(at) + len(form.names)))
        at += list(range(places[form.cause].start, places[form.cause].stop))
        variants.append(
            Variant(
                form.cause, own.at, own.offset, free, form.names, form.scales, form.bounds, bound=own.bound
            )
        )
    covariance = sizes.covariance[np.ix_(at, at)]
    return HypothesisFit(Hypothesis(tuple(variants), 1.0), 0.0, sizes.mean[at], covariance, np.ones(1), 1.0)


def shared_model(
    pool: Pool,
    shared: SharedSet,
    provenance: Mapping[str, Any],
    tables: Sequence[int],
    use: TableInference | None = None,
) -> Model:
    """Base and shared causes, with the sizes that some tables share; if given, for the use in one table."""
    some = np.zeros(len(pool.tables), dtype=bool)
    some[list(tables)] = True
    population = shared.population if some.all() else pool.population(shared.forms, some)
    fit = hypothesis_of(pool, shared, Sizes(population.mean, population.covariance), use)
    return _model([pool.tables[place] for place in tables], fit, provenance)


def _model(tables: Sequence[TableInference], fit: HypothesisFit, provenance: Mapping[str, Any]) -> Model:
    """Base and causes; air that is not measured is the median of the tables."""
    base = tables[0].base
    airs = [table.table.air() for table in tables]
    names = sorted({name for air in airs for name in air})
    medians = {name: float(np.median([air[name] for air in airs if name in air])) for name in names}
    effects = effects_of(fit)
    unknown = {name for id_ in effects for name in find_effect(id_).excludes}
    medians = {name: value for name, value in medians.items() if name not in unknown}
    own = type(base)(base.law, base.effects, {**base.air, **medians}, base.device_speed)
    places = own.model(effects).parameter_names
    covariance = covariance_of(fit, places) if places else None
    return own.model(effects, covariance=covariance, provenance=dict(provenance), columns=columns_of(fit))


def model_of_table(
    pool: Pool,
    shared: SharedSet,
    claims: Sequence[SharedClaim],
    place: int,
    provenance: Mapping[str, Any],
) -> tuple[Model, Sizes]:
    """Base, shared causes with the sizes of this table, and causes that are its own.

    The sizes of shared causes are drawn to their mean; the others are fitted beside them.
    """
    table = pool.tables[place]
    population = shared.population
    means, covariances = population.sizes(pool.likelihoods(shared.forms))
    sizes = Sizes(means[place], covariances[place])
    spoken = [form for form in shared.forms if pool.speaks(table, form.cause)]
    fit = _with_own(table, spoken, {id_ for claim in claims for id_ in (claim.cause, *claim.rivals)})
    places = _places(shared)
    given, units, at = [], [], []
    for variant, own in fit.hypothesis.placed:
        form = next((form for form in spoken if form.cause == variant.cause and form.names), None)
        if form is not None:
            at += [own.start + i for i in range(len(form.names))]
            given += list(range(places[form.cause].start, places[form.cause].stop))
            units += [a / b for a, b in zip(form.scales, variant.scales, strict=False)]
    unit = np.array(units)
    drawn = sizes.covariance[np.ix_(given, given)] * unit[:, None] * unit
    fit = _conditioned(fit, at, sizes.mean[given] * unit, drawn)
    model = _model([table], fit, provenance)
    rows = table.table.rows
    left = HeldOut(errors(rows, model, np.ones(len(rows), dtype=bool)))
    residual = residual_uncertainty(rows, model, left, "the rows of the table")
    return model.with_residual_uncertainty(residual), sizes


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


def values(shared: SharedSet, cause: str, table: TableInference, size: Array) -> dict[str, float]:
    """Parameters of a shared cause, in SI units."""
    form = next(form for form in shared.forms if form.cause == cause)
    own = table.of_forms(form)[0]
    variant = Variant(cause, own.at, names=form.names, scales=form.scales, bounds=form.bounds)
    return parameters(variant, size)
