"""``echocal correct``: the same table with a corrected distance."""

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress

from echocal.cli import _made_by
from echocal.cli._models import Effects, model_of
from echocal.cli._outputs import Force, Output, check_outputs, made_in
from echocal.cli._tables import (
    Columns,
    Decimal,
    Encoding,
    Json,
    Missing,
    Quiet,
    ReadingSpeed,
    SkipLines,
    TimeZone,
    Trust,
    noted,
    notes,
    options_of,
    toml_files,
    write_json,
)
from echocal.correct import Corrected, correct_file, correct_folder
from echocal.model import Model
from echocal.observations.source import is_folder
from echocal.observations.text import Layout


def command(
    data: Annotated[Path, typer.Argument(help="CSV, TSV, Parquet, or a folder of Parquet.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="OUT", help="File or folder to write.")],
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model file; default: a law alone.")
    ] = None,
    law: Annotated[
        str | None, typer.Option(help="Law or expression, in place of a model; default cramer.")
    ] = None,
    effect: Effects = None,
    transferable: Annotated[
        bool,
        typer.Option(
            "--transferable", help="Leave out effects that belong to the measurement campaign of the model."
        ),
    ] = False,
    mark_rows: Annotated[
        bool,
        typer.Option(
            "--mark-rows/--no-mark-rows",
            help="Mark rows that are as those which the diagnosis of the model left out.",
        ),
    ] = True,
    column: Columns = None,
    missing: Missing = None,
    trust: Trust = None,
    reading_speed: ReadingSpeed = None,
    time_zone: TimeZone = "UTC",
    skip_lines: SkipLines = 0,
    decimal: Decimal = ".",
    encoding: Encoding = "utf-8-sig",
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Append corrected_distance_m and a reason code; same rows, same order."""
    folder = is_folder(data)
    made = [file.relative_to(data) for file in data.rglob("*.parquet")] if folder else []
    check_outputs(
        Output("--json", json, _made_by.result("echocal.correct")),
        Output("--out", None if folder else out, _made_by.table("correct")),
        *made_in(out if folder else None, "--out", map(str, made), _made_by.table("correct")),
        inputs=[data, model, *toml_files(column)],
        folder=out if folder else None,
        force=force,
    )
    options = options_of(column, missing, trust, reading_speed=reading_speed, time_zone=time_zone)
    options["mark_rows"] = mark_rows
    correction = model_of(law, model, effect)
    if transferable:
        correction = correction.transferable()
    with noted(quiet):
        if folder:
            done = _folder(data, out, correction, quiet, options)
        else:
            layout = Layout(skip_lines, decimal, encoding)
            done = {out: correct_file(data, out, correction, layout=layout, **options)}
    for result in done.values():
        notes(result.notes, quiet)
    if correction.campaign_effects:
        named = ", ".join(correction.campaign_effects)
        told = (
            f"the model has {named}, counted from the first row of the campaign that it was found in: if "
            "this is another one, say --transferable to leave it out"
        )
        notes([told], quiet)
    if correction.air:
        air = ", ".join(f"{name} = {value:g}" for name, value in correction.air.items())
        notes([f"where the table does not give them, the model's own values are used: {air}"], quiet)
    write_json(
        {"schema": "echocal.correct/1", "files": {str(path): _rows(it) for path, it in done.items()}}, json
    )
    if not quiet and json != "-":
        _print(done)


def _folder(
    data: Path, out: Path, correction: Model, quiet: bool, options: dict[str, Any]
) -> dict[Path, Corrected]:
    with Progress(console=Console(stderr=True, quiet=quiet), transient=True) as bar:
        task = bar.add_task("correcting", total=None)
        return correct_folder(
            data,
            out,
            correction,
            **options,
            progress=lambda count, total: bar.update(task, completed=count, total=total),
        )


def _rows(result: Corrected) -> dict[str, Any]:
    bad = sum(result.unusable.values())
    rows = {"total": result.rows, "used": result.rows - bad, "unusable": result.unusable}
    return {"rows": rows | ({"outside_smooth": result.marked} if result.marked else {})}


def _print(done: dict[Path, Corrected]) -> None:
    total = sum(result.rows for result in done.values())
    bad = sum(sum(result.unusable.values()) for result in done.values())
    files = str(next(iter(done))) if len(done) == 1 else f"{len(done)} files"
    Console(soft_wrap=True).print(
        f"{files}: {total - bad} of {total} rows corrected", highlight=False, markup=False
    )
