"""``echocal emulate``: a sketch on an emulated Arduino UNO, and the table that it logs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.markup import escape
from rich.table import Table

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._options import from_stdin
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, refuse_picture
from echocal.cli._progress import counted_bar
from echocal.cli._ranges import Distance, Humidity, Pressure, Temperature, given_ranges
from echocal.cli._tables import Columns, Json, column_requests, noted, notes, toml_files, write_json
from echocal.emulation import TRUTH, Emulation, emulate, error_parts
from echocal.errors import UsageError
from echocal.model import Model
from echocal.outputs import csv_text, replace_text


def command(
    data: Annotated[
        Path | None,
        typer.Argument(
            metavar="[TABLE]", help="Rows with temperature_C and echo_us or distance_m; instead of ranges."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="OUT.csv", help="Write the table.")
    ] = None,
    sketch: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE",
            help="study (default), interrupts_held, pulse_in_long, timer_capture, or a file .ino or .cpp.",
        ),
    ] = None,
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model, whose generated C runs instead of a sketch.")
    ] = None,
    temperature: Temperature = None,
    distance: Distance = None,
    relative_humidity: Humidity = None,
    pressure: Pressure = None,
    columns: Columns = None,
    part: Annotated[str, typer.Option(help="Thermometer at A0: tmp36, lm35 or potentiometer.")] = "tmp36",
    humidity: Annotated[
        bool, typer.Option("--humidity", help="The C of the model reads a HIH-4030 at A1.")
    ] = False,
    reference_voltage: Annotated[
        float, typer.Option(metavar="V", help="Reference of the converter [V]; the sketches suppose 5.")
    ] = 5.0,
    adc_bits: Annotated[
        int, typer.Option(metavar="N", help="Bits of the converter; this board has 10.")
    ] = 10,
    time_out_ms: Annotated[
        float | None,
        typer.Option(metavar="MS", help="Length of ECHO for a missed echo [ms], 38 for many; default: none."),
    ] = None,
    detector: Annotated[
        str, typer.Option(metavar="ideal|comparator", help="Times the echo: 2 d / c, or an HC-SR04's.")
    ] = "ideal",
    waveform: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Plot what a comparator sees: .png, .svg, .pdf.")
    ] = None,
    row: Annotated[int, typer.Option(min=1, help="Row of --waveform, from 1.")] = 1,
    seed: Annotated[
        int | None,
        typer.Option(metavar="N", help="Draw a real part: tolerance, noise and lag; default: an ideal one."),
    ] = None,
    trigger_pin: Annotated[int, typer.Option(metavar="N", help="Pin of TRIG; 14 is A0.")] = 7,
    echo_pin: Annotated[int, typer.Option(metavar="N", help="Pin of ECHO.")] = 8,
    library: Annotated[
        list[Path] | None, typer.Option(metavar="DIR", help="Arduino library that the sketch includes.")
    ] = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Run a sketch on an emulated Arduino UNO with an HC-SR04 and a thermometer."""
    _refuse(data, out, sketch, model, columns, library, json, waveform, force=force)
    ranges: dict[str, Any] = given_ranges(
        temperature=temperature, distance=distance, relative_humidity=relative_humidity, pressure=pressure
    )
    followed = None if model is None else Model.load(model)
    with noted(quiet), counted_bar(quiet, "measuring") as tell:
        found = emulate(
            followed or ("study" if sketch is None else sketch),
            None if data is None else from_stdin(data),
            **ranges,
            columns=column_requests(columns),
            part=part,
            humidity=humidity,
            reference_voltage=reference_voltage,
            adc_bits=adc_bits,
            time_out=None if time_out_ms is None else time_out_ms * 1e-3,
            detector=detector,
            seed=seed,
            trigger_pin=trigger_pin,
            echo_pin=echo_pin,
            libraries=library or (),
            progress=tell,
        )
    if out is not None:
        replace_text(out, csv_text(found.table))
    if waveform is not None:
        _plot(found, waveform, row, seed)
    parts = _parts(found, followed)
    write_json(_document(found, parts), json)
    if not quiet and json != "-":
        Console().print(_summary(found, parts))
        notes(_notes(found, out), quiet)


