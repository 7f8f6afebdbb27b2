"""What is compared with other work, with data sheets and with Tinkercad."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from echocal.model import Model
from echocal.study.origin import (
    REFERENCE_LAW,
    STATED_LAW,
    error,
    explain,
    reading,
    reading_in,
    table_law,
    time,
)
from echocal.study.tables import DISTANCE, Tables
from echocal.study.verdict import Cell, Claim, Finding, Verdict, check


def crossing(law: str, reads: float, **air: float) -> float:
    """Temperature [degC] at which the sensor reads a given distance [m] at its 2 m."""
    found: float = brentq(lambda t: float(reading_in(law, t, **air)) - reads, -20.0, 60.0)
    return found


def _row(tables: Tables, temperature: float) -> int:
    return int(np.flatnonzero(tables.table1.temperature == temperature)[0])


@check
def error_at(tables: Tables, claim: Claim, *, temperature: float, millimeters: bool = False) -> Finding:
    """Error at one temperature, from the distance that Table 1 prints there."""
    table, row = tables.table1, _row(tables, temperature)
    printed = table.columns["measured_distance_m"][row]
    scale = DISTANCE * 10.0 if millimeters else 1.0  # % of 2 m is 20 mm
    low, value, high = (error(np.array([printed.low, printed.value, printed.high])) * scale).tolist()
    own = table.columns["error_percent"][row].text
    from_speed = float(error(reading(time(table.values("actual_speed_m_s")[row])))) * scale
    real = float(error(reading_in(REFERENCE_LAW, temperature, relative_humidity=0.5))) * scale
    number, unit = claim.number, claim.unit
    digits = 0 if millimeters else 2
    because = (
        f"the printed {printed.text} m is {value:+.{digits}f} {unit} "
        f"({low:+.3f} to {high:+.3f} within its rounding), "
        f"the printed speed gives {from_speed:+.{digits}f} {unit}"
        + ("" if millimeters else f", and the same row of Table 1 prints {own} %")
    )
    physical = f"{real:+.{digits}f} {unit} at 50 % RH"
    return claim.found(number.meets(low, high), f"{value:+.{digits}f}", because, physical=physical)


@check
def near_zero(tables: Tables, claim: Claim, *, temperatures: Sequence[float], low: str, high: str) -> Finding:
    """Readings near the crossing against the range that the study prints."""
    table = tables.table2
    rows = [int(np.flatnonzero(table.temperature == t)[0]) for t in temperatures]
    texts = [table.columns["measured_distance_calculation_m"][row] for row in rows]
    holds = all(float(low) <= text.value <= float(high) for text in texts)
    real = reading_in(REFERENCE_LAW, np.array(temperatures), relative_humidity=0.5)
    told = " and ".join(f"{text.text} m at {t:g} °C" for text, t in zip(texts, temperatures, strict=True))
    physical = " and ".join(f"{value:.3f}" for value in real) + " m at 50 % RH"
    return claim.found(
        holds, "–".join(sorted(text.text for text in texts)), f"Table 2 has {told}", physical=physical
    )


@check
def smallest_error(tables: Tables, claim: Claim, *, low: float, high: float) -> Finding:
    """Temperature at which 343 m/s is right."""
    stated = crossing(STATED_LAW, DISTANCE)
    real = {
        humidity: crossing(REFERENCE_LAW, DISTANCE, relative_humidity=humidity)
        for humidity in (0.0, 0.5, 1.0)
    }
    because = (
        f"331.4 + 0.6 T is 343 m/s at {stated:.2f} °C; in true air this is at {real[0.0]:.2f} °C when dry, "
        f"{real[0.5]:.2f} at 50 % RH, {real[1.0]:.2f} at 100 % RH"
    )
    numbers = {"stated": stated, "dry": real[0.0], "half": real[0.5], "saturated": real[1.0]}
    return claim.found(
        low <= stated <= high,
        f"{stated:.2f}",
        because,
        physical=f"{real[0.5]:.1f} °C at 50 % RH",
        numbers=numbers,
    )


@check
def exceeds(tables: Tables, claim: Claim, *, at: Sequence[float]) -> Finding:
    """Whether the error exceeds the threshold at every one of these temperatures."""
    table = tables.table1
    sizes = {t: float(table.values("error_percent")[_row(tables, t)]) for t in at}
    holds = all(abs(size) > claim.number.value for size in sizes.values())
    real = {t: float(error(reading_in(REFERENCE_LAW, t, relative_humidity=0.5))) for t in at}
    because = "Table 1 has " + " and ".join(f"{size:.2f} % at {t:g} °C" for t, size in sizes.items())
    recomputed = " and ".join(f"{size:.2f}" for size in sizes.values())
    physical = " and ".join(f"{size:+.2f} %" for size in real.values()) + " at 50 % RH"
    return claim.found(holds, recomputed, because, physical=physical)


@check
def within_datasheet(tables: Tables, claim: Claim) -> Finding:
    """Temperatures between which the uncompensated sensor keeps the accuracy of its data sheet."""
    tolerance = claim.number.value * 1e-3
    stated = [crossing(STATED_LAW, DISTANCE + side) for side in (tolerance, -tolerance)]
    real = [
        crossing(REFERENCE_LAW, DISTANCE + side, relative_humidity=0.5) for side in (tolerance, -tolerance)
    ]
    table = tables.table1
    outside = int((abs(table.values("measured_distance_m") - DISTANCE) > tolerance).sum())
    because = (
        f"±{claim.printed} mm at 2 m holds from {stated[0]:.1f} to {stated[1]:.1f} °C by the study's "
        f"equation; "
        f"{outside} of {len(table)} rows of Table 1 are outside"
    )
    physical = f"{real[0]:.1f} to {real[1]:.1f} °C at 50 % RH"
    numbers = {"low": stated[0], "high": stated[1]}
    return claim.found(
        outside > 0, f"{stated[0]:.1f}–{stated[1]:.1f} °C", because, physical=physical, numbers=numbers
    )


@check
def thermometer(tables: Tables, claim: Claim, *, residual: float) -> Finding:
    """Whether a thermometer of this accuracy allows the residual that the study claims."""
    half = claim.number.value
    ends = tables.table1.temperature[[0, -1]]
    model = Model(STATED_LAW, {"temperature_offset": {"offset": half}})
    shift = abs(model.indicate(DISTANCE, temperature=ends) - DISTANCE)
    worst = float(shift.max())
    percent = worst / DISTANCE * 100.0
    because = (
        f"±{claim.printed} °C alone is ±{float(shift.min()) * 1e3:.2f} to ±{worst * 1e3:.2f} mm at 2 m, "
        f"up to {percent:.3f} %: more than the {residual:g} % that the compensation is said to leave"
    )
    if percent < residual:
        because = f"±{claim.printed} °C is at most {percent:.3f} %, less than {residual:g} %"
    numbers = {"millimeters": worst * 1e3, "percent": percent}
    return claim.found(percent < residual, f"±{worst * 1e3:.1f} mm", because, numbers=numbers)


@check
def replicates(tables: Tables, claim: Claim) -> Finding:
    """Rows in which Tinkercad and the calculation agree within the data sheet's accuracy."""
    table = tables.table2
    away = (
        table.values("measured_distance_tinkercad_m") - table.values("measured_distance_calculation_m")
    ) * 1e3
    rounding = (
        table.half("measured_distance_tinkercad_m") + table.half("measured_distance_calculation_m")
    ) * 1e3
    inside = np.abs(away) - rounding <= claim.number.value
    cells = tuple(
        Cell(
            row + 1,
            float(table.temperature[row]),
            printed.text,
            float(table.values("measured_distance_calculation_m")[row]),
            Verdict.REPRODUCED if inside[row] else Verdict.NOT_REPRODUCED,
        )
        for row, printed in enumerate(table.columns["measured_distance_tinkercad_m"])
    )
    because = (
        f"{int(inside.sum())} of {len(table)} rows agree within ±{claim.printed} mm; "
        f"every reading is too short, by {-away.max():.0f} to {-away.min():.0f} mm, {-away.mean():.1f} mm on "
        f"average"
    )
    if away.max() >= 0.0:
        because = f"{int(inside.sum())} of {len(table)} rows agree within ±{claim.printed} mm"
    numbers = {"mean": float(away.mean()), "scatter": float(away.std(ddof=1))}
    return claim.found(
        bool(inside.all()), f"{int(inside.sum())}/{len(table)}", because, cells=cells, numbers=numbers
    )


@check
def latency(tables: Tables, claim: Claim) -> Finding:
    """The delay that would explain Tinkercad's readings; a latency cannot be negative."""
    delay = explain(tables, ["fixed_delay.delay"])["fixed_delay.delay"]
    micro, sigma = delay.value * 1e6, delay.standard_uncertainty * 1e6
    because = (
        f"calibrated against {table_law(tables)}, the delay that explains the column is "
        f"{micro:.1f} ± {sigma:.1f} µs: "
    )
    if micro < -2.0 * sigma:
        because += "negative, while a latency lengthens the echo and can only make readings longer"
        verdict = Verdict.PHYSICALLY_WRONG
    else:
        because += "not negative, so a latency may explain it"
        verdict = Verdict.REPRODUCED
    return claim.found(
        verdict, f"{micro:.1f}", because, physical="≥ 0 µs", numbers={"delay_us": micro, "sigma_us": sigma}
    )
