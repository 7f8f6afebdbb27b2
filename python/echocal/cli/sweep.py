"""``echocal sweep``: a model over a grid of conditions."""

from pathlib import Path
from typing import Annotated

import typer
import xarray as xr
from rich.table import Table

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._models import Effects, Law, model_of
from echocal.cli._outputs import Force, Output, Quiet, check_outputs
from echocal.cli._ranges import Distance, Humidity, Pressure, Temperature, given_ranges
from echocal.cli._tables import Json, noted, write_json
from echocal.errors import UsageError
from echocal.sweep import parse_named, refuse_ending, sweep, write


def command(
    temperature: Temperature = None,
    distance: Distance = None,
    relative_humidity: Humidity = None,
    pressure: Pressure = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=RANGE", help='Any quantity, unit in the name: "humidity_percent=0:100:20".'
        ),
    ] = None,
    law: Law = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file instead of a law.")] = None,
    effect: Effects = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write .csv, .parquet or .nc.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a plot: .png, .svg, .pdf.")] = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Simulate a device over every combination of conditions."""
    check_outputs(
        Output("--out", out, _made_by.table("sweep")),
        Output("--plot", plot, _made_by.picture("sweep")),
        Output("--json", json, _made_by.result("echocal.sweep")),
        inputs=[model],
        force=force,
    )
    if out is not None:
        refuse_ending(out)
    if plot is not None:
        _refuse_plot(plot)
    ranges = given_ranges(
        temperature=temperature, distance=distance, relative_humidity=relative_humidity, pressure=pressure
    )
    for name, values in map(parse_named, at or []):
        if name in ranges:
            raise UsageError(f"{name.replace('_', ' ')} is given twice; give it once")
        ranges[name] = values
    if "temperature" not in ranges:
        raise UsageError("sweep needs a temperature: --temperature 0:50:2")
    with noted(quiet):
        grid = sweep(model_of(law, model, effect), **ranges)
    if plot is not None:
        _plot(grid, plot)
    if out is not None:
        write(grid, out)
    write_json({"schema": "echocal.sweep/1", **grid.to_dict()}, json)
    if not quiet and json != "-":
        _summarize(grid)


def _plot(grid: xr.Dataset, path: Path) -> None:
    from echocal.plots.draw import save_figure  # matplotlib takes a second to import
    from echocal.plots.sweep import sweep_figure

    if not grid.sizes:
        raise UsageError("a single point makes no plot; give a range, such as --temperature 0:50:2")
    save_figure(sweep_figure(grid), path, "sweep")


def _refuse_plot(path: Path) -> None:
    from matplotlib.backend_bases import FigureCanvasBase

    if path.suffix.lower().removeprefix(".") not in FigureCanvasBase.get_supported_filetypes():
        told = f"the ending '{path.suffix}'" if path.suffix else "no ending"
        raise UsageError(f"{path} has {told}; a plot is .png, .svg or .pdf")


def _summarize(grid: xr.Dataset) -> None:
    title = f"{grid.attrs['model']}: {grid['error'].size} points"
    table = Table("quantity", "least", "greatest", "unit", title=title)
    for name, values in grid.data_vars.items():
        least, greatest = (f"{float(value):.6g}" for value in (values.min(), values.max()))
        table.add_row(
            str(name).replace("_", " "), least, greatest, values.attrs["units"].replace(" s-1", "/s")
        )
    Console().print(table)
