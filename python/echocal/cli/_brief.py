"""A diagnosis in five lines, and the commands that follow from it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from echocal.cli._console import Console
from echocal.diagnose import Diagnosis
from echocal.diagnose.results.brief import brief, column_fault
from echocal.diagnose.results.explain import further_notes
from echocal.keywords import command_line
from echocal.registry import find_effect
from echocal.report.diagnosis import STYLE

_PERMISSIBLE_MM = 3.0  # where no larger difference matters
_EVIDENCE = "see the evidence"
_ROOM = 5.0  # K beyond the temperatures of the log, for which the C is made


def print_brief(
    diagnosis: Diagnosis, console: Console, files: Sequence[str], first: str, details: str
) -> None:
    """Print what is wrong, by how much, how sure, what was written, what to do next.

    `first` is the command to run next, or empty; `details` is the command, or the option, that shows all.
    """
    said = brief(diagnosis)
    word = "good enough" if diagnosis.good_enough else diagnosis.verdict
    noted = len(further_notes(diagnosis))
    also = f" and {noted} note{'s' * (noted > 1)}" if noted else ""
    more = f"the evidence{also}: {details}"
    lines = {
        "what is wrong": Text.assemble(
            (word, STYLE[diagnosis.verdict]), f": {said.wrong[0].lower()}{said.wrong[1:]}"
        ),
        "by how much": Text(said.size),
        "how sure": Text(said.sure),
        "written": Text(", ".join(files) or "nothing"),
        "what next": Text(f"{said.next} {first or ''}".strip() + f"\n{more}"),
    }
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    for label, text in lines.items():
        table.add_row(label, text)
    console.print(table)


def print_commands(console: Console, commands: Mapping[str, str]) -> None:
    """Print commands as they can be pasted, with what each is for."""
    for purpose, command in commands.items():
        console.print(Text(f"# {purpose}", style="dim"), soft_wrap=True)
        console.print(command, markup=False, highlight=False, soft_wrap=True)


def follow_up(diagnosis: Diagnosis, log: Path, model: Path, reading: Mapping[str, Any]) -> dict[str, str]:
    """The three commands that follow, by their purpose, with the options of commands that read the log."""
    name = str(model).removesuffix("-model.json").removesuffix(".json")
    details = {_EVIDENCE: command_line("diagnose", log, **reading, details=True)}
    corrected = command_line("correct", log, **_of_rows(reading), model=model, out=f"{name}-corrected.csv")
    permissible = max(_PERMISSIBLE_MM, diagnosis.matters_mm)
    verified = command_line(
        "verify", log, **_of_rows(reading), maximum_permissible_error_mm=permissible, model=model
    )
    known = "distance" in diagnosis.traces.against
    if diagnosis.good_enough or diagnosis.verdict == "nothing":
        last = {f"compare each row with a permissible error of {permissible:g} mm": verified} if known else {}
        return {**details, **last}
    if diagnosis.verdict != "named" or not diagnosis.model.effects:
        corrects = {"correct the log with what is known so far": corrected} if diagnosis.model.effects else {}
        return {**details, **corrects}
    c = {"write the correction as C for a microcontroller": _firmware(diagnosis, model, f"{name}-firmware")}
    inputs = any(find_effect(id_).firmware == "needs" for id_ in diagnosis.model.effects)
    corrects = {} if column_fault(diagnosis) else {"correct the log": corrected}
    return {**corrects, **({} if inputs else c), **details}


def without_evidence(commands: Mapping[str, str]) -> dict[str, str]:
    """Those of the commands that a page with the evidence needs."""
    return {purpose: command for purpose, command in commands.items() if purpose != _EVIDENCE}


def _firmware(diagnosis: Diagnosis, model: Path, out: str) -> str:
    temperature = diagnosis.traces.against.get("temperature")
    span = "-20:60"
    if temperature is not None and np.isfinite(temperature).any():
        low, high = np.nanmin(temperature) - _ROOM, np.nanmax(temperature) + _ROOM
        span = f"{np.floor(low):.0f}:{np.ceil(high):.0f}"
    codes = {"temperature_lsb": 0.0625, "temperature_range": span}
    return command_line("firmware", model, target="avr", **codes, max_error_mm=1, out=out)


def _of_rows(reading: Mapping[str, Any]) -> dict[str, Any]:
    """Options without those that only a diagnosis has."""
    return {name: value for name, value in reading.items() if name not in _DIAGNOSIS}


_DIAGNOSIS = {"base", "reference_distance", "constant_distance", "placements", "matters_mm"}
