"""Targets nearer than the sensor can hear."""

import numpy as np

from echocal.diagnose.faults.values import far
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_FEWEST = 2
_UNRELATED, _LEAST = 0.1, 0.03  # part of the distance, and m, that such readings miss it by
_PART = 0.9  # of the rows below the blanking distance that are wild

FACTS = CauseFacts(
    id="blanking_distance",
    kind="row",
    sentence="The target stood nearer than the sensor can hear; it reports something else.",
    signature="all rows below some distance are wild, and hardly any above",
    source="ESPEasy PR #1831 (HC-SR04 below 3 cm); alaudet/raspi-sump #67 (JSN-SR04T below 25 cm)",
    parameters=(Quantity("distance", "m", "largest distance that is wild"), Quantity("rows", "1", "rows")),
    check="move a target slowly toward the sensor and note where the reading leaves it",
    prior=0.01,
)


def detect(view: View) -> Finding | None:
    """Find the distance below which wild rows stand together."""
    reference = view.reference
    if reference is None or view.given is not None:
        return None
    wild = far(view)
    count = int(wild.sum())
    good = np.flatnonzero(view.good)
    if count < _FEWEST or np.ptp(reference[good]) == 0:
        return None
    order = good[np.argsort(reference[good], kind="stable")]
    ends = np.append(np.flatnonzero(np.diff(reference[order]) > 0), len(order) - 1)
    inside = np.cumsum(wild[order])[ends]
    rows_inside = ends + 1
    fitting = np.flatnonzero((inside >= _PART * rows_inside) & (rows_inside < 0.5 * len(order)))
    if not len(fitting):
        return None
    last = int(fitting[-1])
    caught, size = int(inside[last]), int(rows_inside[last])
    elsewhere = (count - caught + 0.5) / (len(order) - size + 1.0)
    evidence = caught * -np.log(elsewhere) + (size - caught) * np.log(0.1) - np.log(len(ends))
    if caught < _FEWEST or evidence <= 0:
        return None
    inner = order[:size][wild[order[:size]]]
    if np.median(np.abs(view.deviation[inner])) < max(
        _UNRELATED * float(np.median(reference[inner])), _LEAST
    ):
        return None
    limit = float(reference[order[size - 1]])
    near = view.good & (reference <= limit)
    example = order[int(np.argmax(wild[order]))]
    because = (
        f"{caught} of {size} rows at or below {limit:.3f} m are wild (row {example + 1} reads "
        f"{view.indication[example]:.3f} m at {reference[example]:.3f} m), {count - caught} of "
        f"{len(order) - size} beyond; those below are left out"
    )
    parameters = (Parameter("distance", limit, 0.0, "m"), Parameter("rows", float(caught), 0.0, "1"))
    return Finding(FACTS, float(min(evidence, 60.0)), because, parameters, near, view.without(near, FACTS.id))
