"""``echocal diagnose`` of several tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Output, check_outputs, made_in, write_report
from echocal.cli._tables import noted, write_json
from echocal.diagnose.pooling.engine import diagnose_many
from echocal.errors import DomainWarning, UsageError, writing
from echocal.model.folder import INDEX, index_text, named
from echocal.outputs import replace_text

__all__ = ["Outputs", "bar", "diagnose_tables", "refuse_options", "told_apart"]

_SHARED = "shared.json"
_INSTEAD = {
    "--save-model": "give --models DIR",
    "--with-shape": "an unexplained term belongs to its table: diagnose this table alone",
    "--with-smooth": "a smooth correction belongs to its table: diagnose this table alone",
    "--rows": "diagnose each table alone for its rows",
    "--hold-out-after": "the gain is measured on tables left out in turn; --until leaves out later rows",
    "--placements": 'give each table a column with its distances: --column "NAME=distance_m"',
    "--matters-mm": "diagnose one table to be told what matters",
    "--can-vary": "diagnose one table for its next measurements",
}


@dataclass(frozen=True)
class Outputs:
    """Where the results go."""

    models: Path | None
    plots: Path | None
    json: str | None
    plot_format: str = "png"
    report: Path | None = None


def told_apart(more: Sequence[str] | None) -> tuple[list[Path], list[str]]:
    """Further tables, and ranges that follow ``--can-vary``, which have an equals sign and are no files."""
    given = more or ()
    tables = [Path(text) for text in given if "=" not in text or Path(text).exists()]
    return tables, [text for text in given if Path(text) not in tables]


def refuse_options(given: Mapping[str, object]) -> None:
    """Raise `UsageError` for an option that is for one table only."""
    for option, value in given.items():
        if value:
            message = f"{option} is for one table, and several are given; {_INSTEAD[option]}"
            raise UsageError(message)


def diagnose_tables(
    tables: Sequence[Path],
    by: str | None,
    inputs: Sequence[str | None],
    request: Mapping[str, Any],
    reading: Mapping[str, Any],
    outputs: Outputs,
    *,
    force: bool,
    quiet: bool,
) -> None:
    """Diagnose several files, or the parts of one, and write and print the results."""
    from echocal.diagnose.pooling.source import sources_of
    from echocal.report.several import print_pooled

    if by is not None and len(tables) > 1:
        message = f"--by divides one table, and {len(tables)} are given; give one table, or leave --by out"
        raise UsageError(message)
    sources = sources_of(tables if by is None else tables[0], by, reading)
    origin = dict.fromkeys(sources.tables, tables[0])
    if by is None:
        origin = dict(zip(sources.tables, tables, strict=True))
    files = _model_files(list(sources.tables), outputs.models)
    check_outputs(
        *(Output("--models", file, _made_by.model("diagnose", origin[name])) for name, file in files.items()),
        *_shared(outputs.models, tables[0]),
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
    with bar(quiet) as shown, noted(quiet, DomainWarning):
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


def bar(quiet: bool) -> Progress:
    """Progress bar on a terminal; none in a log or a pipe."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console, transient=True, disable=quiet or not console.is_terminal)


def _model_files(names: Sequence[str], folder: Path | None) -> dict[str, Path]:
    """File of each table's model, as `echocal correct --models` looks for it."""
    if folder is None:
        return {}
    return {name: folder / file for name, file in named(names, [_SHARED]).items()}


def _shared(folder: Path | None, table: Path) -> list[Output]:
    index = made_in(folder, "--models", [INDEX], _made_by.sensor_model())
    return [*made_in(folder, "--models", [_SHARED], _made_by.model("diagnose", table)), *index]


def _pictures(folder: Path | None, form: str) -> list[Output]:
    if folder is None:
        return []
    from echocal.plots.draw import in_form
    from echocal.plots.several import POOLED_PICTURES  # matplotlib takes a second to import

    return made_in(folder, "--plots", in_form(POOLED_PICTURES, form), _made_by.picture("diagnose"))
