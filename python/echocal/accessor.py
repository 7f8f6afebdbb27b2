"""What ``df.echocal`` and ``ds.echocal`` offer: the functions of this package, of a table."""

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any

from echocal.budget import budget
from echocal.calibrate import calibrate
from echocal.correct import correct
from echocal.diagnose import diagnose, diagnose_many
from echocal.observations import read_observations
from echocal.verify import verify

__all__ = ["Accessor"]


def _method(function: Callable[..., Any], place: int = 0) -> Callable[..., Any]:
    """A function as a method; the table is its argument at this place."""

    @wraps(function)
    def method(self: "Accessor", *arguments: Any, **keywords: Any) -> Any:
        return function(*arguments[:place], self._table, *arguments[place:], **keywords)

    own = [*signature(function).parameters.values()]
    own.insert(0, own.pop(place))  # as `self`, which a bound method leaves out
    method.__signature__ = Signature([one.replace(default=Parameter.empty) for one in own[:1]] + own[1:])  # type: ignore[attr-defined]
    return method


class Accessor:
    """The functions of echocal that take a table, as methods: ``df.echocal.correct(model)``.

    ``df.echocal.NAME(...)`` is ``echocal.NAME(df, ...)``, with the same arguments and the same result;
    ``df.echocal.budget(model, ...)`` is ``echocal.budget(model, df, ...)``.

    Examples
    --------
    >>> import pandas as pd
    >>> import echocal
    >>> echoes = pd.DataFrame({"echo_us": [11680.0, 5860.0], "temperature_C": [20.0, 20.0]})
    >>> echoes.echocal.correct(echocal.Model("linear")).table["corrected_distance_m"].round(6).tolist()
    [2.005456, 1.006162]
    """

    def __init__(self, table: Any) -> None:
        self._table = table

    budget = _method(budget, 1)
    calibrate = _method(calibrate)
    correct = _method(correct)
    diagnose = _method(diagnose)
    diagnose_many = _method(diagnose_many)
    read_observations = _method(read_observations)
    verify = _method(verify)
