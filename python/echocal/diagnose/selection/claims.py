"""From fitted hypotheses to claims: causes with their sizes, their rivals and their probabilities."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN, Candidates, Variant
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.posterior import preferred
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.selection.parsimony import Ids, probabilities
from echocal.diagnose.settings import Settings
from echocal.model import Model
from echocal.quantities import QUANTITIES
from echocal.registry import find_effect

__all__ = [
    "LISTED",
    "Claim",
    "Ranking",
    "alternatives",
    "claims",
    "columns_of",
    "effects_of",
    "extended",
    "free_size",
    "rank",
    "without",
]

Parameters = dict[str, dict[str, float]]

LISTED = 1e-6
"""Probability from which on a set of causes is listed."""


@dataclass(frozen=True)
class Ranking:
    """Probabilities over sets of causes.

    Attributes
    ----------
    fits : list of HypothesisFit
        Most probable first.
    probability : ndarray
        Of each of `fits`; sums to one.
    sets : list of (tuple of str, float)
        Sets of ids (with ``unknown`` for an unexplained term), most probable first; sums to one.
    settings : Settings
    """

    fits: list[HypothesisFit]
    probability: NDArray[np.float64]
    sets: list[tuple[tuple[str, ...], float]]
    settings: Settings

    def of(self, causes: Sequence[str]) -> float:
        """Probability that at least one of these causes acts: docs/method.md, Eq. 24."""
        any_of = frozenset(causes)
        return sum(p for ids, p in self.sets if not any_of.isdisjoint(ids))

    @cached_property
    def by_effects(self) -> dict[Ids, float]:
        """Probability of each set of effects, with or without an unexplained term."""
        probability: dict[Ids, float] = {}
        for ids, p in self.sets:
            effects = tuple(id_ for id_ in ids if id_ != UNKNOWN)
            probability[effects] = probability.get(effects, 0.0) + p
        return probability

    def without_effects(self, *, term: bool) -> HypothesisFit | None:
        """Most probable hypothesis without an effect, with or without an unexplained term."""
        alone = (one for one in self.fits if not one.hypothesis.effects)
        return next((one for one in alone if bool(one.hypothesis.term) == term), None)

    def best(self, beyond: Ids | None = None) -> HypothesisFit | None:
        """Most probable hypothesis of the most probable set of effects, with any unexplained term.

        Of sets that are about equally probable, the one that most devices can compensate. With
        `beyond`, only sets that have one effect more than these count, or more effects where all sets
        with one more are too improbable beside larger ones to be mentioned; None if there is none.
        """
        probability = {ids: p for ids, p in self.by_effects.items() if p > 0.0}
        if beyond is not None:
            probability = self._next_larger(probability, beyond)
        if not probability:
            return None
        near = self.settings.claims.nearly * max(probability.values())
        likely = [effects for effects, p in probability.items() if p > near]
        top = max(likely, key=lambda effects: (-_out_of_reach(effects), probability[effects]))
        same = [w for w in self.fits if w.hypothesis.effects == top]
        alike = [w for w in same if w.hypothesis.term == same[0].hypothesis.term]  # the same term
        return preferred(alike)

    def _next_larger(self, probability: Mapping[Ids, float], beyond: Ids) -> dict[Ids, float]:
        """Sets with the fewest further effects that are not improbable beside those with more."""
        larger = {ids: p for ids, p in probability.items() if _is_larger(ids, beyond)}
        for count in sorted({len(ids) for ids in larger}):
            some = {ids: p for ids, p in larger.items() if len(ids) == count}
            rest = sum(p for ids, p in larger.items() if len(ids) > count)
            if sum(some.values()) >= self.settings.claims.mentioned_from * rest:
                return some
        return {}

    def of_set(self, effects: Ids) -> float:
        """Probability of a set of effects, with or without an unexplained term."""
        return self.by_effects.get(effects, 0.0)

    def more(self, ids: Ids, causes: Sequence[str] | None = None) -> tuple[float, float]:
        """Probability of a set of effects alone, and of it beside at least one of some causes (default: any).

        A set with an unexplained term counts as the set without it.
        """
        larger = {one: p for one, p in self.by_effects.items() if _is_larger(one, ids)}
        if causes is not None:
            larger = {one: p for one, p in larger.items() if not set(causes).isdisjoint(one)}
        return self.of_set(ids), sum(larger.values())

    def unexplained_terms(self) -> dict[str, float]:
        """Probability of an unexplained term against each column."""
        against: dict[str, float] = {}
        for fit, p in zip(self.fits, self.probability, strict=True):
            for variant in fit.hypothesis.variants:
                if variant.cause == UNKNOWN:
                    against[variant.against] = against.get(variant.against, 0.0) + float(p)
        return against


def _is_larger(ids: Ids, beyond: Ids) -> bool:
    """Whether a set includes another one and has more effects."""
    return len(ids) > len(beyond) and set(ids).issuperset(beyond)


def _out_of_reach(ids: Sequence[str]) -> int:
    """Number of effects that devices cannot compensate from what they measure."""
    effects = [find_effect(id_) for id_ in ids]
    measured = {name for name, facts in QUANTITIES.items() if facts.codes is not None}
    foreign = [e for e in effects if e.firmware == "needs" and e.firmware_detail not in measured]
    return len(foreign) + sum(e.firmware == "refused" for e in effects)


def rank(fits: list[HypothesisFit], causes: int, settings: Settings) -> Ranking:
    """Normalize the posterior, and add up the variants of each set of informative causes.

    docs/method.md, Eq. 18 and 20 to 22.
    """
    probability, sets = probabilities(fits, causes, settings.priors)
    return Ranking(fits, probability, list(sets.items()), settings)


@dataclass(frozen=True, eq=False)  # compared by identity, because it has arrays
class Claim:
    """A cause of the most probable set, with the causes that the data cannot separate from it.

    Attributes
    ----------
    variant : Variant
    mean, deviation, type_b : ndarray
        Coefficients of its free columns, in prior units, and their standard uncertainties: from the rows, and
        from errors that all rows share.
    rivals : tuple of str
    probability : float
        Probability of the cause or one of its rivals.
    beyond_shared : float
        Visibility of its signal beyond errors that all rows share; infinite where theory fixes the size.
    """

    variant: Variant
    mean: NDArray[np.floating[Any]]
    deviation: NDArray[np.floating[Any]]
    type_b: NDArray[np.floating[Any]]
    rivals: tuple[str, ...]
    probability: float
    beyond_shared: float

    @property
    def cause(self) -> str:
        """Id of the effect."""
        return self.variant.cause


def claims(
    ranking: Ranking, best: HypothesisFit, found: Candidates, geometry: Geometry, beyond: Ids = ()
) -> list[Claim]:
    """Claim the causes of a hypothesis, each with its rivals, except those in `beyond`."""
    others = _by_cause(found.variants)
    made = []
    chosen = set(best.hypothesis.effects)
    known = [(v, place) for v, place in best.hypothesis.placed if v.cause != UNKNOWN]
    for variant, place in ((v, place) for v, place in known if v.cause not in beyond):
        signal = geometry.signal(variant, best.mean[place])
        beside = np.zeros(len(signal))
        for other, own in known:
            if other is not variant:
                beside[list(other.free)] = best.mean[own]
        possible = {c: v for c, v in others.items() if c not in chosen}
        rivals = geometry.rivals(signal, possible, beside, ranking.settings.claims)
        probability = ranking.of([variant.cause, *rivals])
        made.append(_claim(variant, best, place, geometry, found, tuple(sorted(rivals)), probability))
    return sorted(made, key=lambda claim: -claim.probability)


def alternatives(ranking: Ranking, made: Sequence[Claim], found: Candidates, stack: Stack) -> list[Claim]:
    """Single causes that are possible instead of the claims."""
    taken = {id_ for claim in made for id_ in (claim.cause, *claim.rivals)}
    listed = []
    for ids, probability in ranking.sets:
        if (
            len(ids) == 1
            and probability >= ranking.settings.claims.mentioned_from
            and ids[0] not in {UNKNOWN, *taken}
        ):
            fit = next(w for w in ranking.fits if w.hypothesis.causes == ids)
            geometry = Geometry(stack.likeliest(fit)[1], fit.variance)
            ((variant, place),) = fit.hypothesis.placed
            listed.append(_claim(variant, fit, place, geometry, found, (), probability))
    return listed


def _claim(
    variant: Variant,
    fit: HypothesisFit,
    place: slice,
    geometry: Geometry,
    found: Candidates,
    rivals: tuple[str, ...],
    probability: float,
) -> Claim:
    """The claim of a cause of a fit."""
    deviation, type_b = np.sqrt(np.diag(fit.covariance)), geometry.type_b(fit, found.systematic)
    signal, beyond = geometry.signal(variant, fit.mean[place]), float("inf")
    if variant.offset is None:
        beyond = geometry.beyond_shared(signal, found.systematic)
    return Claim(variant, fit.mean[place], deviation[place], type_b[place], rivals, probability, beyond)


def _by_cause(variants: Sequence[Variant]) -> dict[str, list[Variant]]:
    causes: dict[str, list[Variant]] = {}
    for variant in variants:
        if variant.cause != UNKNOWN:
            causes.setdefault(variant.cause, []).append(variant)
    return causes


def effects_of(fit: HypothesisFit, only: Sequence[str] | None = None) -> Parameters:
    """Parameters of a model that has these causes (all of the hypothesis by default)."""
    return {
        variant.cause: parameters(variant, fit.mean[place])
        for variant, place in fit.hypothesis.placed
        if variant.cause != UNKNOWN and (only is None or variant.cause in only)
    }


def columns_of(fit: HypothesisFit, only: Sequence[str] | None = None) -> dict[str, str]:
    """Columns from which a model with these causes reads further thermometers."""
    causes = fit.hypothesis.variants
    return {q: name for v in causes if only is None or v.cause in only for q, name in v.bound}


def extended(base: Base, fit: HypothesisFit, only: Sequence[str] | None = None, **more: Any) -> Model:
    """The base with these causes, and the covariance of their parameters; `more` goes to `Model`."""
    effects = effects_of(fit, only)
    names = base.model(effects).parameter_names
    covariance = _covariance(fit, names) if names else None
    return base.model(effects, covariance=covariance, columns=columns_of(fit, only), **more)


def _covariance(fit: HypothesisFit, names: Sequence[str]) -> NDArray[np.float64]:
    """Covariance of a model's parameters; zero where theory fixes one."""
    entries: list[tuple[int, int, float]] = []  # parameter of the model, coefficient, scale
    for variant, place in fit.hypothesis.placed:
        for at, (name, scale) in enumerate(zip(variant.names, variant.scales, strict=True), place.start):
            full = f"{variant.cause}.{name}"
            if full in names:
                entries.append((list(names).index(full), at, scale))
    covariance = np.zeros((len(names), len(names)))
    for i, a, scale_a in entries:
        for j, b, scale_b in entries:
            covariance[i, j] = fit.covariance[a, b] * scale_a * scale_b
    return 0.5 * (covariance + covariance.T)


