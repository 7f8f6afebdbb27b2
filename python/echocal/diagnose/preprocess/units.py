"""Units: the rows of one visit to a placement are no independent measurements, and count as one."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.row_mixture import row_mixture
from echocal.diagnose.preprocess.segments import divided
from echocal.diagnose.preprocess.table import Members, Table
from echocal.diagnose.settings.rows import RowSettings
from echocal.quantities import AIR, QUANTITIES

__all__ = ["joined", "visits"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


def joined(table: Table, period: Column, settings: RowSettings) -> Table:
    """Join the rows of each visit where the air hardly changes in it.

    docs/method/rows-and-candidates.md, Eq. 1a.

    What the rows of a visit share (the tape, the tilt of the target, the air on the way) does not average
    out over them. So they tell no more about a cause than their mean does, unless the temperature changes
    during the visit by more than a row scatters, or unless it or another recorded quantity, as an angle or a
    supply voltage, varies more inside of visits than between them. The noise of the thermometer is no change.

    Parameters
    ----------
    table : Table
        Of rows.
    period : ndarray, shape (n,)
        Length of one period of the carrier at each row [m].
    settings : RowSettings

    Returns
    -------
    Table
        The same table where its rows are units.
    """
    if table.reference is None or "position_in_group" in table.conditions:
        return table
    visit = visits(table)
    count = np.bincount(visit)
    if 2 * len(count) > len(table) or len(count) < settings.fewest:
        return table  # few rows follow one of the same distance, and those by chance
    mixture = row_mixture(table.indication, visit, period, table.rounding)

    def mean(column: Column) -> Column:
        return np.asarray(np.bincount(visit, column) / count)

    temperature = table.conditions.get("temperature")
    if temperature is not None:
        off, steps = temperature - mean(temperature)[visit], np.diff(temperature)[np.diff(visit) == 0]
        warming = table.reference**2 * (off**2 - 0.5 * np.mean(steps**2))  # less the noise of the thermometer
        if settings.per_kelvin**2 * float(np.mean(warming)) > mixture.scatter**2:
            return table
    for name, column in table.conditions.items():
        asked = name == "temperature" or (name not in AIR and QUANTITIES[name].derived_from is None)
        if asked and float(np.mean((column - mean(column)[visit]) ** 2)) > 0.5 * float(np.var(column)):
            return table
    first = np.unique(visit, return_index=True)[1]
    groups = np.unique(table.groups[first], return_inverse=True)[1].astype(np.int64)
    if 1 + groups.max() > len(first) // settings.rows_per_station:
        groups = np.zeros_like(groups)  # an error of the station is then the same as that of a unit
    units = replace(
        table,
        row=table.row[first],
        indication=mixture.mean,
        reference=table.reference[first],
        conditions={name: mean(column) for name, column in table.conditions.items()},
        extra={name: mean(column) for name, column in table.extra.items()},
        thermometers={name: mean(column) for name, column in table.thermometers.items()},
        labels={name: codes[first] for name, codes in table.labels.items()},
        groups=groups,
        members=Members(table, visit),
    )
    every = np.ones(len(first), dtype=bool)  # the target is put up anew: no error goes on from visit to visit
    return replace(divided(units, units.row[:0], settings.gap), starts=every)


def visits(table: Table) -> Labels:
    """Number the runs of rows in which the target stayed: a burst, or rows without a gap at one station."""
    new = table.starts.copy()
    if table.reference is not None:
        new[1:] |= np.diff(table.reference) != 0
    position = table.conditions.get("position_in_group")
    if position is not None:
        new[1:] |= np.diff(position) < 0
    new[:1] = False
    return np.cumsum(new, dtype=np.int64)
