"""Which causes are claimed to be shared: the rules of a single table, with classes over all tables."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.visible import INVISIBLE
from echocal.diagnose.pooling.search import Pool, SharedSet
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.selection.claims import Ranking
from echocal.diagnose.selection.decision import is_claimed

__all__ = ["Choice", "SharedClaim", "choose"]

_SHOWS = 1.0  # signal over noise, summed over rows, below which a table cannot separate anything


@dataclass(frozen=True)
class SharedClaim:
    """A cause that all tables are claimed to share.

    Attributes
    ----------
    rivals : tuple of str
        Causes that no table separates from it.
    probability, alone : float
        Of the class, and of the cause.
    """

    cause: str
    rivals: tuple[str, ...]
    probability: float
    alone: float


@dataclass(frozen=True)
class Choice:
    """The claims and the set that they belong to."""

    ranking: Ranking
    best: SharedSet
    claims: tuple[SharedClaim, ...]


def choose(pool: Pool, sets: Sequence[SharedSet], without: int | None = None) -> Choice:
    """Claim shared causes by docs/method.md, Eq. 25, from all tables or without one."""
    ranking = pool.ranking(sets, without)
    of_hypothesis = {id(one.hypothesis): one for one in sets}
    best = pool.evaluated(())
    if (first := ranking.best()) is not None:
        best = of_hypothesis[id(first.hypothesis)]
    threshold = _threshold(pool)
    while (found := ranking.best(best.hypothesis.effects)) is not None:
        grown, ids = of_hypothesis[id(found.hypothesis)], best.hypothesis.effects
        (more,) = grown.causes - best.causes
        if not is_claimed(ids, *ranking.more(ids, (more, *rivals(pool, grown, more))), threshold):
            break
        best = grown
    claims = []
    for cause in best.causes:
        others = rivals(pool, best, cause)
        claims.append(SharedClaim(cause, others, ranking.of([cause, *others]), ranking.of([cause])))
    return Choice(ranking, best, tuple(sorted(claims, key=lambda claim: -claim.probability)))


def _threshold(pool: Pool) -> float:
    """Probability of no shared cause below which one is claimed: the strictest of the tables."""
    few = sum(len(table.table) for table in pool.tables) < pool.settings.claims.few_rows
    prior = [pool.settings.priors.no_cause] if few else []
    return min([*(table.threshold for table in pool.tables), *prior])


def rivals(pool: Pool, shared: SharedSet, cause: str) -> tuple[str, ...]:
    """Causes that imitate a shared cause in every table that shows it."""
    key = frozenset(shared.forms), cause
    if key not in pool.rivals:
        tables = [table for table in pool.tables if cause in table.competing]
        separated = [_separated(table, shared, cause, len(tables)) for table in tables]
        shown = [ids for ids in separated if ids is not None]
        others = set(pool.forms) - shared.causes - set().union(*shown)
        pool.rivals[key] = tuple(sorted(others)) if shown else ()
    return pool.rivals[key]


def _separated(table: TableInference, shared: SharedSet, cause: str, count: int) -> set[str] | None:
    """Causes that one table of several separates from a shared one; None if it does not show it.

    The log odds of the tables add up, so each may have its part of the limit.
    """
    forms = tuple(form for form in shared.forms if form.cause in table.competing)
    fit = table.with_forms(forms)[0]
    geometry = Geometry(table.reduced.likeliest(fit)[1], fit.variance)
    sizes = fit.mean.copy()
    places = {variant.cause: place for variant, place in fit.hypothesis.placed}
    for form, place, unit in table.shared(forms, fit.hypothesis):
        sizes[places[form.cause]] = 0.0  # also the columns of a law, which each table has for itself
        sizes[place] = shared.population.mean.mean[shared.place(form.cause)] * unit
    beside = np.zeros(len(geometry.products))
    signal: NDArray[np.floating[Any]] = np.zeros(len(beside))
    for variant, place in fit.hypothesis.placed:
        if variant.cause == cause:
            signal = geometry.signal(variant, sizes[place])
        elif variant.cause != UNKNOWN:
            beside[list(variant.free)] = sizes[place]
    if geometry.visibility(signal) < _SHOWS:
        return None
    others: dict[str, list[Variant]] = {}
    for variant in table.variants:
        if variant.cause != UNKNOWN and variant.cause not in shared.causes:
            others.setdefault(variant.cause, []).append(variant)
    claims = table.settings.claims
    alike = geometry.rivals(signal, others, beside, replace(claims, separable=claims.separable / count))
    unseen = {id_ for id_, why in table.skipped.items() if why == INVISIBLE}
    return (set(others) - set(alike)) | unseen
