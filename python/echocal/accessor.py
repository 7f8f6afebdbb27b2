"""What ``df.echocal`` and ``ds.echocal`` offer: the functions of this package, of a table."""

from collections.abc import Callable
from functools import wraps
from typing import Any

from echocal.calibrate import calibrate
from echocal.correct import correct
from echocal.diagnose import diagnose, diagnose_many
from echocal.observations import read_observations
from echocal.verify import verify

__all__ = ["Accessor"]


def _method(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function as a method whose first argument is the table."""

    @wraps(function)
    def method(self: "Accessor", *arguments: Any, **keywords: Any) -> Any:
        return function(self._table, *arguments, **keywords)

    return method


class Accessor:
    """The functions of echocal that take a table, as methods: ``df.echocal.correct(model)``.

    ``df.echocal.NAME(...)`` is ``echocal.NAME(df, ...)``, with the same arguments and the same result.

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

    calibrate = _method(calibrate)
    correct = _method(correct)
    diagnose = _method(diagnose)
    diagnose_many = _method(diagnose_many)
    read_observations = _method(read_observations)
    verify = _method(verify)
