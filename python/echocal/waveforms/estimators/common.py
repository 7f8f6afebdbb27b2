"""What every estimator gets and gives."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from echocal.waveforms.baseband import Plan
from echocal.waveforms.detection import Detection, detect

__all__ = ["Estimate", "Estimator", "Real", "Request", "weights_of"]

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Request:
    """What is the same for all captures.

    Attributes
    ----------
    plan : Plan
        Template, band and filters.
    reference : Detection
        The template alone, without noise.
    reference_time : float
        Origin of the template in `reference` [s].
    threshold : ndarray or None
        Threshold of the comparator [unit of the waveform], shape (n,); None takes it from the noise.
    """

    plan: Plan
    reference: Detection
    reference_time: float
    threshold: Real | None = None

    @classmethod
    def of(cls, plan: Plan) -> "Request":
        """Return the request for a plan."""
        before = round(4.0 * plan.reach * plan.sample_rate)
        capture = np.concatenate([np.zeros(before), plan.template.samples, np.zeros(before)])
        alone = detect(replace(plan, samples=len(capture)), capture[None], np.ones(1))
        return cls(plan, alone, before / plan.sample_rate)

    @property
    def period(self) -> float:
        """Period of the carrier [s]."""
        return 1.0 / self.plan.carrier

    def of_block(self, place: slice) -> "Request":
        """Return the request for a block of captures."""
        return self if self.threshold is None else replace(self, threshold=self.threshold[place])


@dataclass(frozen=True)
class Estimate:
    """Times of the echoes, from the start of the window.

    Attributes
    ----------
    time, standard_uncertainty : ndarray, shape (n,)
        [s]; the uncertainty for noise that is known.
    cycle_ambiguity : ndarray
        Probability that another cycle is the right one [1].
    missing : ndarray of bool, or None
        Where the method finds no echo although there is one.
    """

    time: Real
    standard_uncertainty: Real
    cycle_ambiguity: Real
    missing: NDArray[np.bool_] | None = None


Estimator: TypeAlias = Callable[[Request, Detection], Estimate]
"""Times detected echoes."""


def weights_of(excess: Real, freedom: Real) -> Real:
    """Posterior weight of each cycle, which sum to 1 along the last axis.

    Parameters
    ----------
    excess : ndarray, shape (n, K)
        Sum of squared residuals above that of the best cycle, by the variance of the noise.
    freedom : ndarray, shape (n,)
        Degrees of freedom of that variance: with few, the likelihood is that of Student's t.
    """
    known = np.isinf(freedom)[:, None]
    many = np.where(known, 1.0, freedom[:, None])
    log = np.where(known, -0.5 * excess, -0.5 * many * np.log1p(excess / many))
    weights = np.exp(log)
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))
