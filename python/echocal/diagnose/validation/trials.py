"""Models on the folds: each is fitted once for each fold."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.selection.claims import Claim, columns_of, effects_of
from echocal.diagnose.validation.gain import HeldOut, measure
from echocal.diagnose.validation.score import Score, score
from echocal.model import Model

__all__ = ["Rest", "Trials", "fit_with"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Rest:
    """The claims that are kept so far.

    Attributes
    ----------
    hypothesis : Hypothesis
        What they are fitted in.
    kept : tuple of Claim
    after : HeldOut
        Errors of the model that has them.
    """

    hypothesis: Hypothesis
    kept: tuple[Claim, ...]
    after: HeldOut


@dataclass
class Trials:
    """Errors of models on the folds, with the causes chosen before and the sizes fitted for each fold.

    Attributes
    ----------
    case : Case
    noise : Noise
        Under which sizes are fitted.
    table : Table or None
        Rows with the readings that are judged; None for those of the case.
    known : dict
        Errors that were computed before.
    """

    case: Case
    noise: Noise
    table: Table | None = None
    known: dict[tuple[frozenset[str], frozenset[str]], HeldOut] = field(default_factory=dict)

    def base(self) -> HeldOut:
        """Errors of the base."""
        key: tuple[frozenset[str], frozenset[str]] = frozenset(), frozenset()
        if key not in self.known:
            self.known[key] = self._measured(lambda _: self.case.base.plain)
        return self.known[key]

    def of(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> HeldOut:
        """Errors with the kept causes, fitted beside all of a hypothesis, part of the best one."""
        if not kept:
            return self.base()  # whatever else is fitted
        key = frozenset(hypothesis.causes), frozenset(claim.cause for claim in kept)
        if key not in self.known:
            self.known[key] = self._measured(self.fitted(hypothesis, kept))
        return self.known[key]

    def _measured(self, fitted: Callable[[Mask], Model]) -> HeldOut:
        table = self.case.table.rows if self.table is None else self.table
        return measure(table, self.case.row_folds, fitted)

    def score(self, one: HeldOut, other: HeldOut) -> Score:
        """Log density of the rows of the folds with one model, less that with another one."""
        folds, table = self.case.folds, self.case.table
        errors = one.of_units(table), other.of_units(table)
        return score(*errors, self.case.sums.order, folds, [self.noise] * len(folds.held))

    def fitted(self, hypothesis: Hypothesis, kept: Sequence[Claim]) -> Callable[[Mask], Model]:
        """The model with the kept causes, as a function of the blocks that it is fitted on."""
        causes = [claim.cause for claim in kept]

        def fitted(blocks: Mask) -> Model:
            fit = fit_with(self.case, hypothesis, blocks, self.noise)
            return self.case.base.model(effects_of(fit, causes), columns=columns_of(fit, causes))

        return fitted


def fit_with(case: Case, hypothesis: Hypothesis, blocks: Mask, noise: Noise) -> HypothesisFit:
    """Fit with the most likely noise, which is enough for a point estimate.

    Folds within different folds leave out the same blocks: each fit is made once.
    """
    key = noise, blocks.tobytes(), hypothesis.key
    if key not in case.fits:
        case.fits[key] = fit_hypothesis(hypothesis, case.whitened(noise, blocks))
    return case.fits[key]._replace(hypothesis=hypothesis)
