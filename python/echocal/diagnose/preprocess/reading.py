"""Reading a table, including one that is refused for its values: a fault may explain them."""

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
    """A table as read.

    Attributes
    ----------
    observations : Observations
    refusal : DataError or None
        Error for the user, unless a fault of a whole column explains it.
    """

    observations: Observations
    refusal: DataError | None = None


def read(source: Any, how: Mapping[str, Any]) -> Reading:
    """Read a table; if it is refused for its values, read it without checks and keep the error.

    A column in a wrong unit, for example, is a fault that the diagnosis may name.

    Parameters
    ----------
    source : Observations, path, DataFrame or mapping
    how : mapping of str to object
        Arguments of `echocal.read_observations`.
    """
    if isinstance(source, Observations):
        late = next((name for name, value in how.items() if value), None)
        if late:
            message = f"{late} is an argument for reading a table; pass it to read_observations instead"
            raise UsageError(message)
        return Reading(source)
    try:
        return Reading(read_observations(source, **how))
    except DataError as refusal:
        try:
            with warnings.catch_warnings(action="ignore"):  # the error has this information
                trust = how.get("trust", ())
                named = (trust,) if isinstance(trust, str) else trust
                everything = {**how, "trust": (*named, EVERYTHING)}
                return Reading(read_observations(source, **everything), refusal)
        except EchocalError:
            raise refusal from None
