"""Name the cause: from a table of echoes to what the base simulation gets wrong.

Its rooms, from the ground up; each imports what stands below it alone:

``terms``
    What a diagnosis is made of, and how its numbers are said.
``table``
    Which rows are used, and how they belong together.
``signals``
    What each cause, and each shape without one, would add to the readings.
``evidence``
    Sums over the rows, the noise that is reckoned with, and how probable each set of causes is.
``noises``, ``faults``
    Causes in the scatter and in single rows, a file each.
``naming``
    What is claimed, with its rivals, and what remains.
``judging``
    Claims before rows that no fit saw, and the gain measured there.
``planning``
    What the members of a credible set predict, and the rows that tell them apart.
``telling``
    The diagnosis as a person reads it.
"""

from echocal.diagnose.engine import diagnose
from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.noises import noises
from echocal.diagnose.telling.result import Diagnosis
from echocal.diagnose.terms.parts import Cause, Gain, NextMeasurement, Parameter, Refuted, Traces, Unexplained

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
