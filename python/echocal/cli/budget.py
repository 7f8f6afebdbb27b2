"""``echocal budget``: what a corrected distance is uncertain by, source by source."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from echocal.budget import TRIALS, Budget, budget
from echocal.budget.coverage import COVERAGE
from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._models import Effects, Law, Uncertain, model_of, read_for
from echocal.cli._options import from_stdin
from echocal.cli._outputs import Force, Output, Quiet, check_outputs
from echocal.cli._tables import AS_IT_IS, Given, Json, noted, read, reading_options, write_json
from echocal.errors import UsageError
from echocal.outputs import replace_text
from echocal.sweep import parse, parse_named


@reading_options()
def command(
    model: Annotated[
        Path | None, typer.Argument(metavar="[MODEL]", help="Model file (.json); default: a law alone.")
    ] = None,
    data: Annotated[
        Path | None, typer.Argument(metavar="[DATA]", help="Table of readings; default: a grid.")
    ] = None,
    uncertainties: Uncertain = None,
    law: Law = None,
    effect: Effects = None,
    distance: Annotated[
        str | None, typer.Option(metavar="RANGE", help="For a grid: distances [m]; default 0.5,1,2,4.")
    ] = None,
    temperature: Annotated[
        str | None, typer.Option(metavar="RANGE", help="For a grid: temperatures [degC]; default 20.")
    ] = None,
    grid: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=RANGE", help='For a grid: any quantity: "humidity_percent=0:100:20".'),
    ] = None,
    row: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Row whose budget is shown; default: the largest U."),
    ] = None,
    coverage: Annotated[float, typer.Option(help="Coverage probability of U.")] = COVERAGE,
    trials: Annotated[int, typer.Option(min=0, help="Draws of the Monte Carlo method; 0: none.")] = TRIALS,
    seed: Annotated[int, typer.Option(help="Of these draws.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Write every line of every row as .csv."),
    ] = None,
    reading: Given = AS_IT_IS,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Itemize the uncertainty of corrected distances (GUM), for each reading or for a grid of conditions."""
    if model is not None and model.suffix.lower() != ".json" and data is None:
        model, data = None, model
    data = None if data is None else from_stdin(data)
    check_outputs(
        Output("--json", json, _made_by.result("echocal.budget")),
        Output("--out", out, _made_by.table("budget")),
        inputs=[model, data, *reading.files],
        force=force,
    )
    corrects = model_of(law, model, effect)
    with noted(quiet):
        if data is not None:
            if distance or temperature or grid:
                raise UsageError(
                    "--distance, --temperature and --grid make a grid, and a table is given; leave them out"
                )
            reading = read_for(corrects, reading)
            given: dict[str, Any] = {"observations": read(data, quiet, reading)}
        else:
            given = {
                "distance": parse("distance", distance or "0.5,1,2,4"),
                "temperature": parse("temperature", temperature or "20"),
                **dict(map(parse_named, grid or [])),
            }
        found = budget(
            corrects, uncertainties=uncertainties or (), coverage=coverage, trials=trials, seed=seed, **given
        )
    shown = _shown(found, row)
    write_json(found.to_dict(), json)
    if out is not None:
        replace_text(out, found.to_dataframe().to_csv(index=False))
    if not quiet and json != "-":
        from echocal.report.budget import print_budget  # what it imports takes long

        print_budget(found, shown, Console())


def _shown(found: Budget, row: int | None) -> int:
    if row is None:
        return int(np.nanargmax(found.expanded_uncertainty))
    if row > len(found.distance) or not np.isfinite(found.distance[row - 1]):
        raise UsageError(f"--row {row}: there are {len(found.distance)} rows, and the row needs a distance")
    return row - 1
