"""Methods that time an echo; one file each, and one line here."""

from echocal.waveforms.estimators.common import Estimate, Estimator, Request
from echocal.waveforms.estimators.envelope import envelope
from echocal.waveforms.estimators.matched_filter import matched_filter
from echocal.waveforms.estimators.phase import phase
from echocal.waveforms.estimators.threshold import threshold

__all__ = ["ESTIMATORS", "Estimate", "Estimator", "Request"]

ESTIMATORS: dict[str, Estimator] = {
    "threshold": threshold,
    "envelope": envelope,
    "matched_filter": matched_filter,
    "phase": phase,
}
"""Estimator by method."""
