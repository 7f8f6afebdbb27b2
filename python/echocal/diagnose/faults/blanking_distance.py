"""Targets nearer than the sensor can hear."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.faults.common.values import far
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding, probability
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule
from echocal.observations.quantiles import Grouped

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_ENOUGH = 20_000  # rows that are enough
_DISTANCES = 2  # at which a constant is none of a single station
_ROUNDS = 2  # fits of the rows beyond: the first one has the rows below in it


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
    usual: float = threshold(
        0.25,
        "m",
        "mean of the prior of blanking distances: 3 cm (HC-SR04), 25 cm (JSN-SR04T), 50 cm (SR50)",
    )
    stray: float = threshold(0.02, "1", "probability that a single row is anywhere; judgement")


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


class _Zone(NamedTuple):
    """Rows that are nearer than the sensor can hear.

    Attributes
    ----------
    limit : float
        Largest distance of such a row [m].
    evidence : float
        Log Bayes factor against no such rows.
    rows : int
        Number of rows that show it.
    because : str
        What they show.
    """

    limit: float
    evidence: float
    rows: int
    because: str


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Find the distance below which readings are one constant, or outliers are together."""
    if view.reference is None or view.given is not None:
        return None
    own = settings.of(FACTS, Thresholds)
    zones = [zone for zone in (_constant(view, own), _outliers(view, settings, own)) if zone is not None]
    able = [zone for zone in zones if probability(zone.evidence, FACTS.prior) >= settings.accepted]
    found = max(able or zones, key=lambda zone: zone.limit, default=None)
    if found is None:
        return None
    evidence = float(min(found.evidence - found.limit / own.usual, settings.cap))
    near = view.good & (view.reference <= found.limit)
    parameters = (
        Parameter("distance", found.limit, 0.0, "m"),
        Parameter("rows", float(found.rows), 0.0, "1"),
    )
    rules = (RowRule(reason=FACTS.id, kind="at most", quantity="reference_distance", value=found.limit),)
    repaired = view.without(near, FACTS.id)
    return Finding(FACTS, evidence, found.because, parameters, near, repaired, rules=rules)


def _constant(view: View, own: Thresholds) -> _Zone | None:
    """The distance up to which all readings are one constant.

    The likelihood of the readings at the nearest distances, given one constant, is compared with that given
    the error of the rows beyond. Rows of one distance count once: they may share an error as large as the
    scatter. At two distances at least, or the constant is one station's.
    """
    assert view.reference is not None
    good = np.flatnonzero(view.good)
    good = good[:: max(1, len(good) // _ENOUGH)]
    distance, unit = np.unique(view.reference[good], return_inverse=True)
    end = np.arange(1, len(distance) + 1) >= _DISTANCES
    end &= np.cumsum(np.bincount(unit)) < own.most * len(good)
    if not end.any():
        return None
    by_distance, others = Grouped(unit), view
    reading = by_distance.median(view.indication[good])
    for _ in range(_ROUNDS):
        expected = by_distance.median(others.expected[good])
        best, level = _nearest(reading, expected, others.scatter, end, own)
        limit = float(distance[int(best.argmax())])
        others = view.after(view.without(view.good & (view.reference <= limit), FACTS.id))
        if best.max() <= 0.0 or not others.good.any():
            return None
    rows = int((view.good & (view.reference <= limit)).sum())
    because = (
        f"all {rows} rows at or below {limit:.3f} m read {level:.3f} m, whatever their distance "
        f"({distance[0]:.3f} to {limit:.3f} m): the sensor does not hear such a target; left out"
    )
    return _Zone(limit, float(best.max()), rows, because)


def _nearest(
    indication: Column, expected: Column, scatter: float, end: NDArray[np.bool_], own: Thresholds
) -> tuple[Column, float]:
    """Log Bayes factor that readings up to each distance are one constant, and this constant.

    Its rivals are that they are right, and that all of them are off by one length.
    """
    wide, off = float(np.ptp(indication)) + scatter, indication - expected
    right = _log_density(off, scatter, wide, own)
    best, level, first = np.full(len(indication), -np.inf), np.nan, int(end.argmax()) + 1
    while first <= len(indication):
        middle, moved = float(np.median(indication[:first])), float(np.median(off[:first]))
        blind = _log_density(indication - middle, scatter, wide, own)
        against_right = np.cumsum(blind - right) - np.log(wide / scatter)
        against_moved = np.cumsum(blind - _log_density(off - moved, scatter, wide, own))
        evidence = np.minimum(against_right, against_moved) - np.log(end.sum())
        evidence[~end] = -np.inf
        if evidence.max() > best.max():
            best, level = evidence, middle
        first = 2 * first
    return best, level


def _log_density(off: Column, spread: float, wide: float, own: Thresholds) -> Column:
    """Log density of normal noise, or of anything in a range."""
    normal = np.log1p(-own.stray) - 0.5 * (off / spread) ** 2 - np.log(spread * np.sqrt(2 * np.pi))
    return np.asarray(np.logaddexp(normal, np.log(own.stray / wide)))


def _outliers(view: View, settings: FaultSettings, own: Thresholds) -> _Zone | None:
    """The distance up to which nearly all rows are outliers."""
    reference = view.reference
    assert reference is not None
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
    example = order[int(np.argmax(outliers[order]))]
    because = (
        f"{caught} of {size} rows at or below {limit:.3f} m are outliers (row {example + 1} reads "
        f"{view.indication[example]:.3f} m at {reference[example]:.3f} m), {count - caught} of "
        f"{len(order) - size} beyond; those below are left out"
    )
    return _Zone(limit, float(evidence), caught, because)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Report something else for the targets nearer than the largest of the nearest tenth."""
    near = table["distance_m"] <= np.quantile(table["distance_m"], 0.1)
    table["reading_m"][near] = random.uniform(1.0, 1.3, int(near.sum()))


FAULT = Fault(FACTS, detect, spoil, Thresholds())
