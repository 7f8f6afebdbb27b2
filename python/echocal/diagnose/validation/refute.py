"""Refutation of claims that make held-out rows less probable, or their error larger."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.inference.hypothesis import Hypothesis
from echocal.diagnose.selection.claims import Claim, without
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.gain import HeldOut, on_common_rows
from echocal.diagnose.validation.trials import Trials

__all__ = ["Rest", "against_the_base", "refute"]


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
    refuted : tuple of Refuted
    unjudged : tuple of str
        Kept causes that the folds cannot validate.
    """

    hypothesis: Hypothesis
    kept: tuple[Claim, ...]
    after: HeldOut
    refuted: tuple[Refuted, ...]
    unjudged: tuple[str, ...]


def refute(trials: Trials, selection: Selection, before: HeldOut) -> Rest:
    """Compare the claims one by one, then together with the base: docs/method.md, Eq. 29.

    The folds fit the sizes alone: the causes were chosen on all rows that they have.
    """
    rest = _one_by_one(trials, selection.best.hypothesis, selection.claims)
    log_score = trials.score(rest.after, before).total if rest.kept else 0.0
    supported = _smaller(rest.after, before)
    return rest if supported else against_the_base(trials, rest, before, log_score)


def _smaller(one: HeldOut, other: HeldOut) -> bool:
    """Whether the error is smaller on the rows that both can judge."""
    after, before = on_common_rows(one, other)
    return bool(after.rms < before.rms)


def _one_by_one(trials: Trials, hypothesis: Hypothesis, claimed: Sequence[Claim]) -> Rest:
    """Drop causes without which the error is not larger, the least probable one first."""
    kept, refuted, unjudged = tuple(claimed), [], []
    after = trials.of(hypothesis, kept)
    for claim in sorted(claimed, key=lambda c: c.probability):
        fewer = tuple(c for c in kept if c is not claim)
        lesser = without(hypothesis, claim.cause)
        alone = trials.of(lesser, fewer)
        if trials.cannot_judge(after, alone, trials.case.signal(claim.variant, claim.mean)):
            unjudged.append(claim.cause)
        elif not _smaller(after, alone):
            log_score = trials.score(after, alone).total
            figures = after.rms, alone.rms
            refuted.append(
                Refuted(claim.cause, claim.probability, *figures, claim.rivals, log_score=log_score)
            )
            hypothesis, kept, after = lesser, fewer, alone
    return Rest(hypothesis, kept, after, tuple(refuted), tuple(unjudged))


def against_the_base(trials: Trials, rest: Rest, before: HeldOut, log_score: float) -> Rest:
    """Drop all causes: the whole model is no better than the base.

    Two causes that compensate each other are both kept one by one, because the error with either
    alone may be larger. A cause that the folds cannot validate is kept: the small change that it
    makes in their errors is due to chance.

    Parameters
    ----------
    trials : Trials
    rest : Rest
    before : HeldOut
        Errors of the base.
    log_score : float
        Log density of the rows that judge with the model, less that with the base.
    """
    if not rest.kept:
        return rest
    after, base = on_common_rows(rest.after, before)
    if not after.known.any():
        return rest  # nothing speaks against it
    unjudged = tuple(claim for claim in rest.kept if claim.cause in rest.unjudged)
    hypothesis = rest.hypothesis
    for claim in rest.kept:
        hypothesis = hypothesis if claim in unjudged else without(hypothesis, claim.cause)
    signal = sum(trials.case.signal(claim.variant, claim.mean) for claim in unjudged)
    if unjudged and not trials.cannot_judge(trials.of(hypothesis, unjudged), before, np.asarray(signal)):
        for claim in unjudged:  # without the other causes, the folds can validate them
            hypothesis = without(hypothesis, claim.cause)
        unjudged = ()
    dropped = [claim for claim in rest.kept if claim not in unjudged]
    ids = tuple(claim.cause for claim in dropped)
    refuted = tuple(
        Refuted(c.cause, c.probability, after.rms, base.rms, c.rivals, ids, log_score) for c in dropped
    )
    kept = tuple(claim.cause for claim in unjudged)
    return Rest(hypothesis, unjudged, before, (*rest.refuted, *refuted), kept)
