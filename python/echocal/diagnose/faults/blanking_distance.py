"""Targets nearer than the sensor can hear."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.likelihood import STRAY, independent, log_density
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule
from echocal.observations.quantiles import Grouped

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_ENOUGH = 20_000  # rows that are enough
_DISTANCES = 2  # at which something else is none of a single station
_ROUNDS = 2  # fits of the rows beyond: the first one has the rows below in it
_FAR = 6.0  # scatters: farther rows are strays


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    most: float = threshold(0.5, "1", "part of all rows that may be below the blanking distance; judgement")
    usual: float = threshold(
        0.25,
        "m",
        "mean of the prior of blanking distances: 3 cm (HC-SR04), 25 cm (JSN-SR04T), 50 cm (SR50)",
    )


FACTS = CauseFacts(
    id="blanking_distance",
    kind="row",
    sentence="The target stood nearer than the sensor can hear; it reports something else.",
    signature="all rows below some distance read one constant, or are outliers; those above are right",
    source="ESPEasy PR #1831 (HC-SR04 below 3 cm); alaudet/raspi-sump #67 (JSN-SR04T below 25 cm)",
    parameters=(
        Quantity("distance", "m", "largest distance whose rows are outliers"),
        Quantity("rows", "1", "rows"),
    ),
    check="move a target slowly toward the sensor and note where the reading leaves it",
    prior=0.01,
    formula="reading' = a constant, or anything, where the target is nearer than distance",
    needs=("reference_distance",),
    repair="leaves out every row at or below the distance",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Find the distance up to which readings are one constant, or anything, but not the distance.

    The likelihood of the rows at the nearest distances, if the sensor did not hear the target, is compared
    with that given the error of the rows beyond. Rows of one distance count once: they may share an error as
    large as the scatter.
    """
    if view.reference is None or view.given is not None:
        return None
    good = np.flatnonzero(view.good)
    good = good[:: max(1, len(good) // _ENOUGH)]
    distance, unit = np.unique(view.reference[good], return_inverse=True)
    end = np.arange(1, len(distance) + 1) >= _DISTANCES
    end &= np.cumsum(np.bincount(unit)) < own.most * len(good)
    if not end.any():
        return None
    by_distance, others = Grouped(unit), view
    reading = by_distance.median(view.indication[good])
    for _round in range(_ROUNDS):
        expected = by_distance.median(others.expected[good])
        evidence = _unheard(reading, expected, others.scatter, end)
        last = int(evidence.argmax())
        limit = float(distance[last])
        near = view.good & (view.reference <= limit)
        others = view.after(view.without(near, FACTS.id))
        if evidence[last] <= 0.0:
            return None
    if not others.good.any():
        return None
    evidence *= independent(others.deviation[others.good])
    low, level, high = np.quantile(view.indication[near], (0.0, 0.5, 1.0))
    told = f"{level:.3f} m" if high - low < 6 * others.scatter else f"{low:.3f} to {high:.3f} m"
    because = (
        f"all {int(near.sum())} rows at or below {limit:.3f} m read {told}, whatever their distance "
        f"({distance[0]:.3f} to {limit:.3f} m): the sensor does not hear such a target; left out"
    )
    rules = (RowRule(reason=FACTS.id, kind="at most", quantity="reference_distance", value=limit),)
    return Found(near, evidence[last] - limit / own.usual, because, (limit, near.sum()), rules=rules)


def _unheard(indication: Column, expected: Column, scatter: float, end: NDArray[np.bool_]) -> Column:
    """Log Bayes factor that readings up to each distance are one constant, or anything.

    Its rivals are that they are right, and that all of them are off by one length.
    """
    wide, off = float(np.ptp(indication)) + scatter, indication - expected
    stray = max(STRAY, float(np.mean(np.abs(off) > _FAR * scatter)))
    right = log_density(off, scatter, wide, stray)
    best, first = np.full(len(indication), -np.inf), int(end.argmax()) + 1
    while first <= len(indication):
        constant, moved = (values - np.median(values[:first]) for values in (indication, off))
        blind = log_density(constant, scatter, wide, 0.5)
        rivals = (right, log_density(moved, scatter, wide, stray))
        against = [np.cumsum(blind - rival) for rival in rivals]
        best = np.maximum(best, np.minimum(*against) - np.log(end.sum()))
        first = 2 * first
    return np.where(end, best, -np.inf)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Report something else for the targets nearer than the largest of the nearest tenth."""
    near = table["distance_m"] <= np.quantile(table["distance_m"], 0.1)
    table["reading_m"][near] = random.uniform(1.0, 1.3, int(near.sum()))


FAULT = Fault(FACTS, detect, spoil, Thresholds())
