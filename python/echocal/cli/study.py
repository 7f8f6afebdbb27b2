"""``echocal study``: the study that echocal began from, recomputed."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

Out = Annotated[
    Path | None, typer.Option("--out", help="Folder for the figures (PNG) and the page study.md.")
]
Json = Annotated[str | None, typer.Option("--json", help="File for everything as JSON, or - for stdout.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but the verdicts' counts.")]


def command(out: Out = None, json_to: Json = None, quiet: Quiet = False) -> None:
    """Recompute every number of the study: reproduced, not reproduced or physically wrong."""
    from echocal import study
    from echocal.study import document, figures, report

    found = study.run()
    if json_to == "-":
        typer.echo(json.dumps(found.to_dict(), indent=2, ensure_ascii=False))
    elif json_to is not None:
        Path(json_to).write_text(json.dumps(found.to_dict(), indent=2, ensure_ascii=False), encoding="utf-8")
    console = Console(stderr=json_to == "-")
    if quiet:
        console.print(", ".join(f"{count} {name}" for name, count in found.verdicts.items()))
    else:
        report.show(found, console)
    if out is not None:
        paths = figures.save(found, out)
        page = out / "study.md"
        page.write_text(document.render(found), encoding="utf-8")
        if not quiet:
            console.print(f"wrote {', '.join(str(path) for path in [*paths, page])}")
