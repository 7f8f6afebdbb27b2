"""Columns of the tables, row by row: what recomputes them, their errors, correlations and regressions."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate import Calibration, Regression, calibrate
from echocal.study.origin import REFERENCE_LAW, STATED_LAW, error, reading, reading_in, speed, time
from echocal.study.tables import DISTANCE, READING_SPEED, Printed, Table, Tables, observations, reach
from echocal.study.verdict import Cell, Claim, Finding, Verdict, check

COLUMNS = {
    "calculation": "measured_distance_calculation_m",
    "tinkercad": "measured_distance_tinkercad_m",
}

Array = NDArray[np.float64]
INDOORS = 0.5  # relative humidity of the physical value beside each cell


def cells(
    table: Table, printed: Sequence[Printed], low: Array, high: Array, physical: Array | None = None
) -> tuple[Cell, ...]:
    """Compare a column with the range that its inputs' rounding allows, row by row."""
    return tuple(
        Cell(
            row=row + 1,
            temperature=float(table.temperature[row]),
            printed=number.text,
            recomputed=float(0.5 * (low[row] + high[row])),
            verdict=Verdict.REPRODUCED
            if number.meets(*sorted((low[row], high[row])))
            else Verdict.NOT_REPRODUCED,
            physical=None if physical is None else float(physical[row]),
        )
        for row, number in enumerate(printed)
    )


def score(found: tuple[Cell, ...]) -> tuple[int, str]:
    """Count the cells that agree, and name the others by temperature."""
    wrong = [f"{cell.temperature:g}" for cell in found if cell.verdict is not Verdict.REPRODUCED]
    names = ", ".join(wrong) if len(wrong) <= 6 else f"{', '.join(wrong[:5])} and {len(wrong) - 5} more"
    return len(found) - len(wrong), f"; not at {names} °C" if wrong else ""


def speeds_as_printed(table: Table) -> tuple[Array, Array]:
    """Slowest and fastest speed [m/s] that rounds to each printed one."""
    center, half = table.values("actual_speed_m_s"), table.half("actual_speed_m_s")
    return center - half, center + half


@check
def speeds(tables: Tables, claim: Claim) -> Finding:
    """Table 1's speeds against the study's own equation."""
    table = tables.table1
    stated = speed(STATED_LAW, table.temperature)
    real = speed(REFERENCE_LAW, table.temperature, relative_humidity=INDOORS)
    found = cells(table, table.columns["actual_speed_m_s"], stated, stated, real)
    good, _ = score(found)
    away = table.values("actual_speed_m_s") - stated
    because = (
        f"{good} of {len(table)} speeds agree with 331.4 + 0.6 T; "
        f"the printed ones differ from it by {away.min():+.3f} to {away.max():+.3f} m/s"
    )
    physical = f"{real[0]:.1f} to {real[-1]:.1f} m/s at 50 % RH"
    numbers = {"away_low": away.min(), "away_high": away.max()}
    return claim.found(
        good == len(table), f"{good}/{len(table)}", because, physical=physical, cells=found, numbers=numbers
    )


@check
def times(tables: Tables, claim: Claim) -> Finding:
    """Table 1's echo times against its speeds."""
    table = tables.table1
    slow, fast = speeds_as_printed(table)
    found = cells(table, table.columns["time_s"], time(fast), time(slow))
    good, wrong = score(found)
    resolution = float(reading(2.0 * table.half("time_s")[0]))
    because = (
        f"{good} of {len(table)} are the time for 4 m at the printed speed{wrong}; a step of 1 ms is "
        f"{resolution * 1e3:.0f} mm, so the printed distances cannot be computed from this column"
    )
    return claim.found(good == len(table), f"{good}/{len(table)}", because, cells=found)


@check
def distances(tables: Tables, claim: Claim) -> Finding:
    """Table 1's measured distances against its speeds."""
    table = tables.table1
    slow, fast = speeds_as_printed(table)
    real = reading_in(REFERENCE_LAW, table.temperature, relative_humidity=INDOORS)
    found = cells(table, table.columns["measured_distance_m"], reading(time(fast)), reading(time(slow)), real)
    good, wrong = score(found)
    because = f"{good} of {len(table)} are 343 m/s times half the echo time at the printed speed{wrong}"
    physical = f"{real[0]:.3f} to {real[-1]:.3f} m at 50 % RH"
    return claim.found(good == len(table), f"{good}/{len(table)}", because, physical=physical, cells=found)


