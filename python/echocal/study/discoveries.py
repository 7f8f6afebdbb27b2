"""What the tables show and the study does not say."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from echocal.errors import ModelError
from echocal.study.origin import (
    CAUSES,
    STATED_LAW,
    alternatives,
    explain,
    fit_table_law,
    reading_in,
    speed,
    table_law,
)
from echocal.study.tables import Table, Tables

Array = NDArray[np.float64]
LOWEST, HIGHEST = -20.0, 60.0  # degC, the domain of linear laws
BITS = (8, 9, 10, 11, 12)  # what microcontrollers' converters have, and their neighbors


@dataclass(frozen=True)
class Discovery:
    """Something that the numbers show."""

    id: str  # short name
    title: str  # the point, in few words
    text: str  # what shows it, with numbers
    numbers: Mapping[str, float] = field(default_factory=dict)  # unrounded


def discoveries(tables: Tables) -> list[Discovery]:
    """Everything that the tables show beside the claims, each with its numbers."""
    return [_law(tables), _thermometer(tables), _second_table(tables), _odd_row(tables), _change(tables)]


def converted(temperature: Array, bits: int, full_scale: float) -> Array:
    """Temperature [degC] as a converter of so many bits gives it, to two decimals.

    Zero at code 0, full scale at the largest code, the nearest code in between.
    """
    codes = 2**bits - 1
    return np.asarray(np.round(np.round(temperature / full_scale * codes) * full_scale / codes, 2))


def _plain(law: str) -> str:
    return law.replace("+", " + ").replace("*", " ")


def _law(tables: Tables) -> Discovery:
    found = fit_table_law(tables.table1)
    a, b = found["law.intercept"], found["law.slope"]
    text = (
        f"A robust fit through Table 1's speeds gives c = {a.value:.3f} + {b.value:.4f} T "
        f"(± {a.standard_uncertainty:.3f} m/s and ± {b.standard_uncertainty:.4f} m/s per °C); "
        f"the study states {_plain(STATED_LAW)}."
    )
    numbers = {"intercept": a.value, "slope": b.value, "intercept_u": a.standard_uncertainty}
    return Discovery("law", f"Table 1 was computed with {a.value:.1f} m/s at 0 °C", text, numbers)


def _matches(table: Table, law: str, temperature: Array) -> NDArray[np.bool_]:
    pairs = zip(table.columns["actual_speed_m_s"], speed(law, temperature).tolist(), strict=True)
    return np.array([printed.holds(value) for printed, value in pairs])


def _thermometer(tables: Tables) -> Discovery:
    table, law = tables.table1, table_law(tables)
    full_scale = float(table.temperature[-1])
    exact = int(_matches(table, law, table.temperature).sum())
    counts = {b: int(_matches(table, law, converted(table.temperature, b, full_scale)).sum()) for b in BITS}
    best = max(counts, key=lambda bits: counts[bits])
    tried = ", ".join(f"{count} with {bits} bits" for bits, count in counts.items())
    text = (
        f"{_plain(law)} gives {exact} of {len(table)} speeds to the last digit at the printed temperatures. "
        f"At temperatures that a converter over 0–{full_scale:g} °C would give, the numbers are: {tried}."
    )
    numbers = {"exact": exact, "best": counts[best], "bits": best}
    if counts[best] <= exact:
        return Discovery("thermometer", "Table 1's temperatures are as printed", text, numbers)
    text += _leftover(table, law, converted(table.temperature, best, full_scale))
    title = f"Table 1's temperatures seem to come from a {best}-bit converter"
    return Discovery("thermometer", title, text, numbers)


def _leftover(table: Table, law: str, temperature: Array) -> str:
    """Say what the rows that no converter explains would need."""
    told = ""
    for row in np.flatnonzero(~_matches(table, law, temperature)):
        value = table.values("actual_speed_m_s")[row]
        if not speed(law, LOWEST) <= value <= speed(law, HIGHEST):
            told += f" No temperature from {LOWEST:g} to {HIGHEST:g} °C gives {value:g} m/s."
            continue
        needed: float = brentq(lambda t, value=value: float(speed(law, t)) - value, LOWEST, HIGHEST)
        expected, used = f"{temperature[row]:.2f}", f"{needed:.2f}"
        told += (
            f" The row at {table.temperature[row]:g} °C needs {used} °C, and the converter gives {expected}"
        )
        told += ": the same digits with two of them exchanged." if used in _swaps(expected) else "."
    return told


def _swaps(text: str) -> set[str]:
    """Return what two neighboring characters swapped make of a text."""
    return {text[:i] + text[i + 1] + text[i] + text[i + 2 :] for i in range(len(text) - 1)} - {text}


def _second_table(tables: Tables) -> Discovery:
    table, law = tables.table2, table_law(tables)
    printed = table.columns["measured_distance_calculation_m"]
    counts = {}
    for name in (STATED_LAW, law):
        pairs = zip(printed, reading_in(name, table.temperature).tolist(), strict=True)
        counts[name] = sum(number.holds(value) for number, value in pairs)
    text = (
        f"At the temperatures as printed, Table 2's calculated distances follow {_plain(law)} in "
        f"{counts[law]} of "
        f"{len(table)} rows and the stated {_plain(STATED_LAW)} in {counts[STATED_LAW]}."
    )
    title = f"Table 2's calculation follows {_plain(law)}"
    numbers = {"stated": counts[STATED_LAW], "table_law": counts[law], "rows": len(table)}
    return Discovery("second_table", title, text, numbers)


def _odd_row(tables: Tables) -> Discovery:
    table = tables.table2
    fit = explain(tables, ["zero_error.offset"], loss="cauchy")
    scores = fit.residuals / fit.residual_standard_deviation
    row = int(np.abs(scores).argmax())
    at = float(table.temperature[row])
    printed = [number.text for number in table.columns["measured_distance_tinkercad_m"]]
    twins = [
        float(table.temperature[i]) for i, text in enumerate(printed) if text == printed[row] and i != row
    ]
    numbers = {"temperature": at, "score": float(scores[row])}
    text = (
        f"The fit of a constant offset leaves a residual of {fit.residuals[row] * 1e3:+.1f} mm for "
        f"Tinkercad's {printed[row]} m at {at:g} °C: {abs(scores[row]):.1f} robust standard deviations"
    )
    if twins:
        numbers["twin"] = twins[0]
        text += f". The row at {twins[0]:g} °C has the same number; perhaps one reading was entered twice"
    return Discovery("odd_row", f"The Tinkercad reading at {at:g} °C is an outlier", f"{text}.", numbers)


def _change(tables: Tables) -> Discovery:
    listed = alternatives(tables)
    low, high = listed[0].residual_standard_deviation, listed[-1].residual_standard_deviation
    text = (
        f"Each of {len(listed)} changes alone explains the Tinkercad column, with a residual of "
        f"{low * 1e3:.2f} to {high * 1e3:.2f} mm (see the alternatives). "
        f"A difference of {(high / low - 1.0) * 100.0:.0f} % is too small to choose one of them"
    )
    try:
        explain(tables, list(CAUSES)[:2])
    except ModelError as error:
        text += f". Two together cannot be fitted: {str(error).partition(';')[0]}"
    title = "A constant shift explains Tinkercad; only a second distance can show its cause"
    return Discovery("change", title, f"{text}.", {"low": low, "high": high})
