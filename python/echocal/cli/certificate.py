"""``echocal certificate``: corrected distances with their uncertainty, to be signed."""

from pathlib import Path
from typing import Annotated

import typer

from echocal.budget.coverage import COVERAGE
from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._models import Uncertain, end, read_for
from echocal.cli._outputs import Force, Output, Quiet, check_outputs, this_command
from echocal.cli._tables import AS_IT_IS, Given, Json, noted, read, reading_options, write_json
from echocal.errors import UsageError
from echocal.model import Model


@reading_options()
def command(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="Model file (.json).")],
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Table of readings.")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="Write .html or .pdf.")],
    uncertainties: Uncertain = None,
    mpe_mm: Annotated[float, typer.Option(metavar="MM", help="Maximum permissible error [mm].")] = 3.0,
    device: Annotated[str, typer.Option(help="The device: type, number, owner.")] = "",
    issued_by: Annotated[str, typer.Option(help="Who issues the certificate.")] = "",
    coverage: Annotated[float, typer.Option(help="Coverage probability of U.")] = COVERAGE,
    reading: Given = AS_IT_IS,
    json: Json = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write a certificate: results with their uncertainty, the budget, and conformity with a guard band.

    Exit code 1: does not conform. Exit code 5: undecided.
    """
    from echocal.report.html.certificate import certify, refuse_ending, save_certificate, sha256_of

    refuse_ending(out)
    known = _made_by.report if out.suffix.lower() == ".html" else _made_by.picture
    check_outputs(
        Output("--out", out, known("certificate")),
        Output("--json", json, _made_by.result("echocal.budget")),
        inputs=[model, data, *reading.files],
        force=force,
    )
    if not mpe_mm > 0.0:
        raise UsageError(f"--mpe-mm {mpe_mm:g}: the maximum permissible error must be a positive length")
    with noted(quiet):
        own = Model.load(model)
        reading = read_for(own, reading)
        observations = read(data, quiet, reading)
        found = certify(
            own,
            observations,
            maximum_permissible_error=mpe_mm * 1e-3,
            uncertainties=uncertainties or (),
            coverage=coverage,
        )
    table = own.provenance.get("table")
    identification = {
        "device": device or "not stated",
        "issued by": issued_by or "not stated",
        "law of the speed of sound": own.law,
        "model file": f"{model.name}, hash {own.hash}",
        "data file": f"{data.name}, SHA-256 {sha256_of(data)}",
        "rows": f"{len(found.rows)} of {len(observations)}",
    }
    if isinstance(table, str):
        identification["model from"] = f"{table}, by {own.provenance.get('made_by', '')}"
    save_certificate(found, out, identification, this_command())
    write_json(found.budget.to_dict(), json)
    if not quiet and json != "-":
        Console(soft_wrap=True).print(f"{found.decision}: {found.statement}", markup=False)
    end(found.decision)
