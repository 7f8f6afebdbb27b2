"""The study's regressions, through `calibrate`."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate import Calibration, Regression, calibrate
from echocal.study.rounding import reach
from echocal.study.tables import READING_SPEED, Tables, observations
from echocal.study.verdict import Claim, Finding, check


def fit(temperature: NDArray[np.float64], reading: NDArray[np.float64], degree: int) -> Calibration:
    """Fit a polynomial in temperature to readings [m]."""
    form = Regression.polynomial("temperature", degree, law=READING_SPEED)
    return calibrate(observations(temperature, reading), form)


def _number(
    reading: NDArray[np.float64], *, temperature: NDArray[np.float64], degree: int, term: str
) -> float:
    found = fit(temperature, reading, degree)
    return found.r_squared if term == "r_squared" else found[term].value


@check
def regression(tables: Tables, claim: Claim, *, degree: int, term: str) -> Finding:
    """A coefficient or R² of the regression of reading on temperature."""
    table = tables.table2
    reading, half = (
        table.values("measured_distance_calculation_m"),
        table.half("measured_distance_calculation_m"),
    )
    number = partial(_number, temperature=table.temperature, degree=degree, term=term)
    value = number(reading)
    holds = claim.number.holds(value) or claim.number.meets(*reach(number, reading, half))
    first = tables.table1
    other = _number(
        first.values("measured_distance_m"), temperature=first.temperature, degree=degree, term=term
    )
    found = fit(table.temperature, reading, degree)
    spread = "" if term == "r_squared" else f" ± {found[term].standard_uncertainty:.1g}"
    because = (
        f"{value:.6g}{spread} from Table 2's calculated column ({len(table)} rows); "
        f"Table 1's {len(first)} rows give {other:.6g}"
    )
    return claim.found(holds, f"{value:.5g}", because, numbers={"value": value, "table1": other})
