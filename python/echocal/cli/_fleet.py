"""``echocal diagnose`` of a fleet: every sensor has a verdict of its own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Output, check_outputs, made_in, write_report
from echocal.cli._tables import write_json
from echocal.correct.batch import in_bytes
from echocal.correct.inputs import find_inputs
from echocal.errors import DataError, UsageError

__all__ = ["How", "Outputs", "diagnose_sensors", "is_fleet", "refuse_options"]

_INSTEAD = {
    "--save-model": "give --models DIR, one file for each sensor",
    "--with-shape": "an unexplained term belongs to its table: diagnose this sensor alone",
    "--with-smooth": "a smooth correction belongs to its table: diagnose this sensor alone",
    "--rows": "diagnose a sensor alone for its rows",
    "--placements": 'give the log a column with the distances: --column "NAME=distance_m"',
    "--matters-mm": "diagnose a sensor alone to be told what matters",
    "--can-vary": "diagnose a sensor alone for its next measurements",
}


@dataclass(frozen=True)
class Outputs:
    """Where the results go."""

    table: Path | None
    models: Path | None
    results: Path | None
    plots: Path | None
    json: str | None
    plot_format: str = "png"
    report: Path | None = None


@dataclass(frozen=True)
class How:
    """How a fleet is divided and computed."""

    kind: str | None
    memory: str
    workers: int | None
    engine: str
    spreadsheet_safe: bool = False


def is_fleet(inputs: Sequence[Path], table: Path | None) -> bool:
    """Whether each sensor is to have a verdict of its own."""
    if table is not None:
        return True
    return any(not find_inputs(path).single for path in inputs)


def refuse_options(given: Mapping[str, object]) -> None:
    """Raise `UsageError` for an option that is for one table only."""
    for option, value in given.items():
        if value:
            message = f"{option} is for one table, and this is a fleet; {_INSTEAD[option]}"
            raise UsageError(message)


def diagnose_sensors(
    inputs: Sequence[Path],
    by: str | None,
    used: Sequence[str | None],
    request: Mapping[str, Any],
    reading: Mapping[str, Any],
    outputs: Outputs,
    how: How,
    *,
    force: bool,
    quiet: bool,
) -> None:
    """Diagnose each sensor, and write and print the verdicts.

    Raises
    ------
    DataError
        If a sensor cannot be diagnosed; everything is written then.
    """
    from echocal.fleet import diagnose_fleet
    from echocal.report.several import print_fleet

    _check(inputs, used, outputs, force)
    with _bar(quiet) as bar:
        task = bar.add_task("sensors", total=None, rate="")
        start: dict[str, float] = {}

        def progress(done: int, total: int, earlier: int) -> None:
            bar.update(task, completed=done, total=total)
            elapsed = bar.get_time() - start.setdefault("begun", bar.get_time())
            rate = f"{(done - earlier) / elapsed:.1f}/s" if elapsed > 0 else ""
            bar.update(task, rate=rate)

        fleet = diagnose_fleet(
            inputs,
            by,
            out=outputs.table,
            models=outputs.models,
            results=outputs.results,
            kind=how.kind,
            reading=reading,
            workers=how.workers,
            engine=how.engine,
            memory=in_bytes(how.memory),
            spreadsheet_safe=how.spreadsheet_safe,
            force=force,
            progress=progress,
            **request,
        )
    if outputs.plots is not None:
        from echocal.plots.several import save_fleet  # matplotlib takes a second to import

        save_fleet(fleet.summary, outputs.plots, outputs.plot_format)
    if outputs.report is not None:
        from echocal.report.html.several import fleet_page

        write_report(outputs.report, fleet_page, fleet.summary, inputs[0].name)
    write_json(fleet.summary, outputs.json)
    if not quiet and outputs.json != "-":
        print_fleet(fleet.summary, Console())
    if fleet.failed:
        first = next(row for row in fleet.rows if row["verdict"] == "failed")
        message = (
            f"{fleet.failed} of {len(fleet.rows)} sensors could not be diagnosed, the others were; "
            f"the first: {first['sensor']}: {first['reason']}"
        )
        raise DataError(message)


def _bar(quiet: bool) -> Progress:
    """Progress bar on a terminal, with sensors a second and the time that is left."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=console, transient=True, disable=quiet or not console.is_terminal)


def _check(inputs: Sequence[Path], used: Sequence[str | None], outputs: Outputs, force: bool) -> None:
    if outputs.table is not None and outputs.table.suffix.lower() not in {".parquet", ".csv"}:
        message = f"--output {outputs.table} must end in .parquet or .csv"
        raise UsageError(message)
    every = [*inputs, *used]
    check_outputs(
        Output("--output", outputs.table, _made_by.verdicts()),
        Output("--json", outputs.json, _made_by.result("echocal.fleet")),
        Output("--report", outputs.report, _made_by.report("diagnose")),
        inputs=every,
        force=force,
    )
    for option, folder, recognize in (
        ("--models", outputs.models, _made_by.sensor_model()),
        ("--results", outputs.results, _made_by.result("echocal.diagnosis")),
    ):
        there = [] if folder is None or not folder.is_dir() else [file.name for file in folder.glob("*.json")]
        check_outputs(*made_in(folder, option, there, recognize), inputs=every, folder=folder, force=force)
    if outputs.plots is not None:
        from echocal.plots.draw import in_form
        from echocal.plots.several import PICTURES

        names = in_form(PICTURES, outputs.plot_format)
        pictures = made_in(outputs.plots, "--plots", names, _made_by.picture("diagnose"))
        check_outputs(*pictures, inputs=every, folder=outputs.plots, force=force)
