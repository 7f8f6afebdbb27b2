"""The posterior over the sets of causes that all tables share: docs/method/several-tables.md, section 10."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit
from echocal.diagnose.pooling.hierarchy import Grid, Likelihoods, Population, left_out, population
from echocal.diagnose.pooling.shared_forms import SharedForm, shared_forms
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.selection.claims import Ranking, rank
from echocal.diagnose.settings import Settings

__all__ = ["Pool", "SharedSet", "search"]

Mask = NDArray[np.bool_]
Forms = tuple[SharedForm, ...]

_PAIRS_OF = 8  # most probable shared causes whose pairs are tried
_FORMS = 3  # of a cause that are tried beside other shared causes
_MOST_CAUSES = 4  # that all tables may share
_GROWN = 4  # best sets that get one further cause


@dataclass(frozen=True)
class SharedSet:
    """A set of causes that all tables share, after the data.

    Attributes
    ----------
    others : ndarray, shape (k,)
        Log evidence of all tables but one, for each table.
    """

    forms: Forms
    log_prior: float
    population: Population
    others: NDArray[np.floating[Any]]

    @cached_property
    def hypothesis(self) -> Hypothesis:
        """The set as a hypothesis about mean sizes, for the rules that choose among hypotheses."""
        ends = np.cumsum([0, *(len(form.names) for form in self.forms)]).tolist()
        variants = (form.variant(first) for form, first in zip(self.forms, ends, strict=False))
        return Hypothesis(tuple(variants), float(np.exp(self.log_prior)))

    @property
    def causes(self) -> frozenset[str]:
        """Ids."""
        return frozenset(self.hypothesis.causes)

    @property
    def log_posterior(self) -> float:
        """Up to a constant common to all sets."""
        return self.log_prior + self.population.log_evidence

    def form(self, cause: str) -> SharedForm:
        """Form of one of its causes."""
        return next(form for form in self.forms if form.cause == cause)

    def place(self, cause: str) -> slice:
        """Places of the sizes of one of its causes."""
        return next(place for variant, place in self.hypothesis.placed if variant.cause == cause)

    def fit(self, without: int | None = None) -> HypothesisFit:
        """The hypothesis after the data of all tables, or of all but one."""
        evidence = self.population.log_evidence if without is None else float(self.others[without])
        return HypothesisFit(self.hypothesis, evidence, *self.population.mean, np.ones(1), 1.0)


@dataclass
class Pool:
    """Tables that may share causes.

    Attributes
    ----------
    known : dict
        Sets that were computed before.
    rivals : dict
        Classes that were computed before.
    """

    tables: Sequence[TableInference]
    settings: Settings
    known: dict[frozenset[SharedForm], SharedSet] = field(default_factory=dict, repr=False)
    rivals: dict[tuple[frozenset[SharedForm], str], tuple[str, ...]] = field(default_factory=dict, repr=False)

    @cached_property
    def forms(self) -> dict[str, list[SharedForm]]:
        """Forms of each cause that competes in some table."""
        return shared_forms([table.variants for table in self.tables])

    def likelihoods(self, forms: Forms) -> Likelihoods:
        """What each table says about the sizes of some forms."""
        ends = np.cumsum([0, *(len(form.names) for form in forms)])
        d, count = int(ends[-1]), len(self.tables)
        log, information, precision = np.zeros(count), np.zeros((count, d)), np.zeros((count, d, d))
        for at, table in enumerate(self.tables):
            spoken = [i for i, form in enumerate(forms) if form.cause in table.competing]
            places = [place for i in spoken for place in range(ends[i], ends[i + 1])]
            log[at], own, square = table.likelihood(tuple(forms[i] for i in spoken))
            information[at, places] = own
            precision[np.ix_([at], places, places)] = square
        return Likelihoods(log, information, precision)

    def _grid(self, forms: Forms) -> tuple[Grid, list[tuple[float, float]]]:
        """Widths and standard deviations between tables that are tried, and the bounds of the sizes."""
        grid = Grid.of([len(form.names) for form in forms], self.settings.pooling.between)
        return grid, [bound for form in forms for bound in form.bounds]

    def evaluated(self, forms: Forms) -> SharedSet:
        """One set after the data."""
        key = frozenset(forms)
        if key not in self.known:
            found, others = left_out(self.likelihoods(forms), *self._grid(forms))
            prior = self.settings.priors.log_of_set(len(forms), len(self.forms))
            prior += float(sum(np.log(form.weight) for form in forms))
            self.known[key] = SharedSet(forms, prior, found, others)
        return self.known[key]

    def population(self, forms: Forms, tables: Mask) -> Population:
        """Sizes of a set from some tables."""
        return population(self.likelihoods(forms).only(tables), *self._grid(forms))

    def ranking(self, sets: Sequence[SharedSet], without: int | None = None) -> Ranking:
        """Probabilities of the sets, from all tables or without one."""
        fits = sorted((found.fit(without) for found in sets), key=lambda fit: -fit.log_posterior)
        return rank(fits, len(self.forms), self.settings)


def search(pool: Pool) -> list[SharedSet]:
    """No shared cause, each cause, pairs of the best causes, and larger sets greedily."""
    found = [pool.evaluated(())]
    singles = [[pool.evaluated((form,)) for form in forms] for forms in pool.forms.values()]
    found += [one for forms in singles for one in forms]
    best = sorted(singles, key=lambda forms: -max(one.log_posterior for one in forms))
    some = {forms[0].forms[0].cause: _few(forms, _FORMS) for forms in best[:_PAIRS_OF]}
    for pair in combinations(some, 2):
        found += [pool.evaluated(forms) for forms in product(*(some[cause] for cause in pair))]
    size = 2
    while size < _MOST_CAUSES and _grows(found, size):
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
