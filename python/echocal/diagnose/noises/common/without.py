"""The hypotheses once more, without what a noise adds to the readings."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.posterior import Inference, infer

__all__ = ["log_evidence", "without"]


def without(
    case: Case, off: NDArray[np.float64], averaged: Mapping[str, NDArray[np.int64]] | None = None
) -> tuple[Case, Inference]:
    """Subtract what a noise adds to each row [m], and compare the hypotheses on the rest.

    `averaged` has the segments in which `off` has all that an effect varies, by id.
    """
    offsets = off if case.offsets is None else off + case.offsets
    given = case.table, case.base, case.folds, case.seed, case.settings
    other = examine(*given, offsets, averaged=averaged or {})
    return other, infer(other)


def log_evidence(inference: Inference, noises: NDArray[np.bool_] | None = None) -> float:
    """Log evidence of all hypotheses together, under some of the noise models."""
    log = np.array([one.log_posterior for one in inference.fits])
    if noises is None:
        return float(np.logaddexp.reduce(log))
    with np.errstate(divide="ignore"):
        return float(np.logaddexp.reduce(log + np.log([one.noise[noises].sum() for one in inference.fits])))