def _refuse(
    data: Path | None,
    out: Path | None,
    sketch: str | None,
    model: Path | None,
    columns: Sequence[str] | None,
    library: Sequence[Path] | None,
    json: str | None,
    waveform: Path | None,
    *,
    force: bool,
) -> None:
    """Refuse what cannot be, before anything is compiled."""
    refuse_picture(waveform)
    inputs = [data, model, sketch, *toml_files(columns), *(library or ())]
    check_outputs(
        Output("--out", out, _made_by.table("emulate")),
        Output("--waveform", waveform, _made_by.picture("emulate")),
        Output("--json", json, _made_by.result("echocal.emulation")),
        inputs=[path for path in inputs if path is not None and Path(path).exists()],
        force=force,
    )
    if out is not None and out.suffix.lower() != ".csv":
        raise UsageError(f"--out {out}: the table is written as .csv")
    if model is not None and sketch is not None:
        raise UsageError("give --sketch or --model, not both")


def _parts(found: Emulation, model: Model | None) -> dict[str, dict[str, float]]:
    """Return the figures of the parts of the error [m], for the C of a model where distances are known."""
    if model is None or found.inputs.distance is None:
        return {}
    parts = error_parts(found, model)
    return {str(name): _figures(parts[name].to_numpy()) for name in parts}


def _plot(found: Emulation, path: Path, row: int, seed: int | None) -> None:
    from echocal.plots.draw import save_figure
    from echocal.plots.waveform import waveform_figure
    from echocal.virtual_bench.echo_time import scene_of

    inputs = found.inputs
    if inputs.distance is None:
        raise UsageError("--waveform needs the distance of the target: the table has echo times only")
    scene = scene_of(inputs.distance, inputs.temperature, inputs.relative_humidity, inputs.pressure)
    save_figure(waveform_figure(scene, row=row, seed=seed or 0), path, "emulate")


def _document(found: Emulation, parts: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "schema": "echocal.emulation/1",
        "sketch": found.name,
        "board": "Arduino UNO (ATmega328P, 16 MHz), emulated",
        "board_seconds": found.played.seconds,
        "rows": len(found.table),
        "errors": {name: _figures(values) for name, values in found.errors().items()},
        "parts_of_error_m": dict(parts),
        "echo_bias": _bias(found),
        "table": {str(name): found.table[name].tolist() for name in found.table},
        "true_echo_us": (found.echo * 1e6).tolist(),
        "codes": {f"A{pin}": found.played.codes[:, pin].tolist() for pin in range(2)},
    }


def _figures(values: Any) -> dict[str, float]:
    usable = values[np.isfinite(values)]
    if not usable.size:
        return {"rows": 0}
    rms = float(np.sqrt((usable**2).mean()))
    return {"rows": int(usable.size), "mean": float(usable.mean()), "rms": rms}


def _bias(found: Emulation) -> float | None:
    """Return by which share the measured echo times are too long, over the rows that have one."""
    error = found.errors().get("echo_us")
    heard = None if error is None else np.isfinite(error) & (found.table["echo_us"].to_numpy() > 0.0)
    if error is None or heard is None or not heard.any():
        return None
    return float(error[heard].sum() / (found.echo[heard] * 1e6).sum())


_SHOWN = {
    "echo_us": ("echo time", 1.0, "us"),
    "temperature_C": ("temperature", 1.0, "degC"),
    "reading_m": ("reading", 1e3, "mm"),
}
"""Names, factors and units of what a sketch measures."""


def _summary(found: Emulation, parts: Mapping[str, dict[str, float]]) -> Table:
    title = f"{escape(Path(found.name).name)}: {len(found.table)} rows"
    table = Table("measured less true", "rows", "mean", "RMS", "unit", title=title)
    errors = found.errors()
    lines = [(*_SHOWN[name], _figures(errors[name])) for name in _SHOWN if name in errors]
    lines += [(f"  of it {name}", 1e3, "mm", figures) for name, figures in parts.items()]
    for what, factor, unit, figures in lines:
        if figures["rows"]:
            numbers = (f"{figures['mean'] * factor:+.2f}", f"{figures['rms'] * factor:.2f}")
            table.add_row(what, str(figures["rows"]), *numbers, unit)
    return table


def _notes(found: Emulation, out: Path | None) -> Sequence[str]:
    texts = [f"{found.played.seconds:.1f} s passed on the emulated board"]
    bias = _bias(found)
    if bias is not None:
        texts.append(f"the echo times are {100 * abs(bias):.3f} % too {'long' if bias > 0 else 'short'}")
    silent = int(np.isnan(found.echo).sum())
    if silent:
        texts.append(f"{silent} rows have no echo")
    if out is not None:
        texts.append(f"{TRUTH} is the truth; to keep it from a diagnosis: --column {TRUTH}=ignore")
    return texts
