"""Late echoes of another ping."""

import numpy as np

from echocal.diagnose.faults.wild import count_evidence, wild_side
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_LEAST = 0.05  # part of the distance; a tilted target reads short by less

FACTS = CauseFacts(
    id="crosstalk",
    kind="row",
    sentence="The late echo of the ping before, or of another sensor, was taken for the echo.",
    signature="single rows far too short, by no common amount",
    source="gpiozero #435: wait 60 ms between pings; NewPing MAX_SENSOR_DELAY 5800 us",
    parameters=(Quantity("rows", "1", "rows that read far too short"),),
    check="wait longer between pings, or let one sensor ping at a time",
    prior=0.02,
)


def detect(view: View) -> Finding | None:
    """Count rows that read far too short."""
    rows = wild_side(view, -1, _LEAST)
    count = int(rows.sum())
    if not 0 < count <= 0.3 * view.good.sum():
        return None
    worst = int(np.argmin(np.where(rows, view.deviation, 0.0)))
    because = (
        f"{listed(rows)} read far too short (row {worst + 1}: {view.indication[worst]:.3f} m, where "
        f"{view.expected[worst]:.3f} m is expected); left out"
    )
    parameters = (Parameter("rows", float(count), 0.0, "1"),)
    return Finding(
        FACTS, count_evidence(view, count), because, parameters, rows, view.without(rows, FACTS.id)
    )
