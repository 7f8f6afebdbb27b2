"""``echocal diagnose``: name what the base simulation gets wrong."""

from functools import partial
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from echocal.cli import _made_by, _several
from echocal.cli._brief import follow_up, print_brief, without_evidence
from echocal.cli._complete import bases
from echocal.cli._console import Console
from echocal.cli._options import from_stdin, stated
from echocal.cli._outputs import (
    Force,
    Output,
    PlotFormat,
    Quiet,
    Report,
    check_outputs,
    made_in,
    write_report,
    written,
)
from echocal.cli._ranges import parsed_ranges
from echocal.cli._tables import (
    AS_IT_IS,
    Given,
    Json,
    SpreadsheetSafe,
    noted,
    reading_options,
    reading_words,
    write_json,
)
from echocal.diagnose import Diagnosis, diagnose
from echocal.engines import ENGINES
from echocal.errors import DomainWarning, UsageError
from echocal.model import Model
from echocal.outputs import csv_text, replace_text
from echocal.report import print_diagnosis

Base: TypeAlias = Annotated[
    str,
    typer.Option(
        help="A law (linear: 331.4+0.6*T; ideal_gas, cramer, virial), a line of your own such as "
        "331.3+0.606*T, a speed in m/s, or a model file.",
        autocompletion=bases,
    ),
]
ReferenceDistance: TypeAlias = Annotated[
    float | None, typer.Option(metavar="M", help="Distance of the target in every row, in m.")
]
ConstantDistance: TypeAlias = Annotated[
    bool, typer.Option("--constant-distance", help="The target did not move; its distance is not known.")
]
Placements: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="M,M,...",
        help="Ruler values of the placements of a raw log, in their order: 0.5,1.2,2.5 (m).",
    ),
]
MattersMm: TypeAlias = Annotated[
    float | None,
    typer.Option(
        metavar="MM",
        help="The difference of a reading that matters to you. Effects that add less are told in one line. "
        "Default: by the steps of the readings, at least 0.3.",
    ),
]
Details: TypeAlias = Annotated[
    bool, typer.Option("--details", help="Print the evidence, the gain, every probability and note.")
]


