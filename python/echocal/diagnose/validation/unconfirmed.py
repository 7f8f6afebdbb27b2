"""Causes of the model that the rows which judge it do not show beside the others: docs/method.md, Eq. 49."""

from dataclasses import replace

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.selection.claims import without
from echocal.diagnose.validation.gain import on_common_rows
from echocal.diagnose.validation.judges import Judge
from echocal.diagnose.validation.trials import Rest, Trials
from echocal.diagnose.validation.validate import Validation

__all__ = ["unconfirmed"]


def unconfirmed(case: Case, validation: Validation, judge: Judge, noise: Noise) -> dict[str, str]:
    """Say of each cause whether the rows that judge the model show it.

    The whole model is better than the base on these rows, but one large cause is enough for that. The rows
    show a cause if they are more probable with it than without it, by odds that count as strong, and their
    error is smaller. Such a doubt changes no model: what these rows say must not choose what they measure.

    Parameters
    ----------
    case : Case
    validation : Validation
    judge : Judge
        The rows.
    noise : Noise
        The most likely noise beside the causes.

    Returns
    -------
    dict of str to str
        A sentence on each cause that they do not show.
    """
    kept = validation.kept
    if len(kept) < 2:
        return {}
    trials = Trials(case, noise)
    hypothesis = validation.fit.hypothesis
    whole = Rest(hypothesis, kept, judge.base())
    after, rows = judge.sized(trials, whole), validation.gain.judged_rows
    said = {}
    for claim in kept:
        others = tuple(other for other in kept if other is not claim)
        fewer = replace(whole, hypothesis=without(hypothesis, claim.cause), kept=others)
        alone = judge.sized(trials, fewer)
        score = judge.compared(trials, after, alone)
        one, other = on_common_rows(after, alone)
        if score.total < case.settings.claims.strong or one.rms >= other.rms:
            said[claim.cause] = (
                f"the {rows} do not show {claim.cause} beside the other causes: with it, their log density "
                f"changes by {score.total:+.1f}, and the error is {1e3 * after.rms:.2f} mm, without it "
                f"{1e3 * alone.rms:.2f} mm. So {claim.cause} is not named"
            )
    return said
