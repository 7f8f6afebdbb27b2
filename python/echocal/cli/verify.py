"""``echocal verify``: within the maximum permissible error, or not."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from echocal.cli import _made_by
from echocal.cli._complete import laws
from echocal.cli._console import Console
from echocal.cli._models import Uncertain, end, read_for
from echocal.cli._options import from_stdin
from echocal.cli._outputs import Force, Output, Quiet, Report, check_outputs, write_report
from echocal.cli._tables import AS_IT_IS, Given, Json, noted, read, reading_options, write_json
from echocal.diagnose.findings.sentences import quantity_text
from echocal.errors import UsageError
from echocal.model import Model
from echocal.report.budget import probability_text
from echocal.sweep import parse
from echocal.verify import Verification, verify, verify_model


@reading_options()
def command(
    subject: Annotated[
        Path, typer.Argument(metavar="MODEL|DATA", help="Model file (.json), or table with references.")
    ],
    maximum_permissible_error_mm: Annotated[
        float, typer.Option(metavar="MM", help="Maximum permissible error [mm].")
    ],
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Correct the table with this model first.")
    ] = None,
    law: Annotated[
        str, typer.Option(help="Law that converts echo times to indications.", autocompletion=laws)
    ] = "linear",
    uncertainties: Uncertain = None,
    temperature: Annotated[
        str, typer.Option(metavar="RANGE", help="For a model: temperatures [degC].")
    ] = "0:50:1",
    distance: Annotated[str, typer.Option(metavar="RANGE", help="For a model: distances [m].")] = "0.1:4:0.1",
    reading: Given = AS_IT_IS,
    report: Report = None,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Compare errors of indication with a maximum permissible error; exit code 1 if one does not conform.

    Where an uncertainty is known, each error keeps a guard band of its expanded uncertainty. Exit code 5:
    undecided.
    """
    subject = from_stdin(subject)
    check_outputs(
        Output("--json", json, _made_by.result("echocal.verification")),
        Output("--report", report, _made_by.report("verify", subject)),
        inputs=[subject, model, *reading.files],
        force=force,
    )
    bound = maximum_permissible_error_mm * 1e-3
    if not bound > 0.0:
        raise UsageError(f"the maximum permissible error must be a positive length [mm], got {1e3 * bound:g}")
    with noted(quiet):
        if subject.suffix == ".json":
            if uncertainties:
                raise UsageError(
                    "--uncertainty belongs to measured errors; a simulated device has none to measure"
                )
            ranges = {
                name: parse(name, text)
                for name, text in (("temperature", temperature), ("distance", distance))
            }
            found = verify_model(Model.load(subject), maximum_permissible_error=bound, **ranges)
        else:
            correction = None if model is None else Model.load(model)
            if correction:
                reading = read_for(correction, reading)
            observations = read(subject, quiet, reading)
            found = verify(
                observations,
                maximum_permissible_error=bound,
                model=correction,
                law=law,
                uncertainties=uncertainties or (),
            )
    if report is not None:
        from echocal.report.html.results import verification_page

        write_report(report, verification_page, found, subject.name)
    write_json(found.to_dict(), json)
    if not quiet and json != "-":
        _print(found)
    end(found.decision)


def _print(result: Verification) -> None:
    color = "green" if result.passed else "red"
    table = Table(show_header=False, title=f"verification: [bold {color}]{result.decision}[/]")
    place = ", ".join(_shown(name, value) for name, value in result.worst.items())
    table.add_row("maximum permissible error", f"{result.maximum_permissible_error * 1e3:g} mm")
    table.add_row("maximum error", f"{result.maximum_error * 1e3:+.3f} mm at {place}")
    table.add_row("mean error", f"{result.mean_error * 1e3:+.3f} mm")
    table.add_row("root mean square error", f"{result.rms_error * 1e3:.3f} mm")
    table.add_row("errors examined", f"{result.count}, of which {result.exceeding} exceed the bound")
    if result.least_probability is not None:
        table.add_row("guard band (expanded uncertainty)", f"{result.guard_band * 1e3:.2g} mm at most")
        table.add_row("errors too near to the bound to decide", f"{result.undecided}")
        table.add_row("least probability of conformity", probability_text(result.least_probability))
    for reason, count in result.unusable.items():
        table.add_row("not examined", f"{count} rows: {reason}")
    for reason, count in result.outside_smooth.items():
        table.add_row("examined without it", f"{count} rows: {reason}")
    Console().print(table)
    for note in result.notes:
        Console(soft_wrap=True).print(f"note: {note}", markup=False)


def _shown(name: str, value: float) -> str:
    return f"row {value:.0f}" if name == "row" else f"{name.replace('_', ' ')} {quantity_text(name, value)}"
