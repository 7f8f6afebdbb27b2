"""Echoes that went a longer way."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.outliers import count_evidence, far_rule, one_sided_outliers
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    twice: float = threshold(0.03, "1", "of the ratio, around 2: what laws, thermometers and clocks do to it")
    each_twice: float = threshold(2.0, "1", "log Bayes factor of a row at twice the distance; judgement")


FACTS = CauseFacts(
    id="multipath",
    kind="row",
    sentence="The first echo was missed: one over a longer way, or the second round trip, was timed.",
    signature="single rows far too long; some at twice the distance",
    source="CATALOGUE; second echo at t' = 2t",
    parameters=(
        Quantity("rows", "1", "rows that read far too long"),
        Quantity("twice", "1", "of these, at twice the distance"),
    ),
    check="hang an absorber behind and beside the target, or narrow the beam",
    prior=0.02,
    formula="reading' = reading + longer way, or 2 * reading, in single rows",
    repair="leaves the rows out",
)


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Count rows that read far too long, and those at twice the distance."""
    rows = one_sided_outliers(view, 1, settings)
    count = int(rows.sum())
    if not count:
        return None
    with np.errstate(all="ignore"):
        twice = int((np.abs(view.indication[rows] / view.expected[rows] - 2) < own.twice).sum())
    worst = int(np.argmax(np.where(rows, view.deviation, 0.0)))
    because = (
        f"{listed(rows)} read far too long, {twice} of {count} at twice the distance (row {worst + 1}: "
        f"{view.indication[worst]:.3f} m, where {view.expected[worst]:.3f} m is expected); left out"
    )
    evidence = count_evidence(view, rows, settings) + own.each_twice * twice
    rules = (far_rule(view, FACTS.id, 1, settings),)
    return Found(rows, evidence, because, (count, twice), rules=rules, rivals=_rivals(view, rows))


def _rivals(view: View, rows: NDArray[np.bool_]) -> tuple[str, ...]:
    """The blanking distance, where all targets up to some distance read too long, and no other one."""
    if view.reference is None:
        return ()
    near = view.good & (view.reference <= view.reference[rows].max())
    return ("blanking_distance",) if rows[near].all() and not near[view.good].all() else ()


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Time an echo over a longer way in some rows, the second round trip in others."""
    rows = random.choice(len(table["reading_m"]), 6, replace=False)
    table["reading_m"][rows] *= np.append(random.uniform(1.15, 1.5, 4), [2.0, 2.0])


FAULT = Fault(FACTS, detect, spoil, Thresholds())