@reading_options()
def command(
    data: Annotated[
        Path,
        typer.Argument(help="Table of echoes: CSV, TSV, Parquet; of a fleet also a folder or a pattern."),
    ],
    more: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[DATA ...]", help="Further tables, of this instrument or of others of its kind."
        ),
    ] = None,
    base: Base = "linear",
    reference_distance: ReferenceDistance = None,
    constant_distance: ConstantDistance = False,
    placements: Placements = None,
    matters_mm: MattersMm = None,
    reading: Given = AS_IT_IS,
    since: Annotated[str | None, typer.Option(metavar="TIME", help="Use rows from this time on.")] = None,
    until: Annotated[
        str | None, typer.Option(metavar="TIME", help="Use rows up to this time; a date means its whole day.")
    ] = None,
    hold_out_after: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Hold out the rows from this time on: ISO 8601, or seconds."),
    ] = None,
    save_model: Annotated[
        Path | None, typer.Option(metavar="OUT.json", help="Write the extended model.")
    ] = None,
    model: Annotated[Path | None, typer.Option(hidden=True)] = None,
    with_shape: Annotated[
        bool,
        typer.Option(
            "--with-shape",
            help="Add the unexplained term, a smooth function without a known cause, to the model.",
        ),
    ] = False,
    with_smooth: Annotated[
        bool,
        typer.Option(
            "--with-smooth",
            help="Add the smooth correction, functions of columns without a known cause, to the model.",
        ),
    ] = False,
    plots: Annotated[Path | None, typer.Option(metavar="DIR", help="Write plots.")] = None,
    plot_format: PlotFormat = "png",
    report: Report = None,
    rows: Annotated[
        Path | None,
        typer.Option(metavar="OUT.csv", help="Write of each row whether it is used, why not, and its error."),
    ] = None,
    can_vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=LOW:HIGH ...",
            help="What can be varied for the next measurements: distance=0.2:4 temperature=5:40 (m, degC).",
        ),
    ] = None,
    by: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Divide the rows into several tables by this column.")
    ] = None,
    models: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Of several tables: write shared.json and the model of each table. Of a fleet: the model of "
            "each sensor.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="A fleet: give each sensor a verdict of its own, and write them as .parquet or .csv.",
        ),
    ] = None,
    results: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Of a fleet: write the diagnosis of each sensor.")
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            metavar="COLUMN",
            help="Of a fleet: the kind of a sensor. Sensors of a kind share how common each cause is.",
        ),
    ] = None,
    memory: Annotated[
        str, typer.Option(metavar="SIZE", help="Of a fleet: memory for the rows that a process holds.")
    ] = "512MB",
    workers: Annotated[
        int | None, typer.Option(min=1, help="Of a fleet: processes; default: all processors.")
    ] = None,
    engine: Annotated[
        str | None,
        typer.Option(metavar="NAME", help=f"Of a fleet: who does the work: {', '.join(ENGINES)}."),
    ] = None,
    spreadsheet_safe: SpreadsheetSafe = False,
    details: Details = False,
    json: Json = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the gain's interval.")] = 0,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Name what the base simulation gets wrong, and measure what the extended model gains."""
    data = from_stdin(data)
    model = _renamed(save_model, model, quiet)
    tables, ranges = _several.told_apart(more)
    is_fleet = _several.is_fleet([data, *tables], output)
    _refuse_fleet_options(is_fleet)
    if is_fleet or tables or by is not None:
        alone = {
            "--save-model": model,
            "--with-shape": with_shape,
            "--with-smooth": with_smooth,
            "--rows": rows,
            "--can-vary": can_vary or ranges,
            "--placements": placements is not None,
            "--matters-mm": matters_mm is not None,
            "--details": details,
        }
        used = [*_file(base), *reading.files]
        request = {
            "reference_distance": reference_distance,
            "constant_distance": constant_distance,
            "since": since,
            "until": until,
            "seed": seed,
        }
        if is_fleet:
            _several.refuse_options(alone, is_fleet=True)
            _several.diagnose_sensors(
                [data, *tables],
                by,
                used,
                {**request, "base": base, "hold_out_after": _time(hold_out_after)},
                reading.given(),
                _several.Outputs(models, plots, json, plot_format, report, output, results),
                _several.How(kind, memory, workers, engine or "local", spreadsheet_safe),
                force=force,
                quiet=quiet,
            )
            return
        _several.refuse_options({**alone, "--hold-out-after": hold_out_after}, is_fleet=False)
        _several.diagnose_tables(
            [data, *tables],
            by,
            used,
            {**request, "base": base_of(base)},
            reading.given(),
            _several.Outputs(models, plots, json, plot_format, report),
            words=reading_words(reading),
            force=force,
            quiet=quiet,
        )
        return
    _refuse_alone(models, model, with_shape, with_smooth)
    check_outputs(
        Output("--save-model", model, _made_by.model("diagnose", data)),
        Output("--json", json, _made_by.result("echocal.diagnosis")),
        Output("--rows", rows, _made_by.table("diagnose")),
        Output("--report", report, _made_by.report("diagnose", data)),
        *_pictures(plots, plot_format),
        inputs=[data, *_file(base), *reading.files],
        folder=plots,
        force=force,
    )
    with _several.tables_bar(quiet) as bar, noted(quiet, DomainWarning):  # the notes repeat each DataWarning
        task = bar.add_task("reading", total=None)
        diagnosis = diagnose(
            data,
            base=base_of(base),
            reference_distance=reference_distance,
            constant_distance=constant_distance,
            placements=placements,
            since=since,
            until=until,
            hold_out_after=_time(hold_out_after),
            can_vary=_ranges(can_vary, ranges),
            matters_mm=matters_mm,
            seed=seed,
            progress=lambda what, done, total: bar.update(
                task, description=what, completed=done, total=total
            ),
            **reading.given(),
        )
    whole = diagnosis.model
    if with_shape or with_smooth:
        whole = diagnosis.model_with_shape if with_shape else diagnosis.model_with_smooth
    if model is not None:
        whole = _made_by.sign(whole, "diagnose", data, model)
    _write(diagnosis, whole, model, plots, plot_format)
    write_json(diagnosis.to_dict(), json)
    if report is not None:
        from echocal.report.html import report_page

        uses = {} if model is None else follow_up(diagnosis, data, model, reading_words(reading))
        page = partial(report_page, saved=model or "", commands=without_evidence(uses))
        write_report(report, page, diagnosis, data.name)
    if rows is not None:
        replace_text(rows, csv_text(diagnosis.row_table()), newline="")
    if not quiet and json != "-":
        console = Console(highlight=False)
        if details:
            print_diagnosis(diagnosis, Console())
        else:
            print_brief(diagnosis, console, written(), _after(diagnosis, data, model, reading), "--details")


