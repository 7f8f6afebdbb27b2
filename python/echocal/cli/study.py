"""``echocal study``: the study that the project began with, recomputed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, check_outputs, made_in
from echocal.cli._tables import Json, write_json
from echocal.errors import writing
from echocal.outputs import replace_text

if TYPE_CHECKING:
    from echocal.study import Study


PAGES = ("study.md", "study-diagnosis.md")


def command(
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the figures (PNG) and the pages (Markdown).")
    ] = None,
    page: Annotated[
        Path | None, typer.Option("--report", metavar="OUT.html", help="Write one page for a browser.")
    ] = None,
    json: Json = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print the count of each verdict only.")
    ] = False,
    force: Force = False,
) -> None:
    """Recompute every number of the study: reproduced, not reproduced or physically wrong."""
    from echocal import study
    from echocal.study import figures, report

    check_outputs(
        Output("--json", json, _made_by.result("echocal.study")),
        Output("--report", page, _made_by.report("study")),
        *made_in(out, "--out", figures.FIGURES, _made_by.picture("study")),
        *made_in(out, "--out", PAGES, _made_by.page("study")),
        folder=out,
        force=force,
    )

    found = study.run()
    console = Console(stderr=json == "-")
    if quiet:
        console.print(", ".join(f"{count} {name}" for name, count in found.verdicts.items()))
    else:
        report.show(found, console)
    if out is not None:
        _write(found, out, console, quiet=quiet)
    if page is not None:
        from echocal.pages.study import study_page  # plotly takes a while to import

        replace_text(page, study_page(found))
    write_json(found.to_dict(), json)


def _write(found: "Study", out: Path, console: Console, *, quiet: bool) -> None:
    from echocal.study import diagnosed, document, figures

    with writing(out):
        paths = figures.save(found, out)
    texts = (document.render(found), diagnosed.render(diagnosed.ask(found.tables)))
    for name, text in zip(PAGES, texts, strict=True):
        replace_text(out / name, text)
        paths.append(out / name)
    if not quiet:
        console.print(f"wrote {', '.join(str(path) for path in paths)}", markup=False)
