"""A digital thermometer that answers before it has measured."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.faults.common.values import POWER_ON, at_power_on
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule

__all__ = ["FAULT"]


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    apart: float = threshold(
        15.0, "K", "from the median of the other rows, for 85 degC to be no air temperature; judgement"
    )
    each: float = threshold(12.0, "1", "log Bayes factor of a row that has exactly this value; judgement")


FACTS = CauseFacts(
    id="reset_temperature",
    kind="row",
    sentence="The thermometer was read before it had measured: it gives its value at power-on, 85 degC.",
    signature="exactly 85 degC (185 degF) in single rows, far from all others",
    source="DS18B20 data sheet (Maxim 19-7487), table 1: the power-on reset value is +85 degC",
    parameters=(Quantity("rows", "1", "rows"),),
    check="wait 750 ms after the conversion command, and look at the supply of the thermometer",
    prior=0.01,
    formula="T' = 85 degC, in single rows",
    needs=("temperature",),
    repair="leaves the rows out",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Look for rows with exactly the value at power-on, far from what the others have."""
    recorded = view.observations.conditions["temperature"]
    rows = at_power_on(recorded) & np.isfinite(view.observations.echo_time)
    others = np.isfinite(recorded) & ~rows
    if not rows.any() or not others.any():
        return None
    usual = float(np.median(recorded[others]))
    if np.abs(recorded[rows] - usual).min() < own.apart:
        return None
    because = (
        f"{listed(rows)}: exactly {recorded[rows][0]:g} degC, the value of a DS18B20 at power-on, "
        f"where the other rows have a median of {usual:.1f} degC; left out"
    )
    rules = tuple(
        RowRule(reason=FACTS.id, kind="equals", quantity="temperature", value=value) for value in POWER_ON
    )
    left = view.after(view.without(rows, FACTS.id))
    repaired = with_values(left, rows, FACTS.id, temperature=np.full(len(view), np.nan))
    return Found(rows, own.each * float(rows.sum()), because, (rows.sum(),), repaired, rules)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Answer with the value at power-on in some rows."""
    table["temperature_C"][random.choice(len(table["temperature_C"]), 4, replace=False)] = POWER_ON[0]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
