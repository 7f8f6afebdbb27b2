"""Waveforms in, echo times out: estimators, templates, bounds and files of captures."""

from echocal.waveforms.bound import cramer_rao_bound, ziv_zakai_bound
from echocal.waveforms.reading import read_waveforms
from echocal.waveforms.result import ECHO_STATUSES, EchoTimes
from echocal.waveforms.template import model_burst
from echocal.waveforms.timing import echo_times

__all__ = ["ECHO_STATUSES", "EchoTimes", "cramer_rao_bound", "echo_times", "model_burst"]
__all__ += ["read_waveforms", "ziv_zakai_bound"]
