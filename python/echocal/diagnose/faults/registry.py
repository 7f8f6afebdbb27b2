"""The registry of faults: one line each, in the order in which a table is searched."""

from importlib import import_module
from typing import Literal

from echocal.diagnose.faults.common.fault import Fault

__all__ = ["FAULTS", "of_kind"]


def _fault(id_: str) -> Fault:
    fault = import_module(f"echocal.diagnose.faults.{id_}").FAULT
    assert isinstance(fault, Fault)
    return fault


# A reading that froze was measured once, whatever else is wrong with its column. Then faults of whole columns
# come first. Of the others those that concern many rows come first: they would make outliers of the rest.
FAULTS: tuple[Fault, ...] = tuple(
    _fault(id_)
    for id_ in (
        "dead_column",
        "swapped_columns",
        "swapped_time_distance",
        "fahrenheit_celsius",
        "round_trip_factor",
        "unit_mixup",
        "device_factor",
        "stuck_reading",
        "obstruction",
        "shifted_rows",
        "blanking_distance",
        "computed_table",
        "censored_range",
        "reset_temperature",
        "mistyped_rows",
        "timeout",
        "installation_transient",
        "multipath",
        "crosstalk",
        "degrading_sensor",
    )
)


def of_kind(kind: Literal["gross", "row"]) -> tuple[Fault, ...]:
    """Faults of whole columns, or of single rows."""
    return tuple(fault for fault in FAULTS if fault.facts.kind == kind)
