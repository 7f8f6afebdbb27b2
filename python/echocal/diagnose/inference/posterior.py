"""Which hypotheses compete, and how probable each is before the data."""

import math
from collections.abc import Sequence

import numpy as np

from echocal import _core
from echocal.diagnose.candidates.effects import UNKNOWN, Candidates
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, Weighed, form
from echocal.diagnose.inference.noise import FINEST

__all__ = ["HOPELESS", "PRIOR", "posterior", "preferred", "set_prior"]

PRIOR = {"nothing": 0.44, "one": 0.45, "two": 0.1, "three": 0.01, UNKNOWN: 0.05}
"""Probability of no to three causes; and, independently, of a shape without a cause, the last resort.

Each cause beyond three is as rare beside the last as the third is beside the second.
"""

HOPELESS = 25.0
"""Log odds against the most probable hypothesis beyond which one is left out, and no set made of it.

None is told whose odds are beyond 14; but one beyond may lead to a larger set that is.
"""

_UNDECIDED = 1.5  # log odds between two forms of a cause below which neither is better


def posterior(found: Candidates, stack: Stack) -> tuple[list[Weighed], Stack]:
    """Weigh no cause, each cause, each pair, larger sets greedily, and the best of all beside each shape.

    Returns
    -------
    list of Weighed
        Most probable first; hypotheses that the data rule out are not among them.
    Stack
        The noises that were carried along.
    """
    order = {cause: i for i, cause in enumerate(dict.fromkeys(v.cause for v in found.variants))}
    forms = [form(v, None if v.cause == UNKNOWN else order[v.cause]) for v in found.variants]
    counts = [PRIOR[name] for name in ("nothing", "one", "two", "three")]
    outcomes, noises, _ = _core.posterior(
        stack.products,
        stack.log_weight,
        stack.degrees,
        FINEST**2,
        forms,
        counts,
        PRIOR[UNKNOWN],
        HOPELESS,
    )
    weighed = [
        Weighed(Hypothesis(tuple(found.variants[i] for i in chosen), prior), *result)
        for chosen, prior, result in outcomes
    ]
    return weighed, stack.only(np.array(noises))


def set_prior(ids: Sequence[str], causes: int) -> float:
    """Probability of one set of causes before the data, of as many causes as compete."""
    known = sum(id_ != UNKNOWN for id_ in ids)
    shape = PRIOR[UNKNOWN] if known < len(ids) else 1 - PRIOR[UNKNOWN]
    counts = [PRIOR[name] for name in ("nothing", "one", "two", "three")]
    rarer = (counts[3] / counts[2]) ** max(known - 3, 0)
    return shape * counts[min(known, 3)] * rarer / math.comb(causes, known)


def preferred(same: list[Weighed]) -> Weighed:
    """Of forms of the same causes, most probable first: the best, or a freer one that is as good.

    Where the data do not say which value is right, its uncertainty says so.
    """
    near = [w for w in same if w.log_posterior > same[0].log_posterior - _UNDECIDED]
    return max(near, key=lambda w: len(w.mean))
