"""``echocal calibrate``: parameters of a model from measured data."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from echocal.calibrate import Calibration, calibrate
from echocal.cli import _made_by
from echocal.cli._complete import parameters
from echocal.cli._console import Console
from echocal.cli._models import Effects, Law, model_of
from echocal.cli._options import from_stdin
from echocal.cli._outputs import Force, Output, Quiet, Report, check_outputs, write_report
from echocal.cli._tables import AS_IT_IS, Given, Json, noted, read, reading_options, write_json

STRONG = 0.95  # correlation from which two parameters are named


@reading_options()
def command(
    data: Annotated[Path, typer.Argument(help="Table of echoes with reference distances.")],
    fit: Annotated[
        list[str],
        typer.Option(
            metavar="NAME",
            help="Parameter to fit: zero_error.offset, fixed_delay, law.slope.",
            autocompletion=parameters,
        ),
    ],
    law: Law = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file to begin with.")] = None,
    effect: Effects = None,
    loss: Annotated[
        str, typer.Option(help="Loss: linear; soft_l1, huber or cauchy if rows may be wrong.")
    ] = "linear",
    reading: Given = AS_IT_IS,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the calibrated model.")
    ] = None,
    report: Report = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Estimate parameters by least squares, with standard uncertainties and correlations."""
    data = from_stdin(data)
    check_outputs(
        Output("--out", out, _made_by.model("calibrate", data)),
        Output("--json", json, _made_by.result("echocal.calibration")),
        Output("--report", report, _made_by.report("calibrate", data)),
        inputs=[data, model, *reading.files],
        force=force,
    )
    start = model_of(law, model, effect)
    with noted(quiet):
        reading = replace(reading, reading_speed=reading.reading_speed or start.law)
        found = calibrate(read(data, quiet, reading), start, fit, loss=loss)
    if out is not None:
        _made_by.sign(found.model, "calibrate", data, out).save(out)
    if report is not None:
        from echocal.report.html.results import calibration_page

        write_report(report, calibration_page, found, data.name)
    write_json(found.to_dict(), json)
    if not quiet and json != "-":
        _print(found)


def _print(found: Calibration) -> None:
    console = Console()
    table = Table("parameter", "value", "standard uncertainty", "unit")
    for estimate in found:
        table.add_row(
            estimate.name, f"{estimate.value:.6g}", f"{estimate.standard_uncertainty:.2g}", estimate.unit
        )
    console.print(table)
    used, total = found.rows["used"], found.rows["total"]
    deviation = found.residual_standard_deviation * 1e3
    console.print(f"{used} of {total} rows used; residual standard deviation {deviation:.3f} mm")
    for i, first in enumerate(found.names):
        for j, second in enumerate(found.names[:i]):
            if abs(found.correlation[i, j]) > STRONG:
                console.print(f"{second} and {first} are correlated: {found.correlation[i, j]:+.3f}")
    for name in found.at_bounds:
        console.print(f"{name} ended on a bound: its uncertainty is not reliable", style="yellow")
    for note in found.notes:
        console.print(f"note: {note}", markup=False)