def parameters(variant: Variant, mean: NDArray[np.floating[Any]]) -> dict[str, float]:
    """Parameters of a cause; a mean outside a bound of the prior is set to the bound."""
    values = dict(variant.at)
    limits = zip(variant.names, mean.tolist(), variant.scales, variant.bounds, strict=False)
    for name, size, scale, (low, high) in limits:
        values[name] = values.get(name, 0.0) + min(max(size, low), high) * scale
    return values


def free_size(cause: str, found: Candidates, beside: Hypothesis, stack: Stack) -> tuple[float, float]:
    """Fitted size of a correction whose size theory fixes, and its standard uncertainty."""
    free = Variant(cause, free=(found.size_tangents[cause][0],), bounds=((-np.inf, np.inf),))
    fit = fit_hypothesis(Hypothesis((free, *without(beside, cause).variants), 1.0), stack)
    shared = Geometry(stack.likeliest(fit)[1], fit.variance).type_b(fit, found.systematic)
    return float(fit.mean[0]), float(np.hypot(np.sqrt(fit.covariance[0, 0]), shared[0]))


def without(hypothesis: Hypothesis, cause: str) -> Hypothesis:
    """The hypothesis without one cause."""
    return replace(hypothesis, variants=tuple(v for v in hypothesis.variants if v.cause != cause))


def posterior_sets(ranking: Ranking) -> dict[tuple[str, ...], float]:
    """Sets that are not too improbable to list, with probabilities that sum to one."""
    kept = {ids: p for ids, p in ranking.sets if p >= LISTED}
    total = sum(kept.values())
    return {ids: p / total for ids, p in kept.items()}
