"""Tables that a function takes as they are, and keywords that it does not have."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from difflib import get_close_matches
from typing import Any

from echocal.errors import UsageError
from echocal.model import Model
from echocal.observations.mount import is_level, mounted_as
from echocal.observations.options import ReadOptions
from echocal.observations.reading import read_observations
from echocal.observations.table import Observations

READ_OPTIONS = tuple(one.name for one in fields(ReadOptions) if one.init)
"""Keywords of `echocal.read_observations`."""


def observed(
    given: Any, caller: Callable[..., Any], how: Mapping[str, Any], speed: str, model: Model | None = None
) -> Observations:
    """Return the observations that a function was given, or read them from a table.

    Raises `TypeError` if the caller has no such keyword, and `UsageError` if keywords for reading are given
    with observations.

    Parameters
    ----------
    given : Observations, path, DataFrame of any library, or mapping of str to array_like
    caller : callable
        Function that was called, for the message.
    how : mapping of str to object
        Its further keywords: arguments of `echocal.read_observations`.
    speed : str
        Law or speed [m/s] that the device converts with, where they do not say; empty for the default.
    model : Model, optional
        Its height of the sensor is that of levels, where they do not say.
    """
    refuse_keywords(caller, how, READ_OPTIONS)
    if isinstance(given, Observations):
        if how:
            name = next(iter(how))
            raise UsageError(
                f"{name} is an argument for reading a table; pass it to read_observations instead"
            )
        return given
    default: dict[str, Any] = {"reading_speed": speed} if speed else {}
    if model is not None and how.get("columns"):
        how = {**how, **mounted_options(ReadOptions(**how), model)}
    return read_observations(given, **{**default, **how})


def mounted_options(options: ReadOptions, model: Model) -> dict[str, Any]:
    """`columns` and `mount_height`, with the height of the model's diagnosis where the user states none."""
    requests = mounted_as(options.requests, model)
    levels = any(is_level(name, own) for name, own in requests.items())
    return {"columns": requests, "mount_height": None if levels else options.mount_height}


def refuse_keywords(caller: Callable[..., Any], given: Iterable[str], also: Iterable[str] = ()) -> None:
    """Raise `TypeError` for a keyword that neither the called function nor `also` has.

    Examples
    --------
    >>> def weigh(*, mass, **more):
    ...     refuse_keywords(weigh, more, ["unit"])
    >>> weigh(mass=1.0, units="kg")
    Traceback (most recent call last):
    TypeError: weigh() got an unexpected keyword argument 'units'; did you mean 'unit'?
    """
    own = inspect.signature(caller).parameters.values()
    known = [*(p.name for p in own if p.kind is not p.VAR_KEYWORD), *also]
    for name in given:
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            raise TypeError(f"{caller.__name__}() got an unexpected keyword argument '{name}'{hint}")