def _renamed(model: Path | None, former: Path | None, quiet: bool) -> Path | None:
    """Take the option by its former name, with a word on it; other commands read a model with this name."""
    if former is None:
        return model
    if model is not None:
        raise UsageError("--model is the former name of --save-model: give one of them")
    if not quiet:
        Console(stderr=True).print("--model, where it writes, is now --save-model; later it will be refused")
    return former


def _refuse_alone(models: Path | None, model: Path | None, with_shape: bool, with_smooth: bool) -> None:
    """Raise `UsageError` for options that one table has no use for."""
    if models is not None:
        raise UsageError("--models writes models of several tables; for one table give --save-model OUT.json")
    if with_shape and model is None:
        raise UsageError("--with-shape adds a term to the saved model: give --save-model OUT.json, too")
    if with_smooth and model is None:
        raise UsageError("--with-smooth adds terms to the saved model: give --save-model OUT.json, too")
    if with_smooth and with_shape:
        raise UsageError("--with-shape and --with-smooth describe the same errors: give one of them")


def _file(base: str) -> list[str]:
    """The model file of a base, which is an input."""
    return [base] if base.endswith(".json") else []


def base_of(base: str) -> str | Model:
    """The model of a file, or the base as it is written."""
    return Model.load(base) if _file(base) else base


_OF_A_FLEET = ("results", "kind", "memory", "workers", "engine", "spreadsheet_safe")


def _refuse_fleet_options(is_fleet: bool) -> None:
    given = (name for name in _OF_A_FLEET if stated(name))
    if not is_fleet and (name := next(given, None)) is not None:
        raise UsageError(f"--{name.replace('_', '-')} is for a fleet: give -o FILE, or a folder of logs")


def _pictures(folder: Path | None, form: str) -> list[Output]:
    if folder is None:
        return []
    from echocal.plots.diagnosis import PICTURES  # matplotlib takes a second to import
    from echocal.plots.draw import in_form

    return made_in(folder, "--plots", in_form(PICTURES, form), _made_by.picture("diagnose"))


def _write(diagnosis: Diagnosis, whole: Model, model: Path | None, plots: Path | None, form: str) -> None:
    if plots is not None:  # first: it creates the folder, which may also receive the model
        from echocal.plots.diagnosis import save_diagnosis  # matplotlib takes a second to import

        save_diagnosis(diagnosis, plots, form)
    if model is not None:
        whole.save(model)


def _after(diagnosis: Diagnosis, data: Path, model: Path | None, reading: Given) -> str:
    """The command that uses the model, where there is one to use."""
    if diagnosis.verdict != "named" or not diagnosis.model.effects or diagnosis.good_enough:
        return ""
    if model is None:
        return "Add --save-model model.json, then run echocal correct."
    return next(iter(follow_up(diagnosis, data, model, reading_words(reading)).values()))


def _ranges(first: list[str] | None, more: list[str]) -> dict[str, tuple[float, float]] | None:
    """Ranges after ``--can-vary``, however many follow it."""
    if more and not first:
        raise UsageError(f"'{more[0]}' is neither a table nor a range of --can-vary: there is no such file")
    texts = [text for joined in (*(first or ()), *more) for text in joined.split()]
    return parsed_ranges(texts) or None


def _time(text: str | None) -> str | float | None:
    """Seconds where it is a number, else a time; a bare year is a time."""
    if text is None or len(text) == 4:
        return text
    try:
        return float(text)
    except ValueError:
        return text
