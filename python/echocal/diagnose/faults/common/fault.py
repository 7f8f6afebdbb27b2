"""What the file of a fault hands to the registry."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Columns
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.causes import NoThresholds
from echocal.diagnose.settings.faults import FaultSettings

__all__ = ["Fault"]


@dataclass(frozen=True)
class Fault:
    """A fault of single rows or of whole columns.

    Attributes
    ----------
    facts : CauseFacts
    detect : callable
        Looks for the fault in a view of a table; hands back the rows, the repair and the evidence,
        or None.
    spoil : callable
        What the fault does to a table: changes it in place. The tests plant the fault with it.
    thresholds : object
        Defaults of the numbers that `detect` decides by.
    """

    facts: CauseFacts
    detect: Callable[[View, FaultSettings], Finding | None]
    spoil: Callable[[Columns, np.random.Generator], None]
    thresholds: object = NoThresholds()
