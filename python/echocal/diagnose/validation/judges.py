"""The rows that judge a model at last: rows that neither its choice nor its fit has seen."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import HELD_OUT
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.posterior import infer
from echocal.diagnose.inference.weigh_steps import StepPosterior
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.posterior import infer_noises
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.table import Table, levels
from echocal.diagnose.selection.claims import rank
from echocal.diagnose.selection.select import select
from echocal.diagnose.validation.gain import HeldOut, fixed_speed_rms, measure, on_common_rows
from echocal.diagnose.validation.score import Score, score
from echocal.diagnose.validation.trials import Rest, Trials
from echocal.model import Model

__all__ = ["HeldOutRows", "Judge", "Nested", "judge_of"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_UNLISTED = 1e-3  # probability that the least probable hypotheses share, which a fold leaves out


@dataclass(frozen=True)
class Nested:
    """Cross-validation: each fold chooses and fits without its rows.

    Attributes
    ----------
    case : Case
    noises : tuple of Noise
        Those that are probable beside some hypothesis on all rows; a fold considers no other.
    tried : collection of FittedNoise
        The same, of noises with a likelihood of their own.
    steps : StepPosterior or None
        Steps of an unknown level, which each fold weighs on its rows.
    known : dict
        Models that blocks have chosen before, and the noise beside each.
    models_judged : list of (HeldOut, callable)
        Errors of models that were judged, and the model as a function of the blocks that it is fitted on.
    """

    case: Case
    noises: tuple[Noise, ...]
    tried: Collection[FittedNoise]
    steps: StepPosterior | None = None
    known: dict[bytes, tuple[Model, Noise]] = field(default_factory=dict, repr=False)
    models_judged: list[tuple[HeldOut, Callable[[Mask], Model]]] = field(default_factory=list, repr=False)

    @property
    def scheme(self) -> str:
        """How these rows were chosen."""
        return f"nested, {self.case.folds.scheme}"

    @property
    def held(self) -> None:
        """No row is held out from all folds."""

    def base(self) -> HeldOut:
        """Errors of the base."""
        return Trials(self.case, self.case.noises[0]).base()

    def judged(self, trials: Trials, rest: Rest) -> Rest:
        """The same claims, with the errors of the models that the folds choose.

        Where these models are better than the claims themselves, the errors are those of the claims, whose
        sizes each fold fits: no gain is told that the final model does not have.
        """
        if not rest.kept:
            return rest
        after, claimed = self.extended(self._alone), self.sized(trials, rest)
        one, other = on_common_rows(after, claimed)
        fitted: Callable[[Mask], Model] = self._alone
        if one.rms < other.rms:
            after, fitted = claimed, trials.fitted(rest.hypothesis, rest.kept)
        self.models_judged.append((after, fitted))
        return replace(rest, after=after)

    def score(self, after: HeldOut, before: HeldOut, noise: Noise) -> Score:
        """Log density of these rows with the judged model, less that with the base.

        Of the rows without the offsets that a noise explains: under the noise that is left, such rows are
        outliers, whichever model corrects them.
        """
        case, folds = self.case, self.case.folds
        fitted = next(fitted for judged, fitted in self.models_judged if judged is after)
        noises = [noise] * len(folds.held)
        if not self.of_claims:
            noises = [self.known.get((folds.fit & ~held).tobytes(), (None, noise))[1] for held in folds.held]
        if case.offsets is not None:
            after = measure(case.rows_without_offsets, case.row_folds, fitted)
            before = Trials(case, noise, case.rows_without_offsets).base()
        after, before = after.of_units(case.table), before.of_units(case.table)
        return score(after, before, case.sums.order, folds, noises)

    def sized(self, trials: Trials, rest: Rest) -> HeldOut:
        """Errors of a model with some causes, whose sizes are fitted without these rows."""
        return trials.of(rest.hypothesis, rest.kept)

    def compared(self, trials: Trials, one: HeldOut, other: HeldOut) -> Score:
        """Log density of these rows with one such model, less that with another one."""
        return trials.score(one, other)

    def extended(self, fitted: Callable[[Mask], Model]) -> HeldOut:
        """Errors of a model that is a function of the blocks that it is fitted on."""
        return measure(self.case.table.rows, self.case.row_folds, fitted)

    def models(self, fitted: Callable[[Mask], Model], kept: bool) -> Callable[[Mask], Model]:
        """The model that some blocks choose, if such models were judged; of all blocks, the final one."""
        alone = kept and not self.of_claims
        return lambda blocks: self._alone(blocks) if alone and blocks.sum() < len(blocks) else fitted(blocks)

    def fixed_speed(self) -> float:
        """Error of a device that converts every echo with one speed [m]."""
        rows = self.case.table.rows
        return fixed_speed_rms(rows, self.case.row_folds, _speed(self.case.base, rows))

    @property
    def of_claims(self) -> bool:
        """Whether the claims themselves were judged, in place of the models that the folds choose."""
        return bool(self.models_judged) and self.models_judged[-1][1] != self._alone

    def _alone(self, blocks: Mask) -> Model:
        return self._chosen(blocks)[0]

    def _chosen(self, blocks: Mask) -> tuple[Model, Noise]:
        """The model that some blocks choose as the pipeline does, and fit, and the noise beside it.

        The columns and the sums are those of the whole table: where a step or an edge may lie, and the
        segments of an unknown level, are not searched again.
        """
        if (key := blocks.tobytes()) in self.known:
            return self.known[key]
        folds = self.case.folds.within(blocks)
        part = replace(self._divided(blocks), folds=folds, signals={}, probable=self.noises)
        inference = infer(part, _UNLISTED)
        shares = infer_noises(part, inference.fits, inference.reduced, self.tried)
        ranking = rank(shares.fits, part.found.competing, part.settings)
        selection = select(part, ranking, shares, inference.reduced)
        model = Trials(part, selection.noise).fitted(selection.best.hypothesis, selection.claims)(blocks)
        self.known[key] = model, selection.noise
        return self.known[key]

    def _divided(self, blocks: Mask) -> Case:
        """The case with the segments that some blocks choose; beside offsets, those of all rows."""
        case = self.case
        if self.steps is None or case.offsets is not None:
            return case
        own = self.steps.kept(blocks)
        if self.steps.same(own, case.table, blocks):
            return case
        made = examine(own, case.base, case.folds, case.seed, case.settings)
        return made if all(made.sums.has(noise) for noise in self.noises) else case


@dataclass(frozen=True)
class HeldOutRows:
    """Rows that the user holds out, which no other stage has.

    Attributes
    ----------
    case : Case
        Of the other rows.
    held : Table
    after : str or float
        Time from which on rows are held out.
    """

    case: Case
    held: Table
    after: str | float

    @property
    def scheme(self) -> str:
        """How these rows were chosen."""
        return f"{HELD_OUT} {self.after} on; causes are selected and fitted without them"

    def base(self) -> HeldOut:
        """Errors of the base."""
        return HeldOut(self.errors(self.case.base.model()))

    def judged(self, trials: Trials, rest: Rest) -> Rest:
        """The same claims, all of which these rows judge."""
        return replace(rest, after=self.sized(trials, rest))

    def score(self, after: HeldOut, before: HeldOut, noise: Noise) -> Score:
        """Log density of these rows with the judged model, less that with the base; levels are free."""
        blocks = np.zeros(len(self.held), dtype=np.int64)
        folds = Folds(blocks, (np.array([True]),), np.array([False]), self.scheme)
        after, before = after.of_units(self.held), before.of_units(self.held)
        return score(after, before, self.held.order, folds, [noise])

    def sized(self, trials: Trials, rest: Rest) -> HeldOut:
        """Errors of a model with some causes, whose sizes are fitted without these rows."""
        return self.extended(trials.fitted(rest.hypothesis, rest.kept))

    def compared(self, trials: Trials, one: HeldOut, other: HeldOut) -> Score:
        """Log density of these rows with one such model, less that with another one."""
        return self.score(one, other, trials.noise)

    def extended(self, fitted: Callable[[Mask], Model]) -> HeldOut:
        """Errors of a model that is a function of the blocks that it is fitted on."""
        return HeldOut(self.errors(fitted(self.case.folds.fit)))

    def models(self, fitted: Callable[[Mask], Model], kept: bool) -> Callable[[Mask], Model]:
        """The final model: no held-out row has taken part in its choice."""
        return fitted

    def fixed_speed(self) -> float:
        """Error of a device that converts every echo with the mean speed of the other rows [m]."""
        rows, judging = self.case.table.rows, self.held.rows
        seen, held = (_speed(self.case.base, table) for table in (rows, judging))
        usual = float(seen.mean())
        other, own = rows.indication / seen * usual, judging.indication / held * usual
        return HeldOut(self._less_the_distance(own, lambda: other)).rms

    def errors(self, model: Model) -> Column:
        """Held-out rows corrected by a model, less reference or level [m]."""
        return self._less_the_distance(self.held.rows.correct(model), lambda: self.case.table.correct(model))

    def _less_the_distance(self, values: Column, seen: Callable[[], Column]) -> Column:
        """Less the reference; else less the level.

        The first held-out segment in time continues the last one of the other rows, and has its level, unless
        the target was put up anew. A segment that begins later has a level of its own.
        """
        if (reference := self.held.rows.reference) is not None:
            return values - reference
        groups, others = self.held.groups, self.case.table.groups
        level = levels(values, groups, np.ones(len(values), dtype=bool), np.mean)
        first = int(self.held.conditions["elapsed_time"].argmin())
        last = int(self.case.table.conditions["elapsed_time"].argmax())
        if _stand(self.held, first) == _stand(self.case.table, last):
            level[groups == groups[first]] = seen()[others == others[last]].mean()
        return values - level


Judge = Nested | HeldOutRows
"""Rows on which a model is compared with the base."""


def judge_of(
    case: Case,
    noises: tuple[Noise, ...],
    tried: Collection[FittedNoise],
    held: Table | None,
    after: str | float | None,
    steps: StepPosterior | None = None,
) -> Judge:
    """The rows that the user holds out; else folds, each of which chooses by itself."""
    if held is not None and after is not None:
        return HeldOutRows(case, held, after)
    return Nested(case, noises, tried, steps)


def _stand(table: Table, row: int) -> int:
    """Placement of the target in a row; the same for all rows where it is not recorded."""
    return int(table.labels["stand"][row]) if "stand" in table.labels else -1


def _speed(base: Base, table: Table) -> NDArray[np.float64]:
    """Speed that the base converts each echo with [m/s]."""
    return 2.0 * base.indication(np.ones(len(table)), table.conditions)
