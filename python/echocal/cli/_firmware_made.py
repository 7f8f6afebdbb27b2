"""What ``echocal firmware`` makes of its options, and what it says of that."""

from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from echocal.device_uncertainty import rounded_up
from echocal.errors import UsageError
from echocal.firmware import Firmware, generate
from echocal.lagging import LagFirmware, generate_lagging
from echocal.model import Model
from echocal.per_unit import UnitFirmware, generate_per_unit


def made_by(
    model: Model,
    target: str,
    per_unit: list[str] | None,
    lag: tuple[float | None, float | None],
    request: dict[str, Any],
) -> Firmware:
    """Generate what the options ask for: a function alone, for units, or for a thermometer that lags."""
    interval, smoothing = lag
    if interval is None and smoothing is not None:
        raise UsageError(
            "--lag-smoothing-s needs --lag-interval-s, the time between two temperature codes [s]"
        )
    if per_unit and interval is not None:
        raise UsageError(
            "a state of the thermometer and --per-unit are not proven together: leave out one of both"
        )
    if interval is not None:
        return generate_lagging(model, interval, target, lag_smoothing=smoothing, **request)
    if per_unit:
        return generate_per_unit(model, per_unit, target, **request)
    return generate(model, target, **request)


def _cost(found: dict[str, Any]) -> str:
    """Return what one core needs, in a line."""
    unit = "instructions" if found["cycles"] is None else "cycles"
    most, fewest = found[unit], found[f"fewest_{unit}"]
    steps = f"{most}" if most == fewest else f"{fewest} to {most}"
    memory = f"{found['flash_bytes']} bytes of flash, {found['stack_bytes']} of stack"
    return f"{found['core']}: {memory}, {steps} {unit} ({found['compiler']} {found['options']})"


def _add_units(table: Table, made: UnitFirmware) -> None:
    found = made.report["per_unit"]
    proven, asked = rounded_up(found["error_proven_m"] * 1e3), found["error_bound_m"] * 1e3
    far = found["maximum_distance_m"]
    table.add_row(
        "every unit", f"[bold green]{proven:.4f} mm[/] at most, up to {far:g} m (requested {asked:g} mm)"
    )
    for side in made.box.sides:
        if side.free:
            table.add_row("", escape(side.words()))


def _add_lag(table: Table, made: LagFirmware) -> None:
    found = made.report["temperature_lag"]
    error, far = rounded_up(found["error_m"] * 1e3, 3), made.report["maximum_distance_m"]
    table.add_row(
        "lag",
        f"{found['time_constant_s']:g} s of the thermometer, {found['smoothing_s']:g} s left; "
        f"the state adds up to {rounded_up(found['error_proven_K']):g} K, {error:g} mm at {far:g} m",
    )


def summary(made: Firmware, files: list[Path], notes: list[str]) -> Table:
    """Return the table of what was made, proven and written."""
    report = made.report
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim")
    table.add_column()
    proven, asked = rounded_up(report["error_proven_m"] * 1e3), report["error_bound_m"] * 1e3
    always, sometimes = report["reach_m"]["always"], report["reach_m"]["sometimes"]
    reach, worst = min(report["maximum_distance_m"], rounded_up(sometimes[1], 3)), report["worst_input"]
    table.add_row("form", f"{report['form']['description']}; {report['table_bytes']} bytes of tables")
    table.add_row(
        "proven", f"[bold green]{proven:.4f} mm[/] at most, up to {reach:g} m (requested {asked:g} mm)"
    )
    others = report["device"]["conditions"][1:]
    where = "".join(
        f", {axis['quantity'].replace('_', ' ')} {worst[axis['quantity']]:g}"
        + ("" if axis["unit"] == "1" else f" {axis['unit']}")
        for axis in others
    )
    axis = report["device"]["echo"]
    echo = worst[axis["name"]] * axis["lsb"] * 1e6
    table.add_row("worst at", f"echo {echo:g} us, {worst['temperature']:g} degC{where}")
    table.add_row("checked", f"all {report['inputs_checked']:,} inputs, bit for bit")
    table.add_row("", "no overflow; the distance never decreases when the echo time increases")
    table.add_row(
        "reach", f"{rounded_up(always[0], 3):g} to {-rounded_up(-always[1], 3):g} m in all conditions"
    )
    for distance, size in report["expanded_uncertainty"]["expanded"]:
        table.add_row(
            "95 %", f"+-{rounded_up(size * 1e3, 2):g} mm at {distance:g} m; the header says of what"
        )
    if isinstance(made, UnitFirmware):
        _add_units(table, made)
    if isinstance(made, LagFirmware):
        _add_lag(table, made)
    filter_ = report["provenance"].get("filter")
    if filter_:
        window, gate = filter_["window"], filter_["gate"]
        agree = f"; {window // 2 + 1} of them within {gate} {made.unit}" if gate else ""
        table.add_row("filter", f"median of the last {window} distances{agree}")
    for found in report["measured"]:
        table.add_row("measured", _cost(found))
    for line in report["assumptions"]:
        table.add_row("assumed", escape(line))
    for note in notes:
        table.add_row("[yellow]note[/]", escape(note))
    for path in files:
        table.add_row("written", f"[cyan]{escape(str(path))}[/]")
    return table
