"""What difference matters to the user, and whether the effects that were found make one.

This decides what is told, and nothing else: no probability, no claim, no model.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.concise import decimal
from echocal.diagnose.findings.parts import Cause, Remainder, Unexplained, Verdict
from echocal.diagnose.inference.case import Case
from echocal.diagnose.preprocess.table import Table, levels
from echocal.diagnose.selection.claims import Claim
from echocal.errors import UsageError
from echocal.keywords import keyword

__all__ = ["Matters", "checked_mm", "contribution"]

_FAULTS = ("row", "gross")


@dataclass(frozen=True)
class Matters:
    """The difference of a reading from which on it matters.

    Attributes
    ----------
    difference_m : float
        The difference [m].
    because : str
        Where it comes from, as a phrase.
    """

    difference_m: float
    because: str

    @classmethod
    def of(cls, case: Case, stated_mm: float | None) -> "Matters":
        """What the user states, else what resolution and datasheets make of it.

        A reading is no better than its resolution: rounding to steps gives it the standard uncertainty
        step / sqrt(12) (GUM F.2.2.1). A hundredfold finer record shows differences that no user of such
        sensors has: then a tenth of the smallest error that a datasheet states is the difference.
        """
        if stated_mm is not None:
            return cls(1e-3 * stated_mm, f"stated: {keyword('matters_mm', stated_mm)}")
        datasheet, resolution = case.settings.claims.minor, case.table.rows.rounding
        if resolution > datasheet:
            step = decimal(1e3 * 12**0.5 * resolution)
            return cls(resolution, f"the standard uncertainty of readings in steps of {step} mm")
        return cls(datasheet, "a tenth of the 3 mm of an HC-SR04's datasheet")

    def told(self, cause: Cause) -> bool:
        """Whether a cause is told in full: all but an effect that adds less than this to every reading."""
        return cause.contribution_m is None or cause.contribution_m >= self.difference_m

    def good_enough(
        self,
        verdict: Verdict,
        causes: Sequence[Cause],
        unexplained: Unexplained | None,
        left: Remainder | None,
    ) -> bool:
        """Whether the data show effects, and all of them together change a reading by less than this."""
        if verdict == "nothing" or any(cause.kind in _FAULTS for cause in causes):
            return False
        rest = 0.0 if unexplained is None else unexplained.rms_m
        if left is not None:
            rest += float(np.sqrt(max(0.0, left.rms_m**2 - left.rms_floor_m**2)))
        effects = [cause for cause in causes if cause.kind == "effect"]
        shown = bool(effects) or unexplained is not None or left is not None
        together = _sum(cause.contribution_m for cause in effects if cause.in_model) + rest
        return shown and all(not self.told(c) for c in effects) and together < self.difference_m


def contribution(case: Case, claim: Claim) -> float:
    """The most that a claim adds to a reading [m]; where the distance is unknown, beside its mean."""
    signal = case.signal(claim.variant, claim.mean)
    return float(np.abs(_beside_level(case.table, signal)).max())


def checked_mm(given: float | None) -> float | None:
    """Refuse a difference that is no length.

    Raises
    ------
    UsageError
        If it is not above 0 and finite.
    """
    if given is not None and not (isinstance(given, int | float) and 0.0 < given < np.inf):
        message = f"{keyword('matters_mm', given)}: give the difference that matters in mm, above 0"
        raise UsageError(message)
    return given


def _beside_level(table: Table, signal: NDArray[np.float64]) -> NDArray[np.float64]:
    if table.reference is not None:
        return signal
    return np.asarray(signal - levels(signal, table.groups, np.ones(len(signal), dtype=bool), np.mean))


def _sum(sizes: Iterable[float | None]) -> float:
    return sum(size or 0.0 for size in sizes)
