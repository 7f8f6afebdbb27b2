"""From observations to the table of a diagnosis."""

from collections.abc import Mapping, Sequence

import numpy as np

from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.level_steps import level_steps
from echocal.diagnose.preprocess.off_station import OFF_STATION, far_from_station
from echocal.diagnose.preprocess.outliers import without_far_rows
from echocal.diagnose.preprocess.reference import reference_of
from echocal.diagnose.preprocess.row_mixture import PERIOD
from echocal.diagnose.preprocess.segments import divided
from echocal.diagnose.preprocess.stations import moved, stations
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.preprocess.units import joined
from echocal.diagnose.preprocess.usable import some, usable_rows
from echocal.diagnose.settings.rows import RowSettings
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations import Observations

__all__ = ["prepare"]

_ROUNDING = 1e-12  # of a value: what arithmetic leaves between equal rows


def prepare(
    observations: Observations,
    base: Base,
    reference_distance: float | None,
    constant_distance: bool,
    settings: RowSettings,
    more_steps: Sequence[int] = (),
    rounding: Mapping[str, float] | None = None,
) -> Table:
    """Leave out unusable rows and outliers, and find stations, segments and series.

    Parameters
    ----------
    observations : Observations
    base : Base
    reference_distance : float or None
        Of every row [m], where the user gave it.
    constant_distance : bool
        Whether the distance is only known to be constant.
    settings : RowSettings
    more_steps : sequence of int
        Source rows of further steps of an unknown level, found by an earlier round.
    rounding : mapping of str to float, optional
        Standard deviation of the error of rounding [m] of ``reading`` or ``echo_time``, where it has a step.

    Raises
    ------
    DataError
        If too few rows are left.
    UsageError
        If neither the table nor the user gives the distance.
    """
    reference = reference_of(observations, reference_distance, constant_distance)
    usable = usable_rows(observations, base, reference)
    step = 12**0.5 * max((rounding or {}).values(), default=0.0)
    usable, labels = without_far_rows(observations, usable, reference, settings, step), None
    if reference is not None and len(usable.rows):
        warm = observations.conditions.get("temperature")
        labels = stations(observations, reference, usable.rows, settings)
        temperature = None if warm is None else some(warm, usable.rows)
        far = far_from_station(usable.indication, labels, temperature, settings, step)
        if far.any():
            usable = usable.without(far, OFF_STATION)
            labels = stations(observations, reference, usable.rows, settings)
    rows, indication = usable.rows, usable.indication
    left_out = dict(sorted(usable.left_out.items()))
    if len(rows) < settings.fewest:
        why = "".join(f", {len(where)} {reason}" for reason, where in left_out.items())
        message = (
            f"a diagnosis needs at least {settings.fewest} usable rows; of {len(observations)}, "
            f"{len(rows)} are{why}"
        )
        raise DataError(message)
    conditions = {name: some(column, rows) for name, column in observations.conditions.items()}
    air = (column for name, column in conditions.items() if name not in {"elapsed_time", "hour_angle"})
    same = (indication, *air, *(() if reference is None else (some(reference, rows),)))
    if all(np.ptp(column) <= _ROUNDING * np.abs(column).max() for column in same):
        message = (
            f"all {len(rows)} usable rows have the same values, so they are one measurement: a diagnosis "
            "needs other distances, temperatures or readings"
        )
        raise DataError(message)
    elapsed = conditions.get("elapsed_time")
    steps = np.empty(0, dtype=np.int64)
    if reference is None:
        steps = level_steps(indication, elapsed, conditions.get("temperature"), settings)
        steps = np.union1d(steps, np.flatnonzero(np.isin(rows, more_steps)))
    breaks = np.zeros(len(rows), dtype=bool)
    if reference is None:
        breaks[1:] |= moved(observations, rows)
    groups = np.cumsum(breaks) if labels is None else labels
    if reference is None and len(rows) - groups[-1] - 1 < settings.fewest:
        message = (
            f"with {keyword('constant_distance')} the distance of each placement is unknown, and "
            f"{len(rows)} usable rows have {groups[-1] + 1} of them. A diagnosis needs at least "
            f"{settings.fewest} rows more than placements"
        )
        if groups[-1]:
            message += (
                ": column 'stand' changes that often: sort the rows by placement, leave the column out "
                f"({keyword('columns', {'stand': 'ignore'})}), or leave the option out"
            )
        raise DataError(message)
    table = Table(
        row=rows,
        indication=indication,
        reference=None if reference is None else some(reference, rows),
        conditions=conditions,
        extra={name: some(column, rows) for name, column in observations.extra.items()},
        thermometers={name: some(column, rows) for name, column in observations.thermometers.items()},
        groups=groups.astype(np.int64),
        starts=np.zeros(len(rows), dtype=bool),
        steps=rows[:0],
        left_out=left_out,
        total=len(observations),
        echoes=observations.reading is None or "echo_time" in observations.source_names,
        labels={name: codes[rows] for name, codes in observations.labels.items() if name != "order"},
        stated_speed="" if observations.reading_speed == base.reading_speed else observations.reading_speed,
        placements=groups.astype(np.int64) if reference is None else None,
        rounding=step / 12**0.5,
    )
    table = divided(table, rows[steps], settings.gap)
    period = 0.5 * PERIOD * base.indication(np.full(len(rows), 2.0), conditions)
    return joined(table, period, settings)
