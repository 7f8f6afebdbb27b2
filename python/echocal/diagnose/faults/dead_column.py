"""A sensor of an influence quantity that gave no value at all."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.faults.common.values import POWER_ON
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.checks import CODES
from echocal.quantities import QUANTITIES

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_FEWEST = 10  # rows without any value, for a sensor to be dead: fewer may be a choice


FACTS = CauseFacts(
    id="dead_column",
    kind="gross",
    sentence="A sensor beside the ranger was dead: its column has no value, or one error code in all rows.",
    signature="a column is empty, or in every row one code: -9999, -999, 0 (a thermometer: 0, -127, 85)",
    source="DallasTemperature.h: DEVICE_DISCONNECTED_C is -127; DS18B20 data sheet: 85 degC at power-on",
    parameters=(Quantity("columns", "1", "columns that are dead"),),
    check="look at the plug of the sensor; print its value beside the echo time",
    prior=0.01,
    formula="x' = a constant that is no value",
    repair="leaves the column out, and keeps the rows",
)


def detect(view: View, _: object, settings: FaultSettings) -> Found | None:
    """Look for columns of influence quantities that hold nothing else than one code, or nothing.

    Raises
    ------
    DataError
        If the thermometer was dead.
    """
    if len(view) < _FEWEST:
        return None
    observations = view.observations
    recorded = {n: c for n, c in observations.conditions.items() if _of_a_sensor(n)}
    logged = "elapsed_time" in observations.conditions
    dead = {name: what for name, column in recorded.items() if (what := _dead(name, column, logged))}
    if not dead:
        return None
    names = {name: observations.source_names.get(name, name) for name in dead}
    told = "; ".join(f"{names[name]} {what} in all {len(view)} rows" for name, what in dead.items())
    if "temperature" in dead:  # laws of the air need one
        message = (
            f"{told}: the sensor was dead. A diagnosis needs the temperature of the air: map another "
            f"thermometer ({keyword('columns', {'NAME': 'temperature_C'})}), or write what is known into the "
            "column"
        )
        raise DataError(message)
    because = f"{told}: the sensor was dead; left out"
    rows = np.ones(len(view), dtype=bool)
    repaired = with_values(view, rows, FACTS.id, **dict.fromkeys(dead))
    return Found(rows, float(len(view)), because, (len(dead),), repaired)


def _of_a_sensor(name: str) -> bool:
    """Whether a quantity is measured by a sensor of its own."""
    facts = QUANTITIES[name]
    return facts.derived_from is None and name != "elapsed_time" and bool(facts.forms)


def _dead(name: str, column: Column, logged: bool) -> str:
    """What a dead column holds; empty if it is not dead.

    A temperature of 0 degC may be assumed, in a table without times.
    """
    known = column[np.isfinite(column)]
    if not len(known):
        return "has no value"
    value = float(known[0])
    if np.ptp(known) > 1e-9 * max(abs(value), 1.0):
        return ""
    if name == "temperature" and value == 0.0 and not logged:
        return ""
    absent = (*QUANTITIES[name].dead, *(POWER_ON if name == "temperature" else ()))
    code = any(np.isclose(value, one, rtol=1e-6, atol=1e-9) for one in absent)
    as_recorded = [unit.from_si(value) for form in QUANTITIES[name].forms for unit in form.units.values()]
    shown = next((code for code in CODES for own in as_recorded if np.isclose(own, code, rtol=1e-9)), None)
    if shown is None and code:
        shown = as_recorded[0]
    return "" if shown is None else f"is {shown:g}"


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Give what an absent hygrometer gives, in all rows."""
    table["humidity_percent"][:] = random.choice([0.0, -999.0])


FAULT = Fault(FACTS, detect, spoil)
