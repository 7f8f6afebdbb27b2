"""``echocal firmware`` with parameters of single units: one block, or a folder of them."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.markup import escape

from echocal.cli._console import Console
from echocal.cli._options import refuse_others
from echocal.cli._outputs import Output, check_outputs, pass_on
from echocal.cli._progress import counted_bar
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.outputs import replacing
from echocal.per_unit import TABLE, Block, Box, block_of, number_of, write_units
from echocal.per_unit.block import BYTES
from echocal.per_unit.box import PARAMETERS

_USED = {"out", "model", "per_unit", "unit_data", "unit_number", "units", "force", "json", "quiet"}
_FEW = 3  # refusals that are told; the table has all
_SCHEMA = "echocal.unit_data/1"


@dataclass(frozen=True)
class Blocks:
    """What is asked for."""

    unit: Path | None  # model of a unit
    units: Path | None  # folder of them
    number: int | None  # of the unit; default: from the name of its file
    model: Path | None  # of the firmware
    per_unit: Sequence[str]  # box of the firmware


def run(asked: Blocks, out: Path, report: str | None, console: Console, *, force: bool, quiet: bool) -> None:
    """Write one block, or a folder of blocks, and say so."""
    if asked.unit is not None and asked.units is not None:
        raise UsageError("--unit-data writes one block, --units a folder of them: give one of both")
    refuse_others(
        _USED if asked.units is None else _USED - {"force"},
        "--unit-data and --units write blocks, and no function. Leave these options out, or give them in a "
        "run without --unit-data and --units",
    )
    model = None if asked.model is None else Model.load(asked.model)
    if asked.unit is not None:
        found = _one(asked, asked.unit, model, out, console, force=force)
    else:
        found = _many(asked, model, out, console, quiet=quiet)
    pass_on(json.dumps({"schema": _SCHEMA, **found}, indent=2) + "\n", report)
    if found["refused"]:
        raise DataError(
            f"{len(found['refused'])} of {found['units']} units were refused; {out / TABLE} has each reason"
        )


def _one(
    asked: Blocks, file: Path, model: Model | None, out: Path, console: Console, *, force: bool
) -> dict[str, Any]:
    block_before = Output("--out", out, _is_block)
    check_outputs(block_before, inputs=[file, asked.model], force=force, told=True)
    unit = Model.load(file)
    box = _box(model, unit, asked.per_unit)
    found = number_of(file) if asked.number is None else asked.number
    if found is None:
        raise DataError(f"{file.name}: its name does not end in the number of the unit: give --unit-number")
    block = block_of(unit, found, box, model, file.name)
    with replacing(out) as unfinished:
        unfinished.write_bytes(block.to_bytes())
    sides = ", ".join(f"{p.key} {p.of(unit):g}{'' if p.unit == '1' else ' ' + p.unit}" for p in PARAMETERS)
    console.print(f"unit {block.number}: {escape(sides)}")
    _tell_uncompared(model, console)
    console.print(f"written: [cyan]{escape(str(out))}[/], {BYTES} bytes: {block.to_bytes().hex(' ')}")
    values = {parameter.key: parameter.of(unit) for parameter in PARAMETERS}
    return {"units": 1, "refused": {}, "number": block.number, "block": block.to_bytes().hex(), **values}


def _many(asked: Blocks, model: Model | None, out: Path, console: Console, *, quiet: bool) -> dict[str, Any]:
    folder = asked.units or Path()
    with counted_bar(quiet, "writing blocks") as tell:
        done = write_units(folder, out, model=model, per_unit=asked.per_unit, progress=tell)
    console.print(f"written: {done.written} blocks and [cyan]{escape(str(out / TABLE))}[/]")
    _tell_uncompared(model, console)
    for reason in list(done.refused.values())[:_FEW]:
        console.print(f"[yellow]refused[/] {escape(reason)}")
    return {"units": done.written + len(done.refused), "refused": dict(done.refused)}


def _box(model: Model | None, unit: Model, per_unit: Sequence[str]) -> Box:
    if per_unit:
        return Box.around(model or unit, per_unit)
    return Box.widest(unit) if model is None else Box.around(model, [p.effect for p in PARAMETERS])


def _tell_uncompared(model: Model | None, console: Console) -> None:
    if model is None:
        console.print(
            "[yellow]note[/] no model of the firmware was given, so nothing else was compared with it; the "
            "firmware itself refuses parameters outside its box"
        )


def _is_block(file: Path) -> bool:
    """Whether a file is a block: only this command makes one."""
    try:
        Block.from_bytes(file.read_bytes())
    except (DataError, OSError):
        return False
    return True
