"""Late echoes of another ping."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.one_value import one_value
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

    least: float = threshold(
        0.05, "1", "part of the distance: a tilted target reads short by less; judgement"
    )


FACTS = CauseFacts(
    id="crosstalk",
    kind="row",
    sentence="The late echo of the ping before, or of another sensor, was taken for the echo.",
    signature="single rows far too short, by no common amount",
    source="gpiozero #435: wait 60 ms between pings; NewPing MAX_SENSOR_DELAY 5800 us",
    parameters=(Quantity("rows", "1", "rows that read far too short"),),
    check="wait longer between pings, or let one sensor ping at a time",
    prior=0.02,
    formula="reading' = part * reading, 0 < part < 1, in single rows",
    repair="leaves the rows out",
)


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Count rows that read far too short."""
    rows = one_sided_outliers(view, -1, settings, own.least)
    count = int(rows.sum())
    if not count:
        return None
    worst = int(np.argmin(np.where(rows, view.deviation, 0.0)))
    because = (
        f"{listed(rows)} read far too short (row {worst + 1}: {view.indication[worst]:.3f} m, where "
        f"{view.expected[worst]:.3f} m is expected); left out"
    )
    rules = (far_rule(view, FACTS.id, -1, settings, own.least),)
    evidence = count_evidence(view, rows, settings) - _of_one_place(view, rows, settings)
    return Found(rows, evidence, because, (count,), rules=rules)


def _of_one_place(view: View, rows: NDArray[np.bool_], settings: FaultSettings) -> float:
    """Log Bayes factor of echoes of one place, but for a few, against those from anywhere; at least 0."""
    found = one_value(view, rows & (view.indication > 0), view.indication, settings, FACTS.id)
    if found is None:
        return 0.0
    others = int(rows.sum()) - len(found.rows)
    by_chance = others * np.log(settings.constant.wild) - np.log(settings.constant.range)
    return max(0.0, float(found.as_echoes + by_chance - found.as_wild))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Take an earlier ping's echo for the echo in some rows."""
    rows = random.choice(len(table["reading_m"]), 5, replace=False)
    table["reading_m"][rows] *= random.uniform(0.3, 0.8, 5)


FAULT = Fault(FACTS, detect, spoil, Thresholds())
