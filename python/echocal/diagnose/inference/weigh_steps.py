"""Steps of an unknown level as hypotheses, weighed together with the causes.

docs/method/noises.md, Eq. 40 to 42.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, logsumexp

from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, fit_hypothesis
from echocal.diagnose.inference.least_squares import averaged_out
from echocal.diagnose.inference.noise import VARIANCE_FLOOR
from echocal.diagnose.inference.posterior import core_prior, posterior
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.segments import divided
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["StepPosterior", "weigh_steps"]

Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]
Matrix = NDArray[np.float64]
Form = tuple[tuple[int | None, tuple[int, ...]], ...]
Set = tuple[int, ...]
"""Steps that act together, by their places among those proposed."""

_STEP_OF_THE_SENSOR = "step_change"
"""Id of the effect that is the same as a step of an unknown level."""

_SETS = 8  # most sets of causes that steps are weighed beside


@dataclass(frozen=True, eq=False)
class StepPosterior:
    """Nested sets of steps beside sets of causes.

    Attributes
    ----------
    table : Table
        With every proposed step.
    case : Case
        The columns of causes and steps over the same rows, where only certain steps divide the level.
    rows : ndarray of int
        Source rows of the steps that are weighed.
    certain : ndarray of int
        Source rows of those that are not.
    sets : tuple of tuple of int
        Nested sets, from none to all.
    beside : tuple of Hypothesis
        Probable causes beside some of these sets.
    """

    table: Table
    case: Case
    rows: Labels
    certain: Labels
    sets: tuple[Set, ...]
    beside: tuple[Hypothesis, ...]

    def probability(self, blocks: Mask) -> Matrix:
        """Probability of each step, from the rows of some blocks: Eq. 42."""
        tried = _Tried.of(self.case, blocks, self.rows)
        logs = np.array([[tried.log(one, steps) for steps in self.sets] for one in self.beside])
        weight = np.exp(logs - logsumexp(logs)).sum(axis=0)
        among = np.array([[at in steps for steps in self.sets] for at in range(len(self.rows))])
        return np.asarray(np.minimum(among @ weight, 1.0))

    def kept(self, blocks: Mask) -> Table:
        """The table with the steps that are probable in the rows of some blocks."""
        settings, probability = self.case.settings.rows, self.probability(blocks)
        rows = np.union1d(self.rows[probability >= PROBABLE], self.certain)
        told = dict(zip(self.rows.tolist(), probability.tolist(), strict=True))
        return replace(divided(self.table, rows, settings.gap), step_probability=told)

    def same(self, one: Table, other: Table, blocks: Mask) -> bool:
        """Whether two tables divide the rows of some blocks into the same segments."""
        seen = blocks[self.case.folds.blocks]
        pairs = {(a, b) for a, b in zip(one.groups[seen].tolist(), other.groups[seen].tolist(), strict=True)}
        return len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})


def weigh_steps(
    table: Table, base: Base, seed: int, settings: Settings, certain: Sequence[int] = ()
) -> StepPosterior | None:
    """Compare nested sets of the proposed steps, each beside every cause.

    Parameters
    ----------
    table : Table
        With every proposed step.
    base : Base
    seed : int
    settings : Settings
    certain : sequence of int
        Source rows of steps that the posterior over causes has claimed already.

    Returns
    -------
    StepPosterior or None
        None if there is no step to weigh.
    """
    if table.reference is not None or not len(table.steps):
        return None
    known = np.union1d(_beyond_air(table, settings.rows.step_beyond_air), np.array(certain, dtype=np.int64))
    known = np.intersect1d(known, table.steps)
    rows = np.setdiff1d(table.steps, known)
    if not len(rows):
        return None
    coarse = divided(table, known, settings.rows.gap)
    folds = Folds.of(table, settings.rows)
    at = table.places(rows)
    case = examine(coarse, base, folds, seed, settings, steps=at)
    own = [v for v in case.found.variants if v.cause != _STEP_OF_THE_SENSOR]
    case = replace(case, found=replace(case.found, variants=own))
    tried = _Tried.of(case, folds.fit, rows)
    every = tuple(range(len(rows)))
    beside = tried.likely([(), every])
    sets = tried.nested(beside, every)
    best = max(sets, key=lambda steps: max(tried.log(one, steps) for one in beside))
    if best not in ((), every):
        beside = tried.joined(beside, tried.likely([best]))
        sets = tried.nested(beside, every)
    return StepPosterior(table, case, rows, known, sets, beside)


def _beyond_air(table: Table, share: float) -> Labels:
    """Source rows of steps that are too large for any change of the air."""
    level = np.array([np.median(table.indication[table.groups == g]) for g in np.unique(table.groups)])
    at = table.places(table.steps)
    new, old = level[table.groups[at]], level[table.groups[np.maximum(at - 1, 0)]]
    return np.asarray(table.steps[np.abs(new - old) > share * np.minimum(np.abs(new), np.abs(old))])


def _variance(case: Case, blocks: Mask, steps: Labels) -> float:
    """Half the mean square difference of neighboring rows [m^2], but for those at a proposed step."""
    seen = blocks[case.folds.blocks]
    follows = ~case.table.starts[1:] & seen[1:] & seen[:-1]
    follows[case.table.places(steps) - 1] = False
    squares = np.diff(case.residual)[follows] ** 2
    return max(float(squares.mean()) / 2 if len(squares) else 0.0, VARIANCE_FLOOR**2)


@dataclass(frozen=True, eq=False)
class _Tried:
    """Products over some blocks, in which steps are averaged out."""

    case: Case
    products: Matrix
    log_weight: Matrix
    degrees: int
    rows: int
    variance: float
    known: dict[tuple[Form, Set], float]

    @classmethod
    def of(cls, case: Case, blocks: Mask, steps: Labels) -> "_Tried":
        rows, stack = int(case.sums.rows[blocks].sum()), case.stack(blocks)
        variance = _variance(case, blocks, steps)
        return cls(case, stack.products, stack.log_weight, stack.degrees, rows, variance, {})

    def averaged(self, steps: Set, columns: Sequence[int] | None = None) -> Stack:
        """Products of some columns, or of all, whose rows have these steps: Eq. 41."""
        own = [self.case.found.steps[place] for place in steps]
        last = self.products.shape[-1] - 1
        kept = range(last + 1) if columns is None else [0, *columns, last]
        noises = len(self.products)
        variance = np.full(noises, self.variance)
        products, more = averaged_out(self.products, own, kept, list(range(noises)), variance)
        log_weight = self.log_weight + self._log_prior(steps) + more
        return Stack(products, log_weight, self.degrees, self.case.noises)

    def _log_prior(self, steps: Set) -> float:
        """Log prior of the number of steps and of their places: Eq. 40."""
        count, places = len(steps), max(self.rows - 1, len(steps))
        more = self.case.settings.rows.one_more_step
        choices = gammaln(places + 1) - gammaln(count + 1) - gammaln(places - count + 1)
        return float(np.log1p(-more) + count * np.log(more) - choices)

    def log(self, beside: Hypothesis, steps: Set) -> float:
        """Log posterior of causes with steps, up to a constant."""
        key = _columns_of(beside), steps
        if key not in self.known:
            columns = sorted(set(beside.columns))
            moved = tuple(_moved(v, columns) for v in beside.variants)
            fit = fit_hypothesis(Hypothesis(moved, beside.prior), self.averaged(steps, columns))
            self.known[key] = fit.log_posterior
        return self.known[key]

    def likely(self, sets: Sequence[Set]) -> tuple[Hypothesis, ...]:
        """The most probable sets of causes, each in its best form, where the level has one of some sets."""
        stacks = [self.averaged(steps) for steps in sets]
        joined = Stack(
            np.concatenate([one.products for one in stacks]),
            np.concatenate([one.log_weight for one in stacks]),
            self.degrees,
            self.case.noises * len(sets),
        )
        fits, _ = posterior(self.case.found, joined, self.case.settings)
        best: dict[tuple[str, ...], HypothesisFit] = {}
        for fit in fits:
            if fit.log_posterior > fits[0].log_posterior - self.case.settings.noises.negligible_odds:
                best.setdefault(fit.hypothesis.ids, fit)
        found = [fit.hypothesis for fit in best.values()][:_SETS]
        nothing = Hypothesis((), core_prior(self.case.settings.priors).no_cause(bool(self.case.found.terms)))
        return tuple(found) if () in {one.ids for one in found} else (*found, nothing)

    def nested(self, beside: Sequence[Hypothesis], every: Set) -> tuple[Set, ...]:
        """Sets from none to all: the step that the best causes need least is taken out first."""
        best = max(beside, key=lambda one: max(self.log(one, ()), self.log(one, every)))
        sets = [every]
        while sets[-1]:
            less = [tuple(s for s in sets[-1] if s != step) for step in sets[-1]]
            sets.append(max(less, key=lambda steps: self.log(best, steps)))
        return tuple(reversed(sets))

    @staticmethod
    def joined(one: Sequence[Hypothesis], other: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
        """Hypotheses of both, once each."""
        have = {_columns_of(hypothesis) for hypothesis in one}
        return (*one, *(hypothesis for hypothesis in other if _columns_of(hypothesis) not in have))


def _columns_of(hypothesis: Hypothesis) -> Form:
    """Fixed and free columns of each cause."""
    return tuple((variant.offset, variant.free) for variant in hypothesis.variants)


def _moved(variant: Variant, columns: Sequence[int]) -> Variant:
    """The same form over a selection of columns, after the first."""
    offset = None if variant.offset is None else 1 + columns.index(variant.offset)
    return replace(variant, offset=offset, free=tuple(1 + columns.index(column) for column in variant.free))
