"""Reading a table, also one that is refused for its values: a fault may explain them."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from echocal.errors import DataError, EchocalError, UsageError
from echocal.observations import Observations, read_observations
from echocal.observations.plan import EVERYTHING

__all__ = ["Reading", "read"]


@dataclass(frozen=True)
class Reading:
    """A table as it was read.

    Attributes
    ----------
    observations : Observations
    refusal : DataError or None
        Why the table is refused, unless a fault of a whole column explains it.
    """

    observations: Observations
    refusal: DataError | None = None


def read(source: Any, how: Mapping[str, Any]) -> Reading:
    """Read a table; one that is refused for its values is read as it is, with the refusal.

    A column in another unit is a cause like others: where a fault explains it, it is named.

    Parameters
    ----------
    source : Observations, path, DataFrame or mapping
    how : mapping of str to object
        Arguments of `echocal.read_observations`.
    """
    if isinstance(source, Observations):
        late = next((name for name, value in how.items() if value), None)
        if late:
            message = (
                f"{late} concerns the reading of a table; pass it to read_observations, which made these"
            )
            raise UsageError(message)
        return Reading(source)
    try:
        return Reading(read_observations(source, **how))
    except DataError as refusal:
        try:
            with warnings.catch_warnings(action="ignore"):  # the refusal says it all
                return Reading(read_observations(source, **{**how, "trust": (EVERYTHING,)}), refusal)
        except EchocalError:
            raise refusal from None
