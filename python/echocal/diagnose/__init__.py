"""Name the cause: from a table of echoes to what the base simulation gets wrong.

Its rooms, from the ground up; each imports what stands below it alone:

``findings``
    What the stages hand on: facts of a cause, findings, claims, gains.
``preprocess``
    Which rows are used, and how they belong together.
``candidates``
    What each cause, and each smooth function without a cause, would add to the readings.
``inference``
    Sums over the rows, the noise models, and the posterior over sets of causes.
``noises``, ``faults``
    Causes in the scatter and in single rows, a file each.
``selection``
    Which causes are claimed, with those that the data cannot separate from them.
``validation``
    The claims on held-out rows, and the gain measured there.
``experiment_design``
    What the members of a credible set predict, and the rows that separate them.
``results``
    The diagnosis as data and as sentences.
"""

from echocal.diagnose.engine import diagnose
from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.findings.parts import (
    Cause,
    Gain,
    NextMeasurement,
    Parameter,
    Refuted,
    Traces,
    Unexplained,
)
from echocal.diagnose.noises import noises
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.settings import Settings

__all__ = [
    "Cause",
    "Diagnosis",
    "Gain",
    "NextMeasurement",
    "Parameter",
    "Refuted",
    "Settings",
    "Traces",
    "Unexplained",
    "diagnose",
    "gross_faults",
    "noises",
    "row_faults",
]
