"""A cause counts as present only as far as the data can show it: docs/method.md, Eq. 20 to 22.

The prior of a size includes sizes that are too small for these data to show. With such a size, a
set explains the rows as well as the set without the cause. Its probability says nothing about the
data, and it would fill the credible set with negligible causes. Therefore the part of the prior at
which a cause stays below the noise, beside the other causes of its set, counts as its absence. The
core computes it: rust/infer/src/search/ranking.rs.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.candidates.variant import UNKNOWN, number_of
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.posterior import core_prior
from echocal.diagnose.settings import PriorSettings

__all__ = ["Ids", "probabilities"]

Ids = tuple[str, ...]


def probabilities(
    fits: Sequence[HypothesisFit], causes: int, priors: PriorSettings
) -> tuple[NDArray[np.float64], dict[Ids, float]]:
    """Compute the probability of each hypothesis, and of each set of causes that are informative.

    Parameters
    ----------
    fits : sequence of HypothesisFit
        Most probable first.
    causes : int
        Number of causes that compete.
    priors : PriorSettings

    Returns
    -------
    ndarray
        Probability of each of `fits`; the sum is one.
    dict of tuple of str to float
        Probability of each set by its sorted ids, most probable first; the sum is one.
    """
    ids = {id_ for fit in fits for id_ in fit.hypothesis.causes}
    causes_of = {number_of(id_): id_ for id_ in ids}
    ranking = _core.rank(
        [[variant.form for variant in fit.hypothesis.variants] for fit in fits],
        np.array([fit.log_posterior for fit in fits]),
        [fit.covariance for fit in fits],
        causes,
        core_prior(priors),
    )
    sets = {
        tuple(sorted(UNKNOWN if cause is None else causes_of[cause] for cause in causes)): p
        for causes, p in ranking.sets
    }
    return ranking.probability, sets
