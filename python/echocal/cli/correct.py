"""``echocal correct``: the same tables with a corrected distance."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._models import Effects, Law, MarkRows, ModelFile, Uncertain, model_of
from echocal.cli._options import from_stdin
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, made_in
from echocal.cli._progress import rows_bar
from echocal.cli._tables import (
    AS_IT_IS,
    Engine,
    Given,
    Json,
    SpreadsheetSafe,
    notes,
    reading_options,
    write_json,
)
from echocal.correct import Summary, correct_files
from echocal.correct.inputs import Inputs, find_inputs, refuse_ending
from echocal.correct.manifest import FOLDER
from echocal.correct.side_by_side import correct_rangers, ranger_file, rangers_of
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.objects import Object
from echocal.places import Place, place_of

_NAMED = 3  # files that a sentence names


@reading_options("sheet")
def command(
    data: Annotated[
        str,
        typer.Argument(
            metavar="IN", help="CSV, TSV, Parquet; a folder of them, or a glob in quotes; or s3://..."
        ),
    ],
    out: Annotated[str, typer.Option("--out", "-o", metavar="OUT", help="File or folder to write.")],
    model: ModelFile = None,
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
    mark_rows: MarkRows = True,
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
    rangers = rangers_of(by, models)
    if inputs.single and not rangers:
        refuse_ending(place)
    if isinstance(place, Object) and not force:
        _refuse_replacing(inputs, place)
    check_outputs(
        Output("--json", json, _made_by.result("echocal.correct")),
        *(_made_for(rangers, data, place) if rangers else _made(inputs, place)),
        inputs=[*(s.path for s in inputs.files if isinstance(s.path, Path)), model, *reading.files],
        folder=None if (inputs.single and not rangers) or isinstance(place, Object) else place,
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
        how: dict[str, Any] = {
            "uncertainties": uncertainties or (),
            "logs": logs,
            "append_only": None if append_only is None else [n.strip() for n in append_only.split(",") if n],
            "round_mm": round_mm,
            "memory": memory,
            "processes": processes,
            "engine": engine,
            "spreadsheet_safe": spreadsheet_safe,
            "force": force,
            "progress": progress,
            "mark_rows": mark_rows,
            **reading.given(),
        }
        if rangers:
            columns = how.pop("columns", {})
            done = correct_rangers(correct_files, data, Path(out), rangers, columns, **how)
            summary = Summary({name: next(iter(own.results.values())) for name, own in done.items()})
        else:
            summary = correct_files(data, out, correction, models=models, by=by, **how)
    notes([*inputs.left_out(), *sentences(summary.results.values()), *_of_model(correction)], quiet)
    files = {
        str(place if inputs.single and not rangers else place / name): it
        for name, it in summary.results.items()
    }
    write_json(
        {"schema": "echocal.correct/1", "files": {path: _rows(it) for path, it in files.items()}}, json
    )
    if not quiet and json != "-":
        _print(summary, files)
    if summary.set_aside:
        shown = "; ".join(list(summary.set_aside.values())[:3])
        raise DataError(f"{len(summary.set_aside)} of {len(files)} files were set aside: {shown}")


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


def _made_for(rangers: Mapping[str, Model], data: str, out: Place) -> list[Output]:
    """The tables of rangers beside each other."""
    names = [ranger_file(name, data) for name in rangers]
    return [] if isinstance(out, Object) else made_in(out, "--out", names, _made_by.table("correct"))


def _refuse_replacing(inputs: Inputs, out: Object) -> None:
    """Refuse objects that exist, unless they are in a folder of outputs."""
    if not inputs.single and (out / FOLDER / "manifest.jsonl").exists():
        return
    for source in inputs.files:
        coming = out if inputs.single else out / source.place
        if coming.exists():
            raise UsageError(f"--out {coming} exists: choose another name, or replace it with --force")


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


def sentences(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """Sentences on what was assumed, left out and unusable."""
    done = [result for result in results if result["error"] is None]
    causes: dict[str, list[str]] = {}
    for result in done:
        for note in result["notes"]:
            causes.setdefault(note, []).append(result["source"])
    said = [f"{note}{_in(files, len(done))}" for note, files in causes.items()]
    said += _of_rows(done, "unusable", "no distance")
    said += _of_rows(done, "marked", "the distance by the model without its smooth correction")
    said += _of_domains(done)
    return said + _of_schemas(done)


def _of_rows(done: list[Mapping[str, Any]], kind: str, what: str) -> list[str]:
    found: dict[str, list[tuple[str, int, int]]] = {}
    for result in done:
        for reason, count in result[kind].items():
            found.setdefault(reason, []).append((result["source"], count, result["first"][reason]))
    said = []
    for reason, places in found.items():
        total = sum(count for _, count, _ in places)
        first, _, row = places[0]
        where = f"first at row {row}" + (f" of {first}" if len(done) > 1 else "")
        said.append(
            f"{what} in {_count_of_rows(total)}: {reason}, {where}{_in([p[0] for p in places], len(done))}"
        )
    return said


def _of_domains(done: list[Mapping[str, Any]]) -> list[str]:
    found: dict[str, list[tuple[str, int, int, float]]] = {}
    for result in done:
        for domain, (count, row, value) in result["outside"].items():
            found.setdefault(domain, []).append((result["source"], count, row, value))
    return [
        f"{domain}: {_count_of_rows(sum(p[1] for p in places))} outside, first at row {places[0][2]}: "
        f"{places[0][3]:g}{_in([p[0] for p in places], len(done))}"
        for domain, places in found.items()
    ]


def _of_schemas(done: list[Mapping[str, Any]]) -> list[str]:
    """How columns differ between files: the files that are not as most are. A text has names, no types."""
    said = _of_columns(done, lambda result: result["columns"])
    typed: dict[frozenset[str], list[Mapping[str, Any]]] = {}
    for result in done:
        if result["types"]:
            typed.setdefault(frozenset(result["columns"]), []).append(result)
    for alike in typed.values():
        said += _of_columns(alike, _with_types)
    return said


def _with_types(result: Mapping[str, Any]) -> list[str]:
    pairs = zip(result["columns"], result["types"], strict=True)
    return sorted(f"{name} ({kind})" for name, kind in pairs)


def _of_columns(
    done: list[Mapping[str, Any]], columns: Callable[[Mapping[str, Any]], list[str]]
) -> list[str]:
    kinds: dict[tuple[str, ...], list[str]] = {}
    for result in done:
        kinds.setdefault(tuple(columns(result)), []).append(result["source"])
    if len(kinds) < 2:
        return []
    usual = max(kinds, key=lambda columns: len(kinds[columns]))
    said = []
    for own, files in kinds.items():
        if own == usual:
            continue
        more = [name for name in own if name not in usual]
        less = [name for name in usual if name not in own]
        how = [f"has {', '.join(more)}"] * bool(more) + [f"lacks {', '.join(less)}"] * bool(less)
        how = how or ["has the columns in another order"]
        said.append(f"columns differ between files: {_listed(files)} {' and '.join(how)}")
    return said


def _in(files: list[str], total: int) -> str:
    """Which files, unless there is only one."""
    if total == 1:
        return ""
    if len(files) == total:
        return f" (all {total} files)"
    return f" ({_listed(files)})"


def _listed(files: list[str]) -> str:
    more = f" and {len(files) - _NAMED} more" if len(files) > _NAMED else ""
    return f"{', '.join(files[:_NAMED])}{more}"


def _count_of_rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"
