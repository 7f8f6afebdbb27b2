"""``echocal echo-times``: captures of waveforms to a table of echo times."""

from pathlib import Path
from typing import Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, refuse_picture
from echocal.cli._progress import counted_bar
from echocal.cli._tables import Json, write_json
from echocal.errors import UsageError
from echocal.outputs import write_table

_METHODS = "matched_filter, phase, envelope, threshold"


def command(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Captures: .npy, WAV, or Parquet with lists of samples.")
    ],
    sample_rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Samples per second [Hz], if the file does not say it.")
    ] = None,
    method: Annotated[str, typer.Option(metavar="NAME", help=f"{_METHODS}.")] = "matched_filter",
    column: Annotated[
        str | None, typer.Option(metavar="NAME", help="Column of a Parquet file that holds the captures.")
    ] = None,
    template: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|mean",
            help="One echo without noise (.npy, WAV), or mean: that of the captures. Default: 8 cycles "
            "through two resonances.",
        ),
    ] = None,
    carrier: Annotated[float, typer.Option(metavar="HZ", help="Frequency of the burst [Hz].")] = 40e3,
    bandwidth: Annotated[
        float | None, typer.Option(metavar="HZ", help="Width of the band-pass [Hz]; default: carrier / 8.")
    ] = None,
    threshold: Annotated[
        float | None,
        typer.Option(
            help="Level of the method threshold [unit of the waveform]; default: 6 times the noise."
        ),
    ] = None,
    noise: Annotated[
        float | None,
        typer.Option(help="Standard deviation of white noise [unit of the waveform]; default: estimated."),
    ] = None,
    start_us: Annotated[
        float, typer.Option(metavar="US", help="Begin of the window [us], after the burst's own ringing.")
    ] = 0.0,
    stop_us: Annotated[float | None, typer.Option(metavar="US", help="End of the window [us].")] = None,
    full_scale: Annotated[
        float | None,
        typer.Option(
            help="Full scale [unit of the waveform]; the amplitude is written as a part of it. WAV: 1."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the table: .csv, .parquet.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a plot: .png, .svg, .pdf.")] = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Time the echo of each captured waveform, with uncertainty and cycle ambiguity."""
    check_outputs(
        Output("--out", out, _made_by.table("echo-times")),
        Output("--plot", plot, _made_by.picture("echo-times")),
        Output("--json", json, _made_by.result("echocal.echo_times")),
        inputs=[file, None if template in (None, "mean") else template],
        force=force,
    )
    refuse_picture(plot)
    _refuse_ending(out)
    from echocal.waveforms import echo_times, read_waveforms  # SciPy takes a second to import
    from echocal.waveforms.captures import positive

    if full_scale is not None:
        positive("full_scale", full_scale, "unit of the waveform")

    waveform, rate = read_waveforms(file, sample_rate, column=column)
    with counted_bar(quiet, "timing echoes") as tell:
        echoes = echo_times(
            waveform,
            rate,
            method,
            template=_template(template, rate),
            carrier=carrier,
            bandwidth=bandwidth,
            threshold=threshold,
            noise=noise,
            start=start_us * 1e-6,
            stop=None if stop_us is None else stop_us * 1e-6,
            progress=tell,
        )
    _write(file, echoes, full_scale, out, json)
    if plot is not None:
        from echocal.plots.draw import save_figure
        from echocal.plots.echo_times import echo_times_figure

        save_figure(echo_times_figure(echoes, waveform, rate), plot, "echo-times")
    if not quiet and json != "-":
        Console(highlight=False, soft_wrap=True).print(str(echoes), markup=False)


def _refuse_ending(out: Path | None) -> None:
    if out is not None and out.suffix.lower() not in (".csv", ".parquet"):
        raise UsageError(f"cannot write '{out.suffix}' ({out}); endings: .csv, .parquet")


def _template(given: str | None, rate: float) -> Any:
    """Samples of a file, at the rate of the captures; what is no file goes on as it is."""
    if given is None or given == "mean":
        return given
    from echocal.waveforms import read_waveforms

    samples, _ = read_waveforms(given, rate)
    return samples.reshape(-1) if samples.ndim and samples.size == samples.shape[-1] else samples


def _write(file: Path, echoes: Any, full_scale: float | None, out: Path | None, json: str | None) -> None:
    from echocal.report.echo_times import counted, echo_table
    from echocal.waveforms.reading import columns_beside, full_scale_of

    scale = full_scale_of(file) if full_scale is None else full_scale
    table = echo_table(echoes, columns_beside(file), scale)
    if out is not None:
        write_table(table, out)
    document = {
        "schema": "echocal.echo_times/1",
        "method": echoes.method,
        "carrier_Hz": echoes.carrier,
        "captures": {"total": echoes.time.size, "used": int(echoes.found.sum()), "unusable": counted(echoes)},
        "rows": echo_table(echoes, full_scale=scale).to_dict(orient="records"),
    }
    write_json(document, json)
