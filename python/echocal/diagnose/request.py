"""The request of a user."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from echocal.diagnose.experiment_design.ranges import Ranges, checked_ranges
from echocal.diagnose.matters import checked_mm
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.reference import refuse_distance
from echocal.diagnose.settings import Settings
from echocal.errors import UsageError
from echocal.model import Model

__all__ = ["Request"]


@dataclass(frozen=True, kw_only=True)
class Request:
    """What a user requests, checked as far as this is possible without the table.

    Attributes
    ----------
    base : Base
        The base simulation.
    reference_distance : float or None
        Of every row [m].
    constant_distance : bool
        Whether the distance is only known to be constant.
    since, until : str or None
        Ends of the period, ISO 8601.
    hold_out_after : str, float or None
        Rows from this time on are held out.
    can_vary : mapping of str to (float, float), or None
        What can be varied for the next measurements.
    matters_mm : float or None
        The difference of a reading from which on it matters [mm].
    seed : int
        Seed of the resampling for the interval of the gain.
    settings : Settings
        Every number that decides a verdict.
    """

    base: Base
    seed: int
    settings: Settings
    reference_distance: float | None = None
    constant_distance: bool = False
    since: str | None = None
    until: str | None = None
    hold_out_after: str | float | None = None
    can_vary: Mapping[str, Sequence[float]] | None = None
    matters_mm: float | None = None

    @classmethod
    def of(
        cls,
        base: str | float | Model,
        seed: int,
        settings: Settings | Mapping[str, Mapping[str, Any]] | None,
        **others: Any,
    ) -> "Request":
        """Read the arguments of a user.

        Raises
        ------
        UsageError
            If an argument contradicts another one or physics.
        """
        simulated = Base.of(base)
        refuse_distance(others.get("reference_distance"))
        checked_mm(others.get("matters_mm"))
        if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
            message = f"seed is {seed!r}; give an integer of 0 or more"
            raise UsageError(message)
        return cls(base=simulated, seed=int(seed), settings=Settings.of(settings), **others)

    def ranges(self, recorded: Sequence[str]) -> Ranges | None:
        """Ranges that can be varied, checked against the conditions that the table records."""
        return None if self.can_vary is None else checked_ranges(self.can_vary, recorded)
