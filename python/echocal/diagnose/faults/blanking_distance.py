"""Targets nearer than the sensor can hear."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.faults.common.values import far
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule

__all__ = ["FAULT"]


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: float = threshold(2, "1", "outliers; judgement")
    unrelated: float = threshold(
        0.1, "1", "part of the distance that such readings miss it by, at the median; judgement"
    )
    least: float = threshold(0.03, "m", "the same in meters; judgement")
    part: float = threshold(
        0.9, "1", "part of the rows below the blanking distance that are outliers; judgement"
    )
    most: float = threshold(0.5, "1", "part of all rows that may be below the blanking distance; judgement")
    tame: float = threshold(
        0.1, "1", "probability that a row below the blanking distance is no outlier; judgement"
    )


FACTS = CauseFacts(
    id="blanking_distance",
    kind="row",
    sentence="The target stood nearer than the sensor can hear; it reports something else.",
    signature="all rows below some distance are outliers, and hardly any above",
    source="ESPEasy PR #1831 (HC-SR04 below 3 cm); alaudet/raspi-sump #67 (JSN-SR04T below 25 cm)",
    parameters=(
        Quantity("distance", "m", "largest distance whose rows are outliers"),
        Quantity("rows", "1", "rows"),
    ),
    check="move a target slowly toward the sensor and note where the reading leaves it",
    prior=0.01,
    formula="reading' = anything, where the target is nearer than distance",
    needs=("reference_distance",),
    repair="leaves out every row at or below the distance",
)


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Find the distance below which outliers are together."""
    reference = view.reference
    if reference is None or view.given is not None:
        return None
    own = settings.of(FACTS, Thresholds)
    outliers = far(view, settings.far)
    count = int(outliers.sum())
    good = np.flatnonzero(view.good)
    if count < own.fewest or np.ptp(reference[good]) == 0:
        return None
    order = good[np.argsort(reference[good], kind="stable")]
    ends = np.append(np.flatnonzero(np.diff(reference[order]) > 0), len(order) - 1)
    inside = np.cumsum(outliers[order])[ends]
    rows_inside = ends + 1
    fits = (inside >= own.part * rows_inside) & (rows_inside < own.most * len(order))
    fitting = np.flatnonzero(fits)
    if not len(fitting):
        return None
    last = int(fitting[-1])
    caught, size = int(inside[last]), int(rows_inside[last])
    elsewhere = (count - caught + 0.5) / (len(order) - size + 1.0)
    evidence = caught * -np.log(elsewhere) + (size - caught) * np.log(own.tame) - np.log(len(ends))
    if caught < own.fewest or evidence <= 0:
        return None
    inner = order[:size][outliers[order[:size]]]
    missed = max(own.unrelated * float(np.median(reference[inner])), own.least)
    if np.median(np.abs(view.deviation[inner])) < missed:
        return None
    limit = float(reference[order[size - 1]])
    near = view.good & (reference <= limit)
    example = order[int(np.argmax(outliers[order]))]
    because = (
        f"{caught} of {size} rows at or below {limit:.3f} m are outliers (row {example + 1} reads "
        f"{view.indication[example]:.3f} m at {reference[example]:.3f} m), {count - caught} of "
        f"{len(order) - size} beyond; those below are left out"
    )
    parameters = (Parameter("distance", limit, 0.0, "m"), Parameter("rows", float(caught), 0.0, "1"))
    evidence = float(min(evidence, settings.cap))
    rules = (RowRule(reason=FACTS.id, kind="at most", quantity="reference_distance", value=limit),)
    repaired = view.without(near, FACTS.id)
    return Finding(FACTS, evidence, because, parameters, near, repaired, rules=rules)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Report something else for the targets nearer than the largest of the nearest tenth."""
    near = table["distance_m"] <= np.quantile(table["distance_m"], 0.1)
    table["reading_m"][near] = random.uniform(1.0, 1.3, int(near.sum()))


FAULT = Fault(FACTS, detect, spoil, Thresholds())
