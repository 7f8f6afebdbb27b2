"""``echocal study``: the study that the project began with, recomputed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from echocal.cli import _made_by
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, Report, be_quiet, check_outputs, made_in
from echocal.cli._progress import counted_bar
from echocal.cli._tables import Json, write_json
from echocal.errors import writing
from echocal.outputs import replace_text

if TYPE_CHECKING:
    from echocal.study import Study
    from echocal.study.question.answer import Answer


PAGES = ("study.md", "study-diagnosis.md", "study-question.md")
READINGS = "study-question.json"


def command(
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the figures (PNG) and the pages (Markdown).")
    ] = None,
    emulated: Annotated[
        bool,
        typer.Option("--emulate", help="Ask why Tinkercad reads short: the experiment on an emulated board."),
    ] = False,
    page: Report = None,
    json: Json = None,
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", callback=be_quiet, help="Print the count of each verdict only."),
    ] = False,
    force: Force = False,
) -> None:
    """Recompute every number of the study: reproduced, not reproduced or physically wrong."""
    from echocal import study
    from echocal.study import figures, report
    from echocal.study.question.page import FIGURES as ANSWERED

    check_outputs(
        Output("--json", json, _made_by.result("echocal.study")),
        Output("--report", page, _made_by.report("study")),
        *made_in(out, "--out", (*figures.FIGURES, *ANSWERED), _made_by.picture("study")),
        *made_in(out, "--out", (READINGS,), _made_by.result("echocal.study_question")),
        *made_in(out, "--out", PAGES, _made_by.page("study")),
        folder=out,
        force=force,
    )

    answer = _answer(out, emulated=emulated, quiet=quiet)
    found = study.run()
    console = Console(stderr=json == "-")
    if quiet:
        console.print(", ".join(f"{count} {name}" for name, count in found.verdicts.items()))
    else:
        report.show(found, console)
        if answer is not None:
            from echocal.study.question.page import show

            show(answer, console)
    if out is not None:
        _write(found, answer, out)
    if page is not None:
        from echocal.pages.study import study_page

        replace_text(page, study_page(found))
    write_json(_document(found, answer), json)


def _answer(out: Path | None, *, emulated: bool, quiet: bool) -> "Answer | None":
    """Measure on the board; without it, take the readings that lie in the folder, if there are any."""
    kept = None if out is None else out / READINGS
    if not emulated and (kept is None or not kept.exists()):
        return None
    from echocal.study.question.answer import answer
    from echocal.study.question.investigation import Investigation, investigate

    if not emulated and kept is not None:
        return answer(Investigation.load(kept))
    with counted_bar(quiet, "on the emulated board") as tell:
        found = investigate(progress=tell)
    if kept is not None:
        with writing(kept.parent):
            kept.parent.mkdir(parents=True, exist_ok=True)
        replace_text(kept, found.text())
    return answer(found)


def _document(found: "Study", answer: "Answer | None") -> dict[str, Any]:
    if answer is None:
        return found.to_dict()
    from echocal.study.question import page

    return found.to_dict() | {"question": page.document(answer)}


def _write(found: "Study", answer: "Answer | None", out: Path) -> None:
    from echocal.study import diagnosed, figures, report
    from echocal.study.question import page, picture

    with writing(out):
        figures.save(found, out)
        if answer is not None:
            picture.save(answer, out)
    texts = [report.render(found), diagnosed.render(diagnosed.ask(found.tables))]
    texts += [page.render(answer)] if answer is not None else []
    for name, text in zip(PAGES, texts, strict=False):
        replace_text(out / name, text)
