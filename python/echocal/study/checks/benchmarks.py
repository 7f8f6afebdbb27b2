"""The study's benchmarks: errors at the extremes, where the error vanishes."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from echocal.study.sensor import REFERENCE_LAW, STATED_LAW, error, reading, reading_in, time
from echocal.study.tables import DISTANCE, Tables
from echocal.study.verdict import Claim, Finding, check


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
