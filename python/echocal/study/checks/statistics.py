"""Root mean squares, mean absolute errors, correlations."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from echocal.study.rounding import reach
from echocal.study.tables import DISTANCE, Tables
from echocal.study.verdict import Claim, Finding, check

Array = NDArray[np.float64]
COLUMNS = {
    "calculation": "measured_distance_calculation_m",
    "tinkercad": "measured_distance_tinkercad_m",
}


def _rmse(x: Array, y: Array) -> float:
    return float(np.sqrt(np.mean((x - y) ** 2)) * 1e3)


def _mae(x: Array, y: Array) -> float:
    return float(np.mean(np.abs(x - y)) * 1e3)


def _pearson(x: Array, y: Array) -> float:
    return float(np.corrcoef(x, y)[0, 1])


STATISTICS: dict[str, Callable[[Array, Array], float]] = {"rmse": _rmse, "mae": _mae, "pearson": _pearson}


@check
def statistic(tables: Tables, claim: Claim, *, kind: str, of: str, against: str) -> Finding:
    """Recompute a statistic of Table 2's columns, over everything that rounds to their cells."""
    table = tables.table2
    function = STATISTICS[kind]
    x, half = table.values(COLUMNS[of]), table.half(COLUMNS[of])
    if against in COLUMNS:
        y, half = table.values(COLUMNS[against]), np.concatenate([half, table.half(COLUMNS[against])])
        value = function(x, y)
        n = len(x)
        low, high = reach(lambda both: function(both[:n], both[n:]), np.concatenate([x, y]), half)
    else:
        y = table.temperature if against == "temperature" else np.full(len(x), DISTANCE)
        value = function(x, y)
        low, high = reach(lambda cells: function(cells, y), x, half)
    digits = len(claim.printed.partition(".")[2])
    because = (
        f"{value:.{digits}f} over the {len(table)} rows of Table 2; "
        f"the rounding of its cells allows {low:.{digits}f} to {high:.{digits}f}"
    )
    numbers = {"value": value, "low": low, "high": high}
    if of == "calculation" and against not in COLUMNS:
        first = tables.table1
        other = first.temperature if against == "temperature" else np.full(len(first), DISTANCE)
        numbers["table1"] = function(first.values("measured_distance_m"), other)
        because += f"; Table 1's {len(first)} rows give {numbers['table1']:.{digits}f}"
    return claim.found(claim.number.meets(low, high), f"{value:.{digits}f}", because, numbers=numbers)
