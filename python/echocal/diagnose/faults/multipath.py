"""Echoes that went a longer way."""

import numpy as np

from echocal.diagnose.faults.wild import count_evidence, wild_side
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_TWICE = 0.03  # of the ratio

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
)


def detect(view: View) -> Finding | None:
    """Count rows that read far too long, and those at twice the distance."""
    rows = wild_side(view, 1)
    count = int(rows.sum())
    if not 0 < count <= 0.3 * view.good.sum():
        return None
    with np.errstate(all="ignore"):
        twice = int((np.abs(view.indication[rows] / view.expected[rows] - 2) < _TWICE).sum())
    worst = int(np.argmax(np.where(rows, view.deviation, 0.0)))
    because = (
        f"{listed(rows)} read far too long, {twice} of {count} at twice the distance (row {worst + 1}: "
        f"{view.indication[worst]:.3f} m, where {view.expected[worst]:.3f} m is expected); left out"
    )
    parameters = (Parameter("rows", float(count), 0.0, "1"), Parameter("twice", float(twice), 0.0, "1"))
    evidence = count_evidence(view, count) + 2.0 * twice
    return Finding(FACTS, min(evidence, 60.0), because, parameters, rows, view.without(rows, FACTS.id))
