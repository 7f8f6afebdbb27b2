"""Where the target goes next, and whether another placement would tell more."""

from collections.abc import Sequence

from echocal.diagnose import Diagnosis, NextMeasurement
from echocal.diagnose.experiment_design.ranges import corners_and_middle

Span = tuple[float, float]

_TWICE = 2  # placements at each place: the second shows how exactly the target is placed


def places_of(span: Span) -> list[float]:
    """The places between two ends that the next measurements of a diagnosis are proposed at [m].

    Examples
    --------
    >>> from echocal.bench.places import places_of
    >>> places_of((0.3, 3.0))
    [0.3, 3.0, 0.949]
    """
    return [float(f"{place:.3g}") for place in corners_and_middle({"distance": span})["distance"]]


def next_place(span: Span, visited: Sequence[float], diagnosis: Diagnosis | None) -> float:
    """The place that was visited least; of several the one farthest from the last: far and near take turns.

    `span` is the nearest and the farthest distance, `visited` the proposed places so far [m]. Where the
    diagnosis of the rows so far proposes rows, the target goes to their places.

    Examples
    --------
    >>> from echocal.bench.places import next_place
    >>> visited = []
    >>> for _ in range(6):
    ...     visited.append(next_place((0.3, 3.0), visited, None))
    >>> visited
    [3.0, 0.3, 0.949, 3.0, 0.3, 0.949]
    """
    rows = _proposed(diagnosis)
    places = rows[0].conditions["distance"] if rows else places_of(span)
    last = visited[-1] if visited else 0.0
    return float(min(places, key=lambda place: (visited.count(place), -abs(place - last))))


def decides_nothing_more(span: Span, visited: Sequence[float], diagnosis: Diagnosis | None) -> bool:
    """Whether each place was visited twice, and the diagnosis expects nothing of further rows."""
    whole = all(visited.count(place) >= _TWICE for place in places_of(span))
    return whole and diagnosis is not None and not _proposed(diagnosis)


def _proposed(diagnosis: Diagnosis | None) -> list[NextMeasurement]:
    proposals = () if diagnosis is None else diagnosis.next_measurements
    return [one for one in proposals if one.expected_probability is not None]
