"""The search for every fault in turn."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

from echocal.diagnose.faults import registry
from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.noises.common.quantization import find_steps
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.threshold import PROBABLE
from echocal.observations import Observations
from echocal.observations.marks import MARKS, RowRule

__all__ = ["Faults", "find_faults", "gross_faults", "row_faults"]


@dataclass(frozen=True)
class Faults:
    """What was found before causes of the mean are compared.

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
        return tuple(f for f in self.found if f.probability >= PROBABLE)

    @property
    def quantizations(self) -> list[str]:
        """Ids of the quantizations among them."""
        return [f.cause for f in self.accepted if f.facts.kind == "noise"]

    @property
    def rounding(self) -> dict[str, float]:
        """Standard deviation of the error of rounding of readings or echo times [m], by their column."""
        found = {f.facts.needs[0]: f.rms for f in self.accepted if f.facts.kind == "noise"}
        return {name: rms for name, rms in found.items() if name in {"reading", "echo_time"}}

    def rules(self, more: Sequence[RowRule] = ()) -> tuple[RowRule, ...]:
        """Rules for rows in the order in which a correction takes them.

        Those for typing errors, and further ones, come last, because they are met by every far row.
        """
        faults = [f for f in self.accepted if f.facts.kind != "noise"]
        ordered = sorted(faults, key=lambda finding: finding.cause == "mistyped_rows")
        return (*(r for f in ordered for r in f.rules), *more)

    def marks(self, more: Sequence[RowRule] = (), unmet: Sequence[str] = ()) -> dict[str, Any]:
        """What a model file keeps: rules for rows, and what no rule finds, as plain data."""
        faults = [f for f in self.accepted if f.facts.kind != "noise"]
        without = [finding.cause for finding in faults if not finding.rules and finding.share > 0.0]
        marks = {
            "rules": [rule.to_dict() for rule in self.rules(more)],
            "without_rule": [*without, *unmet],
        }
        return {MARKS: marks} if faults or more or unmet else {}

    @property
    def explain_a_refusal(self) -> bool:
        """Whether a fault of a whole column was repaired and rows are left to use."""
        gross = any(f.facts.kind == "gross" and f.share > 0.0 for f in self.accepted)
        return gross and bool(self.observations.usable.any())


def gross_faults() -> tuple[CauseFacts, ...]:
    """Return what is known about faults of whole columns.

    Examples
    --------
    >>> import echocal
    >>> 'unit_mixup' in [fault.id for fault in echocal.gross_faults()]
    True
    """
    return tuple(fault.facts for fault in registry.of_kind("gross"))


def row_faults() -> tuple[CauseFacts, ...]:
    """Return what is known about faults of single rows.

    Examples
    --------
    >>> import echocal
    >>> "timeout" in [fault.id for fault in echocal.row_faults()]
    True
    """
    return tuple(fault.facts for fault in registry.of_kind("row"))


def find_faults(
    observations: Observations,
    base: Base,
    given: float | None,
    constant: bool,
    settings: Settings,
    columns: Collection[str] | None = None,
) -> Faults:
    """Look for every fault in turn, each in the table that the ones before left.

    Parameters
    ----------
    observations : Observations
    base : Base
    given : float or None
        Reference distance of every row [m], where the user said it.
    constant : bool
        Whether the distance is only known to be constant.
    settings : Settings
    columns : collection of str, optional
        Faults of whole columns that are looked for. Default: all.

    Returns
    -------
    Faults
        Whatever was repaired or left out is in a finding, with its rows.
    """
    own, fewest = settings.faults, settings.rows.fewest
    own.refuse_others([fault.facts.id for fault in registry.FAULTS], "fault")
    known = not constant and (given is not None or observations.reference_distance is not None)
    view = View(observations, base, given, known, settings.noises.step_by_chance)
    found = []
    for fault in registry.FAULTS:
        if fault.facts.kind == "row" and not view.good.any():
            continue
        if fault.facts.kind == "gross" and columns is not None and fault.facts.id not in columns:
            continue
        finding = fault.search(view, own)
        if finding is None or not finding.probability >= own.listed:  # nor one that is not a number
            continue
        if finding.probability >= PROBABLE and finding.repaired is not None:
            after = view.after(finding.repaired)
            if fault.facts.kind == "row" and after.good.sum() < fewest <= view.good.sum():
                continue  # what nearly all rows have is the scene, and no fault of rows
            view = after
        found.append(finding)
    harmless: list[str] = []
    if view.good.any():
        steps, harmless, view = find_steps(view, settings.noises)
        found += steps
    reported = [f for f in found if f.probability >= PROBABLE and f.facts.kind != "noise"]
    notes = tuple(f"{f.cause}: {f.because}" for f in reported)
    notes = (*observations.notes, *notes, *harmless)
    return Faults(replace(view.observations, notes=notes), tuple(found))
