"""Faults of single rows and of whole columns, looked for before anything is weighed.

One file a fault: its facts, and a detector that hands back the rows, the repair and the evidence.
"""

from dataclasses import dataclass, replace

from echocal.diagnose.faults import (
    blanking_distance,
    censored_range,
    crosstalk,
    fahrenheit_celsius,
    mistyped_rows,
    multipath,
    round_trip_factor,
    shifted_rows,
    stuck_reading,
    swapped_columns,
    swapped_time_distance,
    timeout,
    unit_mixup,
)
from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.noises import find_steps
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.view import View
from echocal.observations import Observations

__all__ = ["Faults", "Finding", "find_faults", "gross_faults", "row_faults"]

_GROSS = (swapped_columns, swapped_time_distance, fahrenheit_celsius, round_trip_factor, unit_mixup)
# what concerns many rows comes first: it would make the rest look wild
_ROWS = (
    shifted_rows,
    censored_range,
    stuck_reading,
    mistyped_rows,
    timeout,
    blanking_distance,
    multipath,
    crosstalk,
)

_ACCEPTED = 0.5  # probability from which on a table is repaired
_WORTH = 1e-3  # probability from which on a fault has a place in the posterior


@dataclass(frozen=True)
class Faults:
    """What was found before the weighing.

    Attributes
    ----------
    observations : Observations
        The table as the rest of the diagnosis takes it.
    found : tuple of Finding
        Also those that are not accepted, as long as they are possible.
    """

    observations: Observations
    found: tuple[Finding, ...]

    @property
    def accepted(self) -> tuple[Finding, ...]:
        """Faults that the table was repaired of."""
        return tuple(f for f in self.found if f.probability >= _ACCEPTED)


def gross_faults() -> tuple[CauseFacts, ...]:
    """Return what is known about faults of whole columns.

    Examples
    --------
    >>> import echocal
    >>> [fault.id for fault in echocal.gross_faults()][-1]
    'unit_mixup'
    """
    return tuple(module.FACTS for module in _GROSS)


def row_faults() -> tuple[CauseFacts, ...]:
    """Return what is known about faults of single rows.

    Examples
    --------
    >>> import echocal
    >>> "timeout" in [fault.id for fault in echocal.row_faults()]
    True
    """
    return tuple(module.FACTS for module in _ROWS)


def find_faults(observations: Observations, base: Base, given: float | None, constant: bool) -> Faults:
    """Look for every fault in turn, each in the table that the ones before left.

    Parameters
    ----------
    observations : Observations
    base : Base
    given : float or None
        Reference distance of every row [m], where the user said it.
    constant : bool
        Whether the distance is only known to be constant.

    Returns
    -------
    Faults
        Whatever was repaired or left out stands in a finding, with its rows.
    """
    known = not constant and (given is not None or observations.reference_distance is not None)
    view = View(observations, base, given, known)
    found = []
    for module in (*_GROSS, *_ROWS):
        if module in _ROWS and not view.good.any():
            continue
        finding = module.detect(view)
        if finding is None or finding.probability < _WORTH:
            continue
        found.append(finding)
        if finding.probability >= _ACCEPTED and finding.repaired is not None:
            view = view.after(finding.repaired)
    if view.good.any():
        steps, harmless, view = find_steps(view)
        found += steps
    else:
        harmless = []
    told = [f for f in found if f.probability >= _ACCEPTED and f.facts.kind != "noise"]
    notes = tuple(f"{f.cause}: {f.because}" for f in told)
    return Faults(replace(view.observations, notes=(*observations.notes, *notes, *harmless)), tuple(found))
