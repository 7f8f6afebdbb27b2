"""``echocal firmware``: integer C from a model, proven over every input."""

import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import TaskProgressColumn, TimeElapsedColumn

from echocal import silicon
from echocal.checksums import CHECKSUMS, listed, unedited
from echocal.cli import _explore, _made_by, _per_unit
from echocal.cli._codes import humidity_codes, thermometer
from echocal.cli._complete import targets
from echocal.cli._console import Console
from echocal.cli._firmware_made import made_by, summary
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, made_in, pass_on
from echocal.cli._progress import bar
from echocal.cli._tables import Json
from echocal.echoes import BLANKING_M
from echocal.errors import DomainWarning, UsageError
from echocal.firmware import EchoCodes, Firmware
from echocal.model import Model
from echocal.outputs import replace_text
from echocal.pages.considered import considered
from echocal.per_unit import UnitFirmware
from echocal.sensors import sensor_of

Tell = Callable[[str, int, int], object]


def option(description: str, *names: str, metavar: str | None = None) -> Any:
    """Return an option with its help."""
    return typer.Option(*names, help=description, metavar=metavar)


def command(
    out: Annotated[Path, option("Folder for the generated files; file or folder for blocks.", "-o", "--out")],
    model: Annotated[
        Path | None, typer.Argument(help="Model file, such as diagnose writes.", metavar="MODEL.json")
    ] = None,
    target: Annotated[
        str,
        typer.Option(
            help="Core: avr, cortex-m0, -m3, -m4, -m4f, -m7, rv32, rv32e, esp32, rp2040, msp430 or c99.",
            autocompletion=targets,
        ),
    ] = "c99",
    sensor: Annotated[
        str | None, option("Known sensor, such as SHT31: its published codes are the default.")
    ] = None,
    ntc: Annotated[
        str | None,
        option(
            "Thermistor on a converter: divider=OHM,beta=K,r25=OHM,bits=10,side=ground",
            metavar="KEY=VALUE,...",
        ),
    ] = None,
    temperature_lsb: Annotated[
        float | None, option("Step of one temperature code [degC]; default: 0.0625.")
    ] = None,
    temperature_range: Annotated[
        str | None, option("Accepted temperatures, LOW:HIGH [degC]; default: -20:60.")
    ] = None,
    temperature_zero: Annotated[float | None, option("Temperature of code 0 [degC]; default: 0.")] = None,
    temperature_shift: Annotated[
        int | None, option("Lowest bits of the temperature code that the function drops.")
    ] = None,
    humidity_lsb: Annotated[
        float | None, option("Step of one humidity code [1], if the device measures humidity.")
    ] = None,
    humidity_range: Annotated[
        str | None, option("Accepted relative humidities, LOW:HIGH [1]; default: 0:1.")
    ] = None,
    humidity_zero: Annotated[float | None, option("Relative humidity of code 0 [1]; default: 0.")] = None,
    humidity_shift: Annotated[
        int | None, option("Lowest bits of the humidity code that the function drops.")
    ] = None,
    further: Annotated[
        str | None,
        option(
            "Codes of one further input: supply_voltage=4.5:5.5:0.01, wind_speed=..., angle=...",
            metavar="QUANTITY=LOW:HIGH:LSB",
        ),
    ] = None,
    lsb: Annotated[float, option("Tick of the timer [us].", "--echo-lsb-us")] = 1.0,
    shortest: Annotated[
        float | None,
        option(
            f"Shortest accepted echo time [us]; default: the echo from {BLANKING_M * 1e3:g} mm.",
            "--echo-min-us",
        ),
    ] = None,
    longest: Annotated[
        float | None,
        option("Longest accepted echo time [us]; default: the echo from --max-distance-m.", "--echo-max-us"),
    ] = None,
    bits: Annotated[int, option("Bits of the timer: 16, or 32 for a uint32_t.", "--echo-bits")] = 16,
    output_unit: Annotated[
        str, option("Unit of the output: um, 0.1mm, mm, cm, 0.01in, in, Q16.16 and more.")
    ] = "um",
    output_type: Annotated[str | None, option("Type of the output: int32 (default) or int16.")] = None,
    max_error_mm: Annotated[float, option("Largest error against the model [mm].")] = 0.5,
    max_distance: Annotated[
        float, option("Largest distance to which --max-error-mm applies [m].", "--max-distance-m")
    ] = 4.0,
    prefer: Annotated[str | None, option("What to save: size (default) or speed.")] = None,
    form: Annotated[str | None, option("The only form to try.")] = None,
    accept: Annotated[
        list[str] | None,
        option("Effect that may be left out, although it changes the distance.", metavar="EFFECT"),
    ] = None,
    assume: Annotated[
        list[str] | None,
        option("Value of a condition that the device does not measure.", metavar="NAME=VALUE"),
    ] = None,
    max_table_bytes: Annotated[int, option("Largest size of all tables together [byte].")] = 1024,
    median: Annotated[
        int | None,
        option("Write a median filter beside the function, of the last 3, 5 or 7 distances.", metavar="N"),
    ] = None,
    gate_mm: Annotated[
        float | None,
        option("Largest distance from the median at which a distance supports it [mm]."),
    ] = None,
    max_bits: Annotated[int, option("Widest integer to compute with: 64, or 32.")] = 64,
    package: Annotated[
        str,
        option("Kind of files: c, arduino, platformio, esphome, micropython, esp-idf, zephyr or rust."),
    ] = "c",
    name: Annotated[
        str, option("Start of the names of files, functions and macros. Two sensors need two.")
    ] = "echocal",
    uncertainties: Annotated[
        list[str] | None,
        option(
            "Standard uncertainty of a value: temperature_C=0.5, ...", "--uncertainty", metavar="NAME=VALUE"
        ),
    ] = None,
    per_unit: Annotated[
        list[str] | None,
        option(
            "Effect whose parameter each unit has of its own: fixed_delay, clock_error.",
            metavar="EFFECT[=LOW:HIGH]",
        ),
    ] = None,
    lag_interval: Annotated[
        float | None,
        option(
            "Follow the model's temperature_lag: time between two temperature codes [s].", "--lag-interval-s"
        ),
    ] = None,
    lag_smoothing: Annotated[
        float | None,
        option(
            "Time constant that is left [s]; default: a fourth of the thermometer's.", "--lag-smoothing-s"
        ),
    ] = None,
    unit_data: Annotated[
        Path | None, option("Write the block of this unit instead.", metavar="UNIT.json")
    ] = None,
    unit_number: Annotated[
        int | None, option("Number of that unit; default: from the name of its file.")
    ] = None,
    units: Annotated[
        Path | None, option("Write a block for each model in this folder instead.", metavar="DIR")
    ] = None,
    measure: Annotated[
        bool, option("Compile, run in a simulator, state flash and time.", "--measure")
    ] = False,
    explore: Annotated[
        bool, option("Write the Pareto front of flash, time and error instead.", "--explore")
    ] = False,
    page: Annotated[
        Path | None,
        option("Write a page: proof, costs, forms considered.", "--report", metavar="OUT.html"),
    ] = None,
    threads: Annotated[int | None, option("Threads of the proof; default: one per processor.")] = None,
    force: Force = False,
    json: Json = None,
    quiet: Quiet = False,
) -> None:
    """Turn a model into C that is proven over every input."""
    console = Console(stderr=True, quiet=quiet)
    if unit_data is not None or units is not None:
        asked = _per_unit.Blocks(unit_data, units, unit_number, model, per_unit or ())
        _per_unit.run(asked, out, json, console, force=force, quiet=quiet)
        return
    if model is None:
        raise UsageError("firmware needs a model: give MODEL.json")
    if explore:
        filtered = median is not None or gate_mm is not None
        single = bool(measure or uncertainties or per_unit or filtered or lag_interval or lag_smoothing)
        _refuse_one(prefer, form, single, package, name, page)
    _refuse_outputs(model, json, out, _explore.FILES if explore else listed(out), page, force=force)
    known = None if sensor is None else sensor_of(sensor)
    request: dict[str, Any] = {
        "temperature": thermometer(
            ntc, known, temperature_lsb, temperature_range, temperature_zero, temperature_shift
        ),
        "humidity": humidity_codes(known, humidity_lsb, humidity_range, humidity_zero, humidity_shift),
        "further": further,
        "echo": EchoCodes(lsb, longest, shortest, bits),
        "output_unit": output_unit,
        "output_type": output_type,
        "max_error": max_error_mm * 1e-3,
        "max_distance": max_distance,
        "accept": accept or (),
        "assume": dict(_assignment(text) for text in assume or ()),
        "max_table_bytes": max_table_bytes,
        "max_bits": max_bits,
        "n_threads": threads,
        "model_name": model.name,
    }
    followed = Model.load(model)
    codes = [f"codes of {sensor}: {known.note}"] if known and known.note else []
    with _watched(quiet) as (tell, notes):
        if explore:
            text, table = _explore.run(followed, target, out, tell, **request)
        else:
            one: dict[str, Any] = {"form": form, "package": package, "name": name, "measure": measure}
            one["uncertainties"] = uncertainties or ()
            one["median"], one["gate"] = median, None if gate_mm is None else gate_mm * 1e-3
            saved = prefer or "size"
            one["prefer"] = saved
            one["progress"] = lambda form, checked, total: tell(f"proving: {form}", checked, total)
            one |= request
            made = made_by(followed, target, per_unit, (lag_interval, lag_smoothing), one)
            if isinstance(made, UnitFirmware):
                followed = made.box.least(followed)  # the model of the function that is on the page
            if page is not None:
                forms = considered(followed, target, prefer=saved, progress=tell, **request)
    notes += codes
    if explore:
        pass_on(text, json)
        _explore.show(console, table, notes, out)
        return
    _refuse_outputs(model, json, out, [*made.files, CHECKSUMS], page, force=force)
    files = made.save(out)
    if page is not None:
        from echocal.pages.firmware import firmware_page

        replace_text(page, firmware_page(made, followed, forms, request["assume"]))
        files.append(page)
    pass_on(made.files["report.json"], json)
    notes += [*_left_over(out, made), *(_unmeasured(target) if measure else ())]
    console.print(summary(made, files, notes))