@check
def errors(tables: Tables, claim: Claim) -> Finding:
    """Size of Table 1's errors against its speeds; the sign is a claim of its own."""
    table = tables.table1
    slow, fast = speeds_as_printed(table)
    sizes = np.abs(error(reading(time(np.stack([slow, fast])))))
    found = cells(table, table.columns["error_percent"], sizes.min(axis=0), sizes.max(axis=0))
    good, wrong = score(found)
    because = f"{good} of {len(table)} sizes follow from the printed speeds{wrong}"
    return claim.found(good == len(table), f"{good}/{len(table)}", because, cells=found)


@check
def error_signs(tables: Tables, claim: Claim) -> Finding:
    """Signs of Table 1's errors, by the study's own definition of the error."""
    table = tables.table1
    signed = error(table.values("measured_distance_m"))
    kept = np.sign(signed) == np.sign(table.values("error_percent"))
    marks = [Verdict.REPRODUCED if keeps else Verdict.NOT_REPRODUCED for keeps in kept]
    found = tuple(
        Cell(row + 1, float(table.temperature[row]), number.text, float(signed[row]), marks[row])
        for row, number in enumerate(table.columns["error_percent"])
    )
    dropped = table.temperature[~kept]
    because = f"the sign is dropped in {len(dropped)} of {len(table)} rows"
    because += (
        f", all of them from {dropped.min():g} °C up, where the readings are too short"
        if len(dropped)
        else ""
    )
    return claim.found(bool(kept.all()), f"{int(kept.sum())}/{len(table)}", because, cells=found)


@check
def calculation_column(tables: Tables, claim: Claim) -> Finding:
    """Table 2's calculated distances against the study's own equation."""
    table = tables.table2
    stated = reading_in(STATED_LAW, table.temperature)
    real = reading_in(REFERENCE_LAW, table.temperature, relative_humidity=INDOORS)
    printed = table.columns["measured_distance_calculation_m"]
    found = cells(table, printed, stated, stated, real)
    good, _ = score(found)
    away = (table.values("measured_distance_calculation_m") - stated) * 1e3
    because = (
        f"{good} of {len(table)} follow from 331.4 + 0.6 T; {int((away > 0.0).sum())} are above it, "
        f"by {away.mean():.2f} mm on average; rounding would deviate in both directions"
    )
    if good == len(table):
        because = f"all {len(table)} follow from 331.4 + 0.6 T"
    return claim.found(good == len(table), f"{good}/{len(table)}", because, cells=found)


@check
def tables_agree(tables: Tables, claim: Claim) -> Finding:
    """Table 1's measured distances against Table 2's, at the temperatures of both."""
    first, second = tables.table1, tables.table2
    shared, rows1, rows2 = np.intersect1d(first.temperature, second.temperature, return_indices=True)
    one = [first.columns["measured_distance_m"][row] for row in rows1]
    two = [second.columns["measured_distance_calculation_m"][row] for row in rows2]
    differ = [
        f"{t:g} °C ({a.text} and {b.text})"
        for t, a, b in zip(shared, one, two, strict=True)
        if a.value != b.value
    ]
    because = (
        f"{len(differ)} of {len(shared)} rows differ: {'; '.join(differ)}" if differ else "every row agrees"
    )
    return claim.found(not differ, f"{len(shared) - len(differ)}/{len(shared)}", because)


@check
def increment(tables: Tables, claim: Claim) -> Finding:
    """Steps of the temperature columns."""
    steps = {name: np.diff(table.temperature) for name, table in (("1", tables.table1), ("2", tables.table2))}
    holds = all(np.all(step == claim.number.value) for step in steps.values())
    told = [
        f"Table {name} steps by {', '.join(f'{value:g}' for value in sorted(set(step)))} °C"
        for name, step in steps.items()
    ]
    most = float(np.median(np.concatenate(list(steps.values()))))
    because = "; ".join(told)
    extra = sorted(set(tables.table2.temperature) - set(tables.table1.temperature))
    if extra:
        because += f": Table 2 has one more row, {', '.join(f'{value:g}' for value in extra)} °C"
    return claim.found(holds, f"{most:g}", because)


STATISTICS: dict[str, Callable[[Array, Array], float]] = {
    "rmse": lambda x, y: float(np.sqrt(np.mean((x - y) ** 2)) * 1e3),
    "mae": lambda x, y: float(np.mean(np.abs(x - y)) * 1e3),
    "pearson": lambda x, y: float(np.corrcoef(x, y)[0, 1]),
}


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
