"""Which hypotheses compete, and how probable each is before the data."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from echocal import _core
from echocal.diagnose.candidates.variant import UNKNOWN, Candidates
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack, form
from echocal.diagnose.inference.noise import VARIANCE_FLOOR
from echocal.diagnose.settings import PriorSettings, Settings

__all__ = ["Inference", "infer", "posterior", "preferred", "set_prior"]


@dataclass(frozen=True)
class Inference:
    """The hypotheses after the data.

    Attributes
    ----------
    stack : Stack
        Products under every noise model.
    carried : Stack
        Products under the noise models that some hypothesis makes probable.
    fits : list of HypothesisFit
        Most probable first; hypotheses that the data rule out are not among them.
    """

    stack: Stack
    carried: Stack
    fits: list[HypothesisFit]


def infer(case: Case) -> Inference:
    """Fit every hypothesis that competes, on the rows that a fit may see."""
    stack = case.stack(case.folds.fit)
    fits, carried = posterior(case.found, stack, case.settings)
    return Inference(stack, carried, fits)


def posterior(found: Candidates, stack: Stack, settings: Settings) -> tuple[list[HypothesisFit], Stack]:
    """Fit no cause, each cause, each pair, larger sets greedily, and the best of all beside each term.

    Returns
    -------
    list of HypothesisFit
        Most probable first; hypotheses that the data rule out are not among them.
    Stack
        The noises that were carried along.
    """
    order = {cause: i for i, cause in enumerate(dict.fromkeys(v.cause for v in found.variants))}
    forms = [form(v, None if v.cause == UNKNOWN else order[v.cause]) for v in found.variants]
    priors = settings.priors
    outcomes, noises, _ = _core.posterior(
        stack.products,
        stack.log_weight,
        stack.degrees,
        VARIANCE_FLOOR**2,
        forms,
        priors.counts,
        priors.unexplained_term,
        settings.search.pruning_log_odds,
    )
    fits = [
        HypothesisFit(Hypothesis(tuple(found.variants[i] for i in chosen), prior), *result)
        for chosen, prior, result in outcomes
    ]
    return fits, stack.only(np.array(noises))


def set_prior(ids: Sequence[str], causes: int, priors: PriorSettings) -> float:
    """Probability of one set of causes before the data, of as many causes as compete."""
    known = sum(id_ != UNKNOWN for id_ in ids)
    shape = priors.unexplained_term if known < len(ids) else 1 - priors.unexplained_term
    counts = priors.counts
    rarer = (counts[3] / counts[2]) ** max(known - 3, 0)
    return shape * counts[min(known, 3)] * rarer / math.comb(causes, known)


def preferred(same: list[HypothesisFit], undecided: float) -> HypothesisFit:
    """Of forms of the same causes, most probable first: the best, or a freer one that is as good.

    Where the data do not say which value is right, its uncertainty says so.
    """
    near = [w for w in same if w.log_posterior > same[0].log_posterior - undecided]
    return max(near, key=lambda w: len(w.mean))
