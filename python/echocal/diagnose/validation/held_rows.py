"""The rows that the user holds out, prepared without the others."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from echocal.diagnose.faults import find_faults
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.hold_out import NOT_HELD_OUT, split
from echocal.diagnose.preprocess.prepare import prepare
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings
from echocal.errors import DataError
from echocal.observations import Observations

__all__ = ["held_rows"]


def held_rows(
    observations: Observations,
    after: str | float,
    base: Base,
    distance: float | None,
    constant: bool,
    settings: Settings,
    columns: Collection[str],
) -> Table:
    """Repair and prepare the held-out rows.

    A fault may begin in the rows before. So the repair of the held-out rows, and it alone, comes from a
    search in all rows. Columns are repaired only for faults that the rows before show by themselves: of any
    other one nobody would know, and a model is judged by the rows as they are.

    Parameters
    ----------
    observations : Observations
        All rows.
    after : str or float
        Time from which on rows are held out.
    base : Base
    distance : float or None
        Reference distance of every row [m].
    constant : bool
        Whether the distance is only known to be constant.
    settings : Settings

    columns : collection of str
        Faults of whole columns that were found without the held-out rows.

    Returns
    -------
    Table
        The rows that it leaves out are only those that were usable before this.

    Raises
    ------
    DataError
        If too few of them are usable.
    """
    faults = find_faults(observations, base, distance, constant, settings, columns)
    _, later = split(faults.observations, after, settings.rows.fewest)
    assert later is not None
    try:
        table = prepare(later, base, distance, constant, settings.rows)
    except DataError as error:
        message = f"the rows held out from {after} on cannot judge a model: {error}"
        raise DataError(message) from None
    seen = np.flatnonzero(later.unusable == NOT_HELD_OUT)
    known = np.union1d(seen, np.flatnonzero(~observations.usable))
    left_out = {reason: np.setdiff1d(rows, known) for reason, rows in table.left_out.items()}
    return replace(table, left_out={reason: rows for reason, rows in left_out.items() if len(rows)})
