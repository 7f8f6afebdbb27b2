"""Name the cause: from a table of echoes to what the base simulation gets wrong."""

from echocal.diagnose.engine import diagnose
from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.noises import noises
from echocal.diagnose.parts import Cause, Gain, NextMeasurement, Parameter, Refuted, Traces, Unexplained
from echocal.diagnose.result import Diagnosis

__all__ = [
    "Cause",
    "Diagnosis",
    "Gain",
    "NextMeasurement",
    "Parameter",
    "Refuted",
    "Traces",
    "Unexplained",
    "diagnose",
    "gross_faults",
    "noises",
    "row_faults",
]
