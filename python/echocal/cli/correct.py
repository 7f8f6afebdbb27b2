"""``echocal correct``: the same tables with a corrected distance."""

from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._models import Effects, Law, Uncertain, model_of
from echocal.cli._outputs import Force, Output, check_outputs, made_in
from echocal.cli._progress import rows_bar
from echocal.cli._tables import (
    AS_IT_IS,
    Engine,
    Given,
    Json,
    Quiet,
    SpreadsheetSafe,
    from_stdin,
    notes,
    reading_options,
    write_json,
)
from echocal.correct import Summary, correct_files
from echocal.correct.inputs import Inputs, find_inputs, refuse_ending
from echocal.correct.manifest import FOLDER
from echocal.correct.said import sentences
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.objects import Object
from echocal.places import Place, place_of


@reading_options("sheet")
def command(
    data: Annotated[
        str,
        typer.Argument(
            metavar="IN", help="CSV, TSV, Parquet; a folder of them, or a glob in quotes; or s3://..."
        ),
    ],
    out: Annotated[str, typer.Option("--out", "-o", metavar="OUT", help="File or folder to write.")],
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model file; default: a law alone.")
    ] = None,
    law: Law = None,
    effect: Effects = None,
    models: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder with one model for each key of --by.")
    ] = None,
    by: Annotated[
        str | None,
        typer.Option(metavar="COLUMN", help="Column or partition with the key of a row: sensor_id."),
    ] = None,
    logs: Annotated[
        str | None,
        typer.Option(
            metavar="file|key|all", help="Which files are one log, for a model that depends on other rows."
        ),
    ] = None,
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
    uncertainties: Uncertain = None,
    append_only: Annotated[
        str | None,
        typer.Option(metavar="COLUMN,...", help="Write these columns and the results only."),
    ] = None,
    round_mm: Annotated[
        float | None, typer.Option(metavar="MM", help="Round distances to multiples of this.")
    ] = None,
    memory: Annotated[str, typer.Option(help="Memory that the run may use.")] = "512MB",
    processes: Annotated[int, typer.Option(min=1, help="Processes; threads for a single file.")] = 2,
    engine: Engine = "local",
    reading: Given = AS_IT_IS,
    spreadsheet_safe: SpreadsheetSafe = False,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Append corrected_distance_m, its standard uncertainty and a reason code; same rows, same order."""
    data = str(from_stdin(Path(data))) if data == "-" else data
    inputs = find_inputs(data)
    place = place_of(out)
    if inputs.single:
        refuse_ending(place)
    if isinstance(place, Object) and not force:
        _refuse_replacing(inputs, place)
    check_outputs(
        Output("--json", json, _made_by.result("echocal.correct")),
        *_made(inputs, place),
        inputs=[*(s.path for s in inputs.files if isinstance(s.path, Path)), model, *reading.files],
        folder=None if inputs.single or isinstance(place, Object) else place,
        force=force,
        told=True,
    )
    if models is not None and (model is not None or law is not None or effect):
        raise UsageError("--models has the models; leave --model, --law and --effect out")
    correction = None if models is not None else model_of(law, model, effect)
    if transferable:
        if correction is None:
            raise UsageError("--transferable is for one model, not for --models")
        correction = correction.transferable()
    with rows_bar(quiet) as progress:
        summary = correct_files(
            data,
            out,
            correction,
            models=models,
            by=by,
            uncertainties=uncertainties or (),
            logs=logs,
            append_only=None if append_only is None else [n.strip() for n in append_only.split(",") if n],
            round_mm=round_mm,
            memory=memory,
            processes=processes,
            engine=engine,
            spreadsheet_safe=spreadsheet_safe,
            force=force,
            progress=progress,
            mark_rows=mark_rows,
            **reading.given(),
        )
    notes([*inputs.left_out(), *sentences(summary.results.values()), *_of_model(correction)], quiet)
    files = {str(place if inputs.single else place / name): it for name, it in summary.results.items()}
    write_json(
        {"schema": "echocal.correct/1", "files": {path: _rows(it) for path, it in files.items()}}, json
    )
    if not quiet and json != "-":
        _print(summary, files)
    if summary.set_aside:
        shown = "; ".join(list(summary.set_aside.values())[:3])
        message = f"{len(summary.set_aside)} of {len(files)} files were set aside: {shown}"
        raise DataError(message)


def _made(inputs: Inputs, out: Place) -> list[Output]:
    """Outputs on a disk; those that the manifest of a folder has may be replaced."""
    if isinstance(out, Object):
        return []
    if inputs.single:
        return [Output("--out", out, _made_by.table("correct"))]
    if (out / FOLDER).is_dir():
        return []
    names = [source.place.as_posix() for source in inputs.files]
    return made_in(out, "--out", names, _made_by.table("correct"))


def _refuse_replacing(inputs: Inputs, out: Object) -> None:
    """Refuse objects that exist, unless they are in a folder of outputs."""
    if not inputs.single and (out / FOLDER / "manifest.jsonl").exists():
        return
    for source in inputs.files:
        coming = out if inputs.single else out / source.place
        if coming.exists():
            message = f"--out {coming} exists: choose another name, or replace it with --force"
            raise UsageError(message)


def _of_model(correction: Model | None) -> list[str]:
    """What a person should know of the model."""
    if correction is None:
        return []
    said = []
    if correction.campaign_effects:
        named = ", ".join(correction.campaign_effects)
        said.append(
            f"the model has {named}, counted from the first row of the campaign that it was found in: if "
            "this is another one, say --transferable to leave it out"
        )
    if correction.air:
        air = ", ".join(f"{name} = {value:g}" for name, value in correction.air.items())
        said.append(f"where the table does not give them, the model's own values are used: {air}")
    return said


def _rows(result: dict[str, Any]) -> dict[str, Any]:
    if result["error"] is not None:
        return {"error": result["error"]["text"]}
    bad = sum(result["unusable"].values())
    rows = {"total": result["rows"], "used": result["rows"] - bad, "unusable": result["unusable"]}
    return {"rows": rows | ({"outside_smooth": result["marked"]} if result["marked"] else {})}


def _print(summary: Summary, files: dict[str, Any]) -> None:
    done = len(files) - len(summary.set_aside)
    named = next(iter(files)) if len(files) == 1 else f"{done} files"
    before = f" ({summary.skipped} files were done before)" if summary.skipped else ""
    Console(soft_wrap=True).print(
        f"{named}: {summary.rows - summary.unusable} of {summary.rows} rows corrected{before}",
        highlight=False,
        markup=False,
    )
