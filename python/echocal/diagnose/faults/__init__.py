"""Faults of single rows and of whole columns, looked for before anything is fitted.

One file a fault: its facts, its thresholds, what it does to a table, and a detector that hands back
the rows, the repair and the evidence. `registry` lists them; `common` is what they share.
"""

from echocal.diagnose.faults.common.search import Faults, find_faults, gross_faults, row_faults
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.settings.faults import FaultSettings

__all__ = ["FaultSettings", "Faults", "Finding", "find_faults", "gross_faults", "row_faults"]
