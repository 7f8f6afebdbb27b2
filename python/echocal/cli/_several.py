"""``echocal diagnose`` of several tables, and of a fleet, in which every sensor has a verdict of its own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Output, check_outputs, made_in, write_report
from echocal.cli._progress import bar
from echocal.cli._tables import noted, write_json
from echocal.correct.batch import in_bytes
from echocal.correct.inputs import find_inputs
from echocal.diagnose.pooling.engine import diagnose_many
from echocal.errors import DataError, DomainWarning, UsageError, writing
from echocal.keywords import command_line
from echocal.model.folder import INDEX, index_text, named
from echocal.outputs import replace_text

_SHARED = "shared.json"
_INSTEAD = {
    "--with-shape": "an unexplained term belongs to its table: diagnose {one} alone",
    "--with-smooth": "a smooth correction belongs to its table: diagnose {one} alone",
    "--details": "diagnose one table alone for its evidence",
}
_OF_A_FLEET = {
    **{option: text.format(one="this sensor") for option, text in _INSTEAD.items()},
    "--save-model": "give --models DIR, one file for each sensor",
    "--rows": "diagnose a sensor alone for its rows",
    "--placements": 'give the log a column with the distances: --column "NAME=distance_m"',
    "--matters-mm": "diagnose a sensor alone to be told what matters",
    "--can-vary": "diagnose a sensor alone for its next measurements",
}
_OF_TABLES = {
    **{option: text.format(one="this table") for option, text in _INSTEAD.items()},
    "--save-model": "give --models DIR",
    "--rows": "diagnose each table alone for its rows",
    "--hold-out-after": "the gain is measured on tables left out in turn; --until leaves out later rows",
    "--placements": 'give each table a column with its distances: --column "NAME=distance_m"',
    "--matters-mm": "diagnose one table to be told what matters",
    "--can-vary": "diagnose one table for its next measurements",
}


@dataclass(frozen=True)
class Outputs:
    """Where the results go; `table` and `results` are of a fleet."""

    models: Path | None
    plots: Path | None
    json: str | None
    plot_format: str = "png"
    report: Path | None = None
    table: Path | None = None
    results: Path | None = None


@dataclass(frozen=True)
class How:
    """How a fleet is divided and computed."""

    kind: str | None
    memory: str
    workers: int | None
    engine: str
    spreadsheet_safe: bool = False


def is_fleet(inputs: Sequence[Path], table: Path | None) -> bool:
    """Whether each sensor is to have a verdict of its own."""
    if table is not None:
        return True
    return any(not find_inputs(path).single for path in inputs)


def told_apart(more: Sequence[str] | None) -> tuple[list[Path], list[str]]:
    """Further tables, and ranges that follow ``--can-vary``, which have an equals sign and are no files."""
    given = more or ()
    tables = [Path(text) for text in given if "=" not in text or Path(text).exists()]
    return tables, [text for text in given if Path(text) not in tables]


def refuse_options(given: Mapping[str, object], *, is_fleet: bool) -> None:
    """Raise `UsageError` for an option that is for one table only."""
    there, instead = ("this is a fleet", _OF_A_FLEET) if is_fleet else ("several are given", _OF_TABLES)
    for option, value in given.items():
        if value:
            raise UsageError(f"{option} is for one table, and {there}; {instead[option]}")


def diagnose_sensors(
    inputs: Sequence[Path],
    by: str | None,
    used: Sequence[str | None],
    request: Mapping[str, Any],
    reading: Mapping[str, Any],
    outputs: Outputs,
    how: How,
    *,
    force: bool,
    quiet: bool,
) -> None:
    """Diagnose each sensor, and write and print the verdicts.

    Raises `DataError` if a sensor cannot be diagnosed; everything is written then.
    """
    from echocal.fleet import diagnose_fleet
    from echocal.report.several import print_fleet

    _check(inputs, used, outputs, force)
    columns = (MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn())
    with bar(quiet, *columns) as shown:
        task = shown.add_task("sensors", total=None, rate="")
        start: dict[str, float] = {}

        def progress(done: int, total: int, earlier: int) -> None:
            shown.update(task, completed=done, total=total)
            elapsed = shown.get_time() - start.setdefault("begun", shown.get_time())
            rate = f"{(done - earlier) / elapsed:.1f}/s" if elapsed > 0 else ""
            shown.update(task, rate=rate)

        fleet = diagnose_fleet(
            inputs,
            by,
            out=outputs.table,
            models=outputs.models,
            results=outputs.results,
            kind=how.kind,
            reading=reading,
            workers=how.workers,
            engine=how.engine,
            memory=in_bytes(how.memory),
            spreadsheet_safe=how.spreadsheet_safe,
            force=force,
            progress=progress,
            **request,
        )
    if outputs.plots is not None:
        from echocal.plots.several import save_fleet  # matplotlib takes a second to import

        save_fleet(fleet.summary, outputs.plots, outputs.plot_format)
    if outputs.report is not None:
        from echocal.report.html.several import fleet_page

        write_report(outputs.report, fleet_page, fleet.summary, inputs[0].name)
    write_json(fleet.summary, outputs.json)
    if not quiet and outputs.json != "-":
        print_fleet(fleet.summary, Console())
    if fleet.failed:
        first = next(row for row in fleet.rows if row["verdict"] == "failed")
        raise DataError(
            f"{fleet.failed} of {len(fleet.rows)} sensors could not be diagnosed, the others were; "
            f"the first: {first['sensor']}: {first['reason']}"
        )


def _check(inputs: Sequence[Path], used: Sequence[str | None], outputs: Outputs, force: bool) -> None:
    if outputs.table is not None and outputs.table.suffix.lower() not in {".parquet", ".csv"}:
        raise UsageError(f"--output {outputs.table} must end in .parquet or .csv")
    every = [*inputs, *used]
    check_outputs(
        Output("--output", outputs.table, _made_by.verdicts()),
        Output("--json", outputs.json, _made_by.result("echocal.fleet")),
        Output("--report", outputs.report, _made_by.report("diagnose")),
        inputs=every,
        force=force,
    )
    for option, folder, recognize in (
        ("--models", outputs.models, _made_by.sensor_model()),
        ("--results", outputs.results, _made_by.result("echocal.diagnosis")),
    ):
        there = [] if folder is None or not folder.is_dir() else [file.name for file in folder.glob("*.json")]
        check_outputs(*made_in(folder, option, there, recognize), inputs=every, folder=folder, force=force)
    if outputs.plots is not None:
        from echocal.plots.draw import in_form
        from echocal.plots.several import PICTURES

        names = in_form(PICTURES, outputs.plot_format)
        pictures = made_in(outputs.plots, "--plots", names, _made_by.picture("diagnose"))
        check_outputs(*pictures, inputs=every, folder=outputs.plots, force=force)


def diagnose_tables(
    tables: Sequence[Path],
    by: str | None,
    inputs: Sequence[str | None],
    request: Mapping[str, Any],
    reading: Mapping[str, Any],
    outputs: Outputs,
    *,
    words: Mapping[str, Any],
    force: bool,
    quiet: bool,
) -> None:
    """Diagnose several files, or the parts of one, and write and print the results."""
    from echocal.diagnose.pooling.source import sources_of
    from echocal.report.several import print_pooled

    if by is not None and len(tables) > 1:
        raise UsageError(
            f"--by divides one table, and {len(tables)} are given; give one table, or leave --by out"
        )
    sources = sources_of(tables if by is None else tables[0], by, reading)
    origin = dict.fromkeys(sources.tables, tables[0])
    if by is None:
        origin = dict(zip(sources.tables, tables, strict=True))
    # as `echocal correct --models` looks for it
    folder, names = outputs.models, named(list(sources.tables), [_SHARED])
    files = {} if folder is None else {name: folder / file for name, file in names.items()}
    check_outputs(
        *(Output("--models", file, _made_by.model("diagnose", origin[name])) for name, file in files.items()),
        *made_in(outputs.models, "--models", [_SHARED], _made_by.model("diagnose", tables[0])),
        *made_in(outputs.models, "--models", [INDEX], _made_by.sensor_model()),
        Output("--json", outputs.json, _made_by.result("echocal.pooled_diagnosis", "echocal.diagnosis")),
        Output("--report", outputs.report, _made_by.report("diagnose")),
        inputs=[*tables, *inputs],
        folder=outputs.models,
        force=force,
    )
    check_outputs(
        *_pictures(outputs.plots, outputs.plot_format),
        inputs=[*tables, *inputs],
        folder=outputs.plots,
        force=force,
    )
    if outputs.models is not None:
        with writing(outputs.models):
            outputs.models.mkdir(parents=True, exist_ok=True)
    with tables_bar(quiet) as shown, noted(quiet, DomainWarning):
        task = shown.add_task("reading", total=None)
        pooled = diagnose_many(
            sources,
            progress=lambda name, done, total: shown.update(
                task, description=name, completed=done, total=total
            ),
            **request,
        )
    if outputs.models is not None:
        shared = outputs.models / _SHARED
        _made_by.sign(pooled.model, "diagnose", tables[0], shared).save(shared)
        for name, model in pooled.models.items():
            _made_by.sign(model, "diagnose", origin[name], files[name]).save(files[name])
        replace_text(outputs.models / INDEX, index_text({name: files[name].name for name in pooled.models}))
    if outputs.plots is not None:
        from echocal.plots.several import save_pooled  # matplotlib takes a second to import

        save_pooled(pooled, outputs.plots, outputs.plot_format)
    if outputs.report is not None:
        from echocal.report.html.several import pooled_page

        write_report(outputs.report, pooled_page, pooled, ", ".join(file.name for file in tables))
    write_json(pooled.to_dict(), outputs.json)
    if not quiet and outputs.json != "-":
        print_pooled(pooled, Console())
        if by is not None and outputs.models is not None and pooled.models:
            out = tables[0].with_name(f"{tables[0].stem}-corrected{'' if ',' in by else '.csv'}")
            words = {**words, "by": by, "models": outputs.models, "out": out}
            Console(soft_wrap=True).print(command_line("correct", tables[0], **words), markup=False)


def tables_bar(quiet: bool) -> Progress:
    """Progress bar with the number done and the time that it took."""
    return bar(quiet, MofNCompleteColumn(), TimeElapsedColumn())


def _pictures(folder: Path | None, form: str) -> list[Output]:
    if folder is None:
        return []
    from echocal.plots.draw import in_form
    from echocal.plots.several import POOLED_PICTURES  # matplotlib takes a second to import

    return made_in(folder, "--plots", in_form(POOLED_PICTURES, form), _made_by.picture("diagnose"))
