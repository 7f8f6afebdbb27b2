"""``echocal inspect``: what a log holds, and how to read it."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._options import from_stdin, toml_value, written_by_us
from echocal.cli._outputs import Force, Output, Quiet, Report, check_outputs, write_report
from echocal.cli._tables import AS_IT_IS, Given, Json, SpreadsheetSafe, notes, reading_options, write_json
from echocal.errors import UsageError
from echocal.observations.inspection import ColumnFacts, Inspection, inspect_log
from echocal.outputs import csv_text, replace_text, spreadsheet_safe

_BARS = "▁▂▃▄▅▆▇█"


@reading_options()
def command(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="A log of any kind (docs/logs.md); - is stdin.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE.toml", help="Write how to read the log, for --options."),
    ] = None,
    write: Annotated[
        Path | None,
        typer.Option(metavar="TABLE.csv", help="Write the log as a table whose names have echocal's units."),
    ] = None,
    reading: Given = AS_IT_IS,
    spreadsheet_safe: SpreadsheetSafe = False,
    report: Report = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Tell what each column holds and why, what is missing, how the clock runs; change nothing."""
    check_outputs(
        Output("--out", out, written_by_us),
        Output("--write", write, written_by_us),
        Output("--json", json, _made_by.result("echocal.inspection")),
        Output("--report", report, _made_by.report("inspect")),
        inputs=[log, *reading.files],
        force=force,
    )
    if write is not None and write.suffix.lower() != ".csv":
        raise UsageError(f"--write {write} must end in .csv")
    name = log
    found = inspect_log(from_stdin(log), reading)
    stated = {name: value for name, value in reading.given().items() if name not in {"columns", "missing"}}
    if reading.at:
        stated["at"] = [f"{name}={value}" for name, value in reading.at.items()]
    if out is not None:
        replace_text(out, _toml(found, name, out, stated))
    if write is not None:
        _write(found, write, safe=spreadsheet_safe)
    if report is not None:
        from echocal.report.html.results import inspection_page

        write_report(report, inspection_page, found, name.name)
    write_json(found.to_dict(), json)
    notes(found.notes, quiet)
    if not quiet and json != "-":
        _print(found, name, out)


def _print(found: Inspection, name: Path, out: Path | None) -> None:
    console = Console(highlight=False)
    console.print(f"{name}: {found.kind}, {found.rows} rows, {len(found.columns)} columns", markup=False)
    table = Table("column")
    table.add_column("holds", no_wrap=True)
    for heading in ("because", "missing", "values"):
        table.add_column(heading)
    table.add_column("", no_wrap=True)
    for column in found.columns:
        proposal = column.proposal
        holds = proposal.request or "extra"
        missing = f"{column.missing} of {found.rows}" if column.missing else ""
        if column.codes:
            missing += f" code {', '.join(f'{code:g}' for code in column.codes)}?"
        because = f"a guess: {proposal.reason}" if proposal.guess else proposal.reason
        table.add_row(
            _plain(column.name), _plain(holds), because, missing, _plain(_values(column)),
            _histogram(column.histogram),
            style="yellow" if proposal.guess else "",
        )  # fmt: skip
    console.print(table)
    if found.clock is not None:
        clock = found.clock
        console.print(
            f"clock: {clock.first} to {clock.last}, a row each {clock.usual_step_s:g} s", markup=False
        )
        kinds = {"gaps": clock.gaps, "steps back": clock.backwards, "equal times": clock.equal}
        odd = ", ".join(f"{count} {kind}" for kind, count in kinds.items() if count)
        if odd:
            console.print(f"       {odd}: {'; '.join(clock.shown) or 'of neighboring rows'}", markup=False)
    for column_name, count in found.sensors.items():
        console.print(f'sensors: {count} in "{column_name}"; each alone: --by "{column_name}"', markup=False)
    if found.refusal:
        console.print(f"not readable as it is: {found.refusal}", markup=False, style="red", soft_wrap=True)
    else:
        console.print(f"{found.usable} of {found.rows} rows can be used", markup=False)
    if out is not None:
        console.print(f"next: echocal diagnose {name} --options {out}", markup=False)
    elif any(column.proposal.guess for column in found.columns):
        console.print(
            "accept the guesses, or edit them: echocal inspect ... -o log.toml, then --options log.toml"
        )


def _plain(text: str) -> str:
    return text.replace("[", "\\[")


def _values(column: ColumnFacts) -> str:
    if column.median is None:
        return ", ".join(column.examples)
    return f"{column.least:.4g} .. {column.median:.4g} .. {column.most:.4g} {column.unit}".rstrip()


def _histogram(counts: list[int]) -> str:
    most = max(counts, default=0)
    return "".join(" " if not n else _BARS[min(7, (8 * n - 1) // most)] for n in counts)


def _toml(found: Inspection, log: Path, out: Path, stated: dict[str, object]) -> str:
    """Options of the log; guesses have a remark."""
    lines = [
        f"# how to read {log}, written by echocal inspect; edit it, then: "
        f"echocal diagnose {log} --options {out}"
    ]
    lines += [f"{name.replace('_', '-')} = {toml_value(value)}" for name, value in stated.items()]
    lines += ["# constant-distance = true  # if the target did not move"]
    lines += [f"# by = {toml_value(name)}  # {count} sensors" for name, count in found.sensors.items()]
    reasons = {column.name: column.proposal for column in found.columns}
    lines += ["", "[column]"]
    for name, request in found.requests.items():
        guess = "a guess: " if reasons[name].guess else ""
        lines.append(f"{toml_value(name)} = {toml_value(request)}  # {guess}{reasons[name].reason}")
    if found.missing:
        lines += ["", "[missing]"]
        lines += [f"{toml_value(name)} = {toml_value(codes)}" for name, codes in found.missing.items()]
    return "\n".join(lines) + "\n"


def _write(found: Inspection, path: Path, *, safe: bool) -> None:
    """The table, with the proposals as names."""
    used = {column.name: column.proposal.request for column in found.columns}
    names = {
        name: request for name, request in used.items() if (request and "_" in request) or request == "time"
    }
    ignored = [name for name, request in used.items() if request == "ignore"]
    table = found.table.drop(columns=ignored).rename(columns=names)
    if safe:
        table = table.rename(columns=spreadsheet_safe)
        table = table.map(lambda value: spreadsheet_safe(value) if isinstance(value, str) else value)
    replace_text(path, csv_text(table), newline="")
