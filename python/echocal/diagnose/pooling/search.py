"""The posterior over the sets of causes that all tables share: docs/method.md, section 10."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit
from echocal.diagnose.pooling.hierarchy import Grid, Likelihoods, Population, left_out, population
from echocal.diagnose.pooling.shared_forms import SharedForm, shared_forms
from echocal.diagnose.pooling.table import TableInference, log_prior_of_set
from echocal.diagnose.selection.claims import Ranking, rank
from echocal.diagnose.settings import Settings

__all__ = ["Pool", "SharedRanking", "SharedSet", "search"]

Mask = NDArray[np.bool_]
Forms = tuple[SharedForm, ...]

_GROWN = 4  # best sets that get one further cause


@dataclass(frozen=True)
class SharedSet:
    """A set of causes that all tables share, after the data.

    Attributes
    ----------
    forms : tuple of SharedForm
    log_prior : float
    population : Population
    others : ndarray, shape (k,)
        Log evidence of all tables but one, for each table.
    """

    forms: Forms
    log_prior: float
    population: Population
    others: NDArray[np.floating[Any]]

    @property
    def causes(self) -> frozenset[str]:
        """Ids."""
        return frozenset(form.cause for form in self.forms)

    @property
    def log_posterior(self) -> float:
        """Up to a constant common to all sets."""
        return self.log_prior + self.population.log_evidence


@dataclass(frozen=True)
class SharedRanking:
    """Probabilities of shared sets.

    Attributes
    ----------
    ranking : Ranking
    sets : mapping of int to SharedSet
        By the identity of the hypothesis.
    """

    ranking: Ranking
    sets: Mapping[int, SharedSet]

    def best(self, beyond: tuple[str, ...] | None = None) -> SharedSet | None:
        """As `Ranking.best`."""
        found = self.ranking.best(beyond)
        return None if found is None else self.sets[id(found)]


@dataclass
class Pool:
    """Tables that may share causes.

    Attributes
    ----------
    tables : sequence of TableInference
    settings : Settings
    against : mapping of (str, str) to float
        Log odds of a table against a cause, by the names of both. Such a table says nothing about the size.
    known : dict
        Sets that were computed before.
    """

    tables: Sequence[TableInference]
    settings: Settings
    against: Mapping[tuple[str, str], float] = field(default_factory=dict)
    known: dict[frozenset[SharedForm], SharedSet] = field(default_factory=dict, repr=False)

    @cached_property
    def forms(self) -> dict[str, list[SharedForm]]:
        """Forms of each cause that competes in some table."""
        return shared_forms([table.variants for table in self.tables])

    def speaks(self, table: TableInference, cause: str) -> bool:
        """Whether a table says something about a cause: it competes there, and nothing speaks against it."""
        return cause in table.competing and (table.name, cause) not in self.against

    def likelihoods(self, forms: Forms) -> Likelihoods:
        """What each table says about the sizes of some forms."""
        ends = np.cumsum([0, *(len(form.names) for form in forms)])
        d, count = int(ends[-1]), len(self.tables)
        log, information, precision = np.zeros(count), np.zeros((count, d)), np.zeros((count, d, d))
        for at, table in enumerate(self.tables):
            spoken = [i for i, form in enumerate(forms) if self.speaks(table, form.cause)]
            places = [place for i in spoken for place in range(ends[i], ends[i + 1])]
            log[at], own, square = table.likelihood(tuple(forms[i] for i in spoken))
            information[at, places] = own
            precision[np.ix_([at], places, places)] = square
            log[at] += sum(self.against.get((table.name, form.cause), 0.0) for form in forms)
        return Likelihoods(log, information, precision)

    def grid(self, forms: Forms) -> Grid:
        """Widths and standard deviations between tables that are tried."""
        return Grid.of([len(form.names) for form in forms], self.settings.pooling.between)

    def evaluated(self, forms: Forms) -> SharedSet:
        """One set after the data."""
        key = frozenset(forms)
        if key not in self.known:
            likelihoods = self.likelihoods(forms)
            bounds = [bound for form in forms for bound in form.bounds]
            found, others = left_out(likelihoods, self.grid(forms), bounds)
            prior = log_prior_of_set(len(forms), len(self.forms), self.settings.priors)
            prior += float(sum(np.log(form.weight) for form in forms))
            self.known[key] = SharedSet(forms, prior, found, others)
        return self.known[key]

    def population(self, forms: Forms, tables: Mask) -> Population:
        """Sizes of a set from some tables."""
        bounds = [bound for form in forms for bound in form.bounds]
        return population(self.likelihoods(forms).only(tables), self.grid(forms), bounds)

    def ranking(self, sets: Sequence[SharedSet], without: int | None = None) -> SharedRanking:
        """Probabilities of the sets, from all tables or without one."""
        fits = [(_fit(found, without), found) for found in sets]
        fits.sort(key=lambda pair: -pair[0].log_posterior)
        ranking = rank([fit for fit, _ in fits], len(self.forms), self.settings)
        return SharedRanking(ranking, {id(fit): found for fit, found in fits})


def search(pool: Pool) -> list[SharedSet]:
    """No shared cause, each cause, pairs of the best causes, and larger sets greedily."""
    settings = pool.settings.pooling
    found = [pool.evaluated(())]
    singles = [[pool.evaluated((form,)) for form in forms] for forms in pool.forms.values()]
    found += [one for forms in singles for one in forms]
    best = sorted(singles, key=lambda forms: -max(one.log_posterior for one in forms))
    some = {forms[0].forms[0].cause: _few(forms, settings.forms) for forms in best[: settings.pairs_of]}
    for pair in combinations(some, 2):
        found += [pool.evaluated(forms) for forms in product(*(some[cause] for cause in pair))]
    size = 2
    while size < settings.most_causes and _grows(found, size):
        sets = sorted((one for one in found if len(one.forms) == size), key=lambda one: -one.log_posterior)
        chosen = list({one.causes: one for one in reversed(sets)}.values())[::-1][:_GROWN]
        for one in chosen:
            for cause, forms in some.items():
                if cause not in one.causes:
                    found += [pool.evaluated((*one.forms, form)) for form in forms]
        size += 1
        found = list({frozenset(one.forms): one for one in found}.values())
    return found


def _few(forms: Sequence[SharedSet], count: int) -> list[SharedForm]:
    ordered = sorted(forms, key=lambda one: -one.log_posterior)
    return [one.forms[0] for one in ordered[:count]]


def _grows(found: Sequence[SharedSet], size: int) -> bool:
    """Whether the best set of a size is better than all smaller ones."""
    own = max((one.log_posterior for one in found if len(one.forms) == size), default=-np.inf)
    return bool(own > max(one.log_posterior for one in found if len(one.forms) < size))


def _fit(found: SharedSet, without: int | None) -> HypothesisFit:
    """A shared set as a hypothesis about mean sizes, for the rules that choose among hypotheses."""
    ends = np.cumsum([0, *(len(form.names) for form in found.forms)])
    variants = tuple(
        Variant(
            form.cause,
            offset=None if form.names else 0,
            free=tuple(range(ends[i], ends[i + 1])),
            names=form.names,
            scales=form.scales,
            bounds=form.bounds,
            weight=form.weight,
        )
        for i, form in enumerate(found.forms)
    )
    evidence = found.population.log_evidence if without is None else float(found.others[without])
    prior = float(np.exp(found.log_prior))
    mean, covariance = found.population.mean, found.population.covariance
    return HypothesisFit(Hypothesis(variants, prior), evidence, mean, covariance, np.ones(1), 1.0)
