"""The hypotheses once more, without what a noise adds to the readings."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.posterior import Inference, infer

__all__ = ["log_evidence", "without"]


def without(case: Case, off: NDArray[np.float64]) -> tuple[Case, Inference]:
    """Subtract what a noise adds to each row [m], and compare the hypotheses on the rest."""
    offsets = off if case.offsets is None else off + case.offsets
    other = examine(case.table, case.base, case.folds, case.seed, case.settings, offsets)
    return other, infer(other)


def log_evidence(inference: Inference, noises: NDArray[np.bool_] | None = None) -> float:
    """Log evidence of all hypotheses together, under some of the noise models."""
    log = np.array([one.log_posterior for one in inference.fits])
    if noises is None:
        return float(np.logaddexp.reduce(log))
    with np.errstate(divide="ignore"):
        return float(np.logaddexp.reduce(log + np.log([one.noise[noises].sum() for one in inference.fits])))
