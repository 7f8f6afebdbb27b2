"""Which causes are claimed to be shared: the rules of a single table, with classes over all tables."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.visible import INVISIBLE
from echocal.diagnose.pooling.search import Pool, SharedRanking, SharedSet
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.selection.decision import is_claimed

__all__ = ["Choice", "Classes", "SharedClaim", "choose"]

_SHOWS = 1.0  # signal over noise, summed over rows, below which a table cannot separate anything


@dataclass(frozen=True)
class SharedClaim:
    """A cause that all tables are claimed to share.

    Attributes
    ----------
    cause : str
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

    ranking: SharedRanking
    best: SharedSet
    claims: tuple[SharedClaim, ...]


@dataclass
class Classes:
    """Causes that no table of a pool separates from a shared one.

    Attributes
    ----------
    pool : Pool
    known : dict
        Classes that were computed before.
    """

    pool: Pool
    known: dict[tuple[frozenset[object], str], tuple[str, ...]] = field(default_factory=dict, repr=False)

    def rivals(self, shared: SharedSet, cause: str) -> tuple[str, ...]:
        """Causes that imitate a shared cause in every table that shows it."""
        key = frozenset(shared.forms), cause
        if key not in self.known:
            separated: set[str] = set()
            shown = False
            tables = [table for table in self.pool.tables if self.pool.speaks(table, cause)]
            for table in tables:
                found = self._separated(table, shared, cause, len(tables))
                shown |= found is not None
                separated |= found or set()
            others = set(self.pool.forms) - shared.causes - separated
            self.known[key] = tuple(sorted(others)) if shown else ()
        return self.known[key]

    def _separated(self, table: TableInference, shared: SharedSet, cause: str, count: int) -> set[str] | None:
        """Causes that one table of several separates from a shared one; None if it does not show it.

        The log odds of the tables add up, so each may have its part of the limit.
        """
        forms = tuple(form for form in shared.forms if self.pool.speaks(table, form.cause))
        fit = table.with_forms(forms)[0]
        geometry = Geometry(table.reduced.likeliest(fit)[1], fit.variance)
        means = _in_units_of(table, shared, fit.mean, fit.hypothesis.placed)
        beside = np.zeros(len(geometry.products))
        signal: NDArray[np.floating[Any]] = np.zeros(len(beside))
        for (variant, _), mean in zip(fit.hypothesis.placed, means, strict=True):
            if variant.cause == cause:
                signal = geometry.signal(variant, mean)
            elif variant.cause != UNKNOWN:
                beside[list(variant.free)] = mean
        if geometry.visibility(signal) < _SHOWS:
            return None
        others: dict[str, list[Variant]] = {}
        for variant in table.variants:
            if variant.cause != UNKNOWN and variant.cause not in shared.causes:
                others.setdefault(variant.cause, []).append(variant)
        claims = table.settings.claims
        part = replace(claims, separable=claims.separable / count)
        alike = geometry.rivals(signal, others, beside, part)
        unseen = {id_ for id_, why in table.skipped.items() if why == INVISIBLE}
        return (set(others) - set(alike)) | unseen


def _in_units_of(
    table: TableInference,
    shared: SharedSet,
    own: NDArray[np.floating[Any]],
    placed: Sequence[tuple[Variant, slice]],
) -> list[NDArray[np.float64]]:
    """Sizes of a hypothesis of a table, those of shared causes as all tables share them."""
    ends = np.cumsum([0, *(len(form.names) for form in shared.forms)])
    mean = shared.population.mean
    common = {form.cause: (form, mean[ends[i] : ends[i + 1]]) for i, form in enumerate(shared.forms)}
    found = []
    for variant, place in placed:
        size = np.array(own[place], dtype=float)
        if variant.cause in common:
            form, shares = common[variant.cause]
            if form.names:
                size[: len(form.names)] = shares * np.array(form.scales) / np.array(variant.scales)
                size[len(form.names) :] = 0.0
        found.append(size)
    return found


def choose(pool: Pool, sets: Sequence[SharedSet], classes: Classes, without: int | None = None) -> Choice:
    """Claim shared causes by docs/method.md, Eq. 25, from all tables or without one."""
    shared = pool.ranking(sets, without)
    ranking, best = shared.ranking, shared.best()
    assert best is not None
    threshold = _threshold(pool)
    while (grown := shared.best(tuple(sorted(best.causes)))) is not None:
        (more,) = grown.causes - best.causes
        ids = tuple(sorted(best.causes))
        alone, beside = ranking.more(ids, (more, *classes.rivals(grown, more)))
        if not is_claimed(ids, alone, beside, threshold):
            break
        best = grown
    claims = []
    for cause in best.causes:
        rivals = classes.rivals(best, cause)
        claims.append(SharedClaim(cause, rivals, ranking.of([cause, *rivals]), ranking.of([cause])))
    return Choice(shared, best, tuple(sorted(claims, key=lambda claim: -claim.probability)))


def _threshold(pool: Pool) -> float:
    """Probability of no shared cause below which one is claimed: the strictest of the tables."""
    claims = pool.settings.claims
    few = sum(len(table.table) for table in pool.tables) < claims.few_rows
    return min([*(table.threshold for table in pool.tables), *([claims.claim_below_of_few] if few else [])])