def _refuse_one(
    prefer: str | None, form: str | None, measure: bool, package: str, name: str, page: Path | None
) -> None:
    """Refuse options of a single function together with --explore."""
    if prefer or form or measure or package != "c" or name != "echocal" or page is not None:
        raise UsageError(
            "--explore tries every form, for size and for speed, and writes no package: leave out --prefer, "
            "--form, --measure, --uncertainty, --per-unit, --median, --gate-mm, --lag-interval-s, "
            "--lag-smoothing-s, --package, --name and --report"
        )


@contextmanager
def _watched(quiet: bool) -> Iterator[tuple[Tell, list[str]]]:
    """Show a progress bar, and collect each warning once in the list."""
    notes: list[str] = []
    columns = TaskProgressColumn(), TimeElapsedColumn()
    with warnings.catch_warnings(record=True) as warned, bar(quiet, *columns) as progress:
        warnings.simplefilter("always", DomainWarning)
        task = progress.add_task("designing", total=None)

        def tell(what: str, done: int, total: int) -> None:
            progress.update(task, description=what, completed=done, total=total)

        yield tell, notes
    notes += dict.fromkeys(str(warning.message) for warning in warned)


def _unmeasured(target: str) -> list[str]:
    if not silicon.cores_of(target):
        return [f"not measured: no simulator of {target} is known to this version"]
    absent = {core: silicon.missing(core) for core in silicon.cores_of(target)}
    return [f"not measured on {core}: no {', '.join(tools)}" for core, tools in absent.items() if tools]


def _left_over(out: Path, made: Firmware) -> list[str]:
    names = [name for name in unedited(out) if name not in made.files]
    return [f"also in {out}, generated by an earlier run: {', '.join(names)}"] if names else []


def _refuse_outputs(
    model: Path, json: str | None, out: Path, names: Iterable[str], page: Path | None, *, force: bool
) -> None:
    check_outputs(
        Output("--json", json, _made_by.result("echocal.firmware", _explore.SCHEMA.rpartition("/")[0])),
        Output("--report", page, _made_by.report("firmware")),
        *made_in(out, "--out", names, _made_by.firmware(out)),
        inputs=[model],
        folder=out,
        force=force,
        told=True,
    )


def _assignment(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise UsageError(
            f"--assume is '{text}': give NAME=VALUE, such as --assume relative_humidity=0.5"
        ) from None
