"""What to measure next: conditions under which causes that these data cannot separate differ."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.experiment_design.average import Member
from echocal.diagnose.experiment_design.design import Plan, planned
from echocal.diagnose.experiment_design.prospect import Prospect
from echocal.diagnose.experiment_design.ranges import Ranges, corners_and_middle
from echocal.diagnose.findings.parts import NextMeasurement
from echocal.diagnose.inference.case import Case
from echocal.diagnose.selection.select import Selection
from echocal.diagnose.validation.validate import Validation
from echocal.quantities import QUANTITIES

__all__ = ["propose"]

Column = NDArray[np.float64]

_WORKSHOP = {"distance": (0.3, 3.0)} | {q.id: q.workshop for q in QUANTITIES.values() if q.workshop}
"""Default ranges, in m and degC: a tape, a fridge and a warm box are enough for them."""

_ROWS = 10  # rows proposed
_WORTH = 0.05  # smallest increase of the expected probability for which rows are proposed
_SURE = 0.999
_LIKELY = 0.05  # smallest probability of a cause that gets a side measurement where no effect is detected
_MOST = 6  # side measurements, of the most probable rivals


def propose(
    case: Case,
    members: Sequence[Member],
    selection: Selection,
    validation: Validation,
    can_vary: Ranges | None,
) -> tuple[NextMeasurement, ...]:
    """Propose rows that separate the possible causes, and side measurements for the others."""
    if len(members) < 2 or members[0].probability >= _SURE:
        return ()
    claimed = [claim.cause for claim in validation.claims]
    noise, variance = selection.noise, selection.best.variance
    ranges = _ranges(case, can_vary)
    stations = _stations(case)
    varied = corners_and_middle(ranges)
    conditions = _conditions(case, varied, members)
    known = case.table.reference is not None or "distance" in ranges
    base = case.base_in_air.model()
    prospect = Prospect.of(members, base, conditions, noise, variance, known, stations)
    if not np.isfinite(prospect.shift).all() or not np.isfinite(prospect.spread).all():
        return _sides(members, (tuple(range(len(members))),), claimed)
    probability = np.array([member.posterior for member in members])
    same = prospect.aliases([len(member.ids) for member in members])
    plan = planned(prospect, probability, same, _ROWS, case.seed)
    rows = () if plan.expected < plan.now + _WORTH else (_rows(plan, varied, members),)
    return (*rows, *_sides(members, plan.classes, claimed))


def _stations(case: Case) -> Column:
    """Distances of the stations of the table, if they are few [m]."""
    reference = case.table.reference
    if reference is None:
        return np.empty(0)
    groups = np.unique(case.table.groups)
    return np.unique(reference) if len(groups) > 1 or np.ptp(reference) == 0 else np.empty(0)


def _ranges(case: Case, can_vary: Ranges | None) -> Ranges:
    if can_vary:
        return can_vary
    return {k: v for k, v in _WORKSHOP.items() if k == "distance" or k in case.table.conditions}


def _conditions(case: Case, varied: Mapping[str, Column], members: Sequence[Member]) -> dict[str, Column]:
    """Conditions of each place: the varied ones, else the median; the time is that of the last row.

    A further thermometer differs from that of the air by the median difference of these rows.
    """
    places = len(next(iter(varied.values())))
    recorded = {
        name: np.full(places, column.max() if QUANTITIES[name].runs_on else np.median(column))
        for name, column in case.table.conditions.items()
    }
    level = float(np.median(case.table.distance(case.base.plain)))
    given = {"distance": np.full(places, level), **recorded, **varied}
    bound = {q: name for member in members for q, name in member.model.columns.items()}
    for quantity, name in bound.items():
        apart = case.table.thermometers[name] - case.table.conditions["temperature"]
        given[quantity] = given["temperature"] + np.median(apart)
    return given


def _rows(plan: Plan, varied: Mapping[str, Column], members: Sequence[Member]) -> NextMeasurement:
    where = {name: [float(f"{value:.3g}") for value in column] for name, column in varied.items()}
    classes = plan.classes if len(plan.classes) > 1 else [[m] for m in plan.classes[0][:2]]
    separates = _differing([members[group[0]].ids for group in classes])
    return NextMeasurement({**where, "rows": list(plan.rows)}, separates, plan.expected, plan.now)


def _differing(sets: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Causes that are in some of these sets and not in all; an empty set is ``nothing``."""
    shared = set.intersection(*(set(ids) for ids in sets))
    names = [id_ for ids in sets for id_ in ids or ("nothing",) if id_ not in shared]
    return tuple(dict.fromkeys(names))


def _sides(
    members: Sequence[Member], classes: Sequence[tuple[int, ...]], claimed: Collection[str]
) -> tuple[NextMeasurement, ...]:
    """A check of each cause that no row separates from the claimed, or the first, of its class."""
    sides: dict[tuple[str, ...], NextMeasurement] = {}
    for group in classes:
        pivot = next((m for m in group if set(members[m].ids) == set(claimed)), group[0])
        for other in group:
            pair = _differing([members[pivot].ids, members[other].ids])
            rival = next((id_ for id_ in reversed(pair) if id_ != "nothing"), None)
            idle = not members[pivot].ids and members[other].probability < _LIKELY
            if rival is not None and pair not in sides and not idle:
                check = {"side_measurement": find_cause(rival).check}
                sides[pair] = NextMeasurement(check, pair, None)
    simple = {id_ for pair in sides if len(pair) <= 2 for id_ in pair}
    wanted = [side for pair, side in sides.items() if len(pair) <= 2 or not simple.issuperset(pair)]
    return tuple(wanted)[:_MOST]  # single differences also separate sets with several
