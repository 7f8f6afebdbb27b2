"""The posterior over hypotheses, computed by the core."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from echocal import _core
from echocal.diagnose.candidates.variant import Candidates
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack
from echocal.diagnose.inference.noise import VARIANCE_FLOOR
from echocal.diagnose.settings import PriorSettings, Settings

__all__ = ["Inference", "core_prior", "infer", "posterior", "preferred"]

Key = tuple[tuple[int, ...], float]


PRUNED = 25.0
"""Log odds behind the best, beyond which a hypothesis is left out: tests/test_diagnose_pruned.py."""

UNDECIDED = 1.5
"""Log odds within which the form of a cause with the most parameters is taken: docs/method.md, section 5."""


@dataclass(frozen=True)
class Inference:
    """The hypotheses after the data.

    Attributes
    ----------
    stack : Stack
        Products under every noise model.
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.
    fits : list of HypothesisFit
        Most probable first; hypotheses that the data rule out are not among them.
    """

    stack: Stack
    reduced: Stack
    fits: list[HypothesisFit]


def infer(case: Case, unlisted: float = 0.0) -> Inference:
    """Fit every hypothesis that competes, on the rows that a fit may see.

    The least probable ones, which share the probability `unlisted`, are left out.
    """
    stack = case.stack(case.folds.fit)
    fits, reduced = posterior(case.found, stack, case.settings, case.hypotheses, unlisted)
    return Inference(stack, reduced, fits)


def posterior(
    found: Candidates,
    stack: Stack,
    settings: Settings,
    known: dict[Key, Hypothesis] | None = None,
    unlisted: float = 0.0,
) -> tuple[list[HypothesisFit], Stack]:
    """Fit no cause, each cause, each pair, larger sets greedily, and the best of all beside each term.

    Parameters
    ----------
    found : Candidates
    stack : Stack
    settings : Settings
    known : dict, optional
        Hypotheses that were made of the same candidates before, by their forms and priors.
    unlisted : float
        Probability that the least probable hypotheses share, which are left out.

    Returns
    -------
    list of HypothesisFit
        Most probable first; hypotheses that the data rule out are not among them.
    Stack
        Products under the noise models that some hypothesis makes probable.
    """
    found_by_core = _core.posterior(
        stack.products,
        stack.log_weight,
        stack.degrees,
        VARIANCE_FLOOR**2,
        [variant.form for variant in found.variants],
        core_prior(settings.priors),
        _core.SearchOptions(PRUNED, UNDECIDED, unlisted),
    )
    known = {} if known is None else known
    fits = []
    for one in found_by_core.outcomes:
        key = tuple(one.forms), one.prior
        if key not in known:
            known[key] = Hypothesis(tuple(found.variants[i] for i in key[0]), one.prior)
        fits.append(HypothesisFit.of(known[key], one.fit))
    return fits, stack.only(np.array(found_by_core.noises))


def core_prior(priors: PriorSettings) -> _core.Prior:
    """Priors of the number of causes and of an unexplained term, for the core."""
    return _core.Prior(list(priors.counts), priors.unexplained_term)


def preferred(same: Sequence[HypothesisFit]) -> HypothesisFit:
    """Choose one of several forms of the same causes, given most probable first.

    If two forms are about equally probable, the data do not determine a parameter. The form with more
    coefficients is chosen, because its uncertainty shows this.
    """
    return same[_core.preferred_form([w.log_posterior for w in same], [len(w.mean) for w in same], UNDECIDED)]
