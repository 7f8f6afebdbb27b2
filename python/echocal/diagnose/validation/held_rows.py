"""The rows that the user holds out, prepared without the others."""

from collections import Counter
from dataclasses import replace

from echocal.diagnose.faults import find_faults
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.prepare import prepare
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings
from echocal.observations import Observations

__all__ = ["held_rows"]


def held_rows(
    observations: Observations, base: Base, distance: float | None, constant: bool, settings: Settings
) -> Table:
    """Search the held-out rows for faults of their own, and prepare them.

    Parameters
    ----------
    observations : Observations
        Without a value of any other row; see `echocal.diagnose.preprocess.hold_out.split`.
    base : Base
    distance : float or None
        Reference distance of every row [m].
    constant : bool
        Whether the distance is only known to be constant.
    settings : Settings

    Returns
    -------
    Table
        Its count of unusable rows has only those that were usable before this.
    """
    faults = find_faults(observations, base, distance, constant, settings.faults, settings.noises)
    table = prepare(faults.observations, base, distance, constant, settings.rows)
    return replace(table, unusable=Counter(table.unusable) - Counter(observations.unusable_counts))
