"""``echocal study``: the study that echocal began from, recomputed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from echocal.cli._outputs import refuse_unwritable
from echocal.cli._tables import Json, write_json
from echocal.errors import writing

if TYPE_CHECKING:
    from echocal.study import Study


def command(
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the figures (PNG) and the pages (Markdown).")
    ] = None,
    json: Json = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print the count of each verdict only.")
    ] = False,
) -> None:
    """Recompute every number of the study: reproduced, not reproduced or physically wrong."""
    refuse_unwritable(json, folder=out)
    from echocal import study
    from echocal.study import report

    found = study.run()
    console = Console(stderr=json == "-")
    if quiet:
        console.print(", ".join(f"{count} {name}" for name, count in found.verdicts.items()))
    else:
        report.show(found, console)
    if out is not None:
        _write(found, out, console, quiet=quiet)
    write_json(found.to_dict(), json)


def _write(found: "Study", out: Path, console: Console, *, quiet: bool) -> None:
    from echocal.study import diagnosed, document, figures

    with writing(out):
        paths = figures.save(found, out)
        pages = {
            "study.md": document.render(found),
            "study-diagnosis.md": diagnosed.render(diagnosed.ask(found.tables)),
        }
        for name, text in pages.items():
            (out / name).write_text(text, encoding="utf-8")
            paths.append(out / name)
    if not quiet:
        console.print(f"wrote {', '.join(str(path) for path in paths)}", markup=False)
