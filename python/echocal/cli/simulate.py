"""``echocal simulate``: a table of a campaign on the virtual bench."""

from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, refuse_picture
from echocal.cli._tables import Json, write_json
from echocal.errors import UsageError
from echocal.outputs import write_table

_ENDINGS = (".csv", ".parquet")


def command(
    design: Annotated[
        str | None, typer.Option(metavar="NAME", help="How the campaign is run; --list shows them.")
    ] = None,
    cause: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ID[=SIZE]", help="What is wrong, and its size; without one it is drawn. May repeat."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same table.")] = 0,
    detector: Annotated[
        str, typer.Option(metavar="comparator|ideal", help="A comparator's, or one without time walk.")
    ] = "comparator",
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the table: .csv or .parquet.")
    ] = None,
    waveform: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Plot what the comparator sees: .png, .svg, .pdf.")
    ] = None,
    row: Annotated[int, typer.Option(min=1, help="Row of --waveform, from 1.")] = 1,
    list_: Annotated[bool, typer.Option("--list", help="List designs and causes.")] = False,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Make a table as an ultrasonic sensor would, with a cause to be found."""
    if list_:
        _list()
        return
    if design is None:
        raise UsageError("simulate needs a design: --design bench; --list shows all")
    refuse_picture(waveform)
    if out is not None and out.suffix.lower() not in _ENDINGS:
        raise UsageError(f"{out} has the ending '{out.suffix}'; a table is .csv or .parquet")
    check_outputs(
        Output("--out", out, lambda _: False),
        Output("--waveform", waveform, _made_by.picture("simulate")),
        Output("--json", json, _made_by.result("echocal.simulation")),
        force=force,
    )
    from echocal.virtual_bench import simulate

    made = simulate(design, _sizes(cause or []), seed=seed, detector=detector)
    if waveform is not None:
        from echocal.plots.draw import save_figure
        from echocal.plots.waveform import waveform_figure

        figure = waveform_figure(made.scene, made.campaign.sensor, row=row, seed=seed)
        save_figure(figure, waveform, "simulate")
    if out is not None:
        write_table(made.table, out)
    truth = made.truth()
    write_json(truth, json)
    if not quiet and json != "-":
        _tell(truth, out)


def _sizes(words: list[str]) -> dict[str, float | None]:
    """Read `ID=SIZE` pairs; a cause without a size has None."""
    sizes: dict[str, float | None] = {}
    for word in words:
        name, equals, size = word.partition("=")
        if name in sizes:
            raise UsageError(f"--cause {name} is given twice; give it once")
        try:
            sizes[name] = float(size) if equals else None
        except ValueError:
            raise UsageError(
                f"--cause {word}: '{size}' is no number; write {name}=SIZE, or {name} alone for a usual size"
            ) from None
    return sizes


def _tell(truth: dict[str, Any], out: Path | None) -> None:
    console = Console()
    console.print(
        f"{truth['design']}: {truth['rows']} rows, seed {truth['seed']}, {truth['detector']} detector"
    )
    for one in truth["causes"]:
        console.print(f"  {one['id']} = {one['size']:.4g} {one['unit']}: {one['sentence']}")
    if not truth["causes"]:
        console.print("  nothing is wrong on purpose")
    for note in truth["notes"]:
        console.print(f"note: {note}")
    if out is not None:
        console.print(f"next: {truth['diagnose'].replace('TABLE', str(out))}")
    else:
        console.print("no table is written: give --out FILE")


def _list() -> None:
    from echocal.virtual_bench import CAUSES, DESIGNS

    console = Console()
    console.print("designs:")
    for name, function in DESIGNS.items():
        console.print(f"  {name}: {(function.__doc__ or '').strip()}")
    console.print("causes, with unit and usual sizes:")
    for one in CAUSES.values():
        needs = f" Needs {', '.join(sorted(one.needs))}." if one.needs else ""
        console.print(f"  {one.id} [{one.unit}] {one.usual()}: {one.sentence}{needs}", markup=False)
