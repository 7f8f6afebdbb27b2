"""From a table of echoes to the causes of what the base simulation gets wrong.

The packages, in layers from the lowest to the highest; each imports lower ones only:

``findings``
    What the stages pass on: facts of a cause, findings, claims, gains.
``preprocess``
    Which rows are used, and how they belong together.
``candidates``
    What each cause, and each unexplained term, would add to the readings.
``inference``
    Sums over the rows, the noise models, and the posterior over sets of causes.
``noises``, ``faults``
    Causes that act on the noise, on single rows or on whole columns, a file each.
``selection``
    Which causes are claimed, with those that the data cannot separate from them.
``validation``
    The claims and the gain on cross-validated or held-out rows.
``experiment_design``
    What the members of a credible set predict, and the measurements that separate them.
``results``
    The diagnosis as data and as sentences.
``pooling``
    Several tables together: which causes they share.
"""

from echocal._verb import callable_as
from echocal.diagnose.engine import diagnose
from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.findings.parts import (
    Cause,
    Gain,
    NextMeasurement,
    Parameter,
    Refuted,
    Remainder,
    SmoothCorrection,
    Traces,
    Unexplained,
)
from echocal.diagnose.noises import noises
from echocal.diagnose.pooling.engine import diagnose_many
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.settings import Settings

__all__ = [
    "Cause",
    "Diagnosis",
    "Gain",
    "NextMeasurement",
    "Parameter",
    "Refuted",
    "Remainder",
    "Settings",
    "SmoothCorrection",
    "Traces",
    "Unexplained",
    "diagnose",
    "diagnose_many",
    "gross_faults",
    "noises",
    "row_faults",
]

callable_as(__name__)
