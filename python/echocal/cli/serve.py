"""``echocal serve``: a page in the browser of this machine."""

from typing import Annotated

import typer

from echocal.serve.server import HOST, PORT, serve


def command(
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port on this machine.")] = PORT,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page.")] = True,
) -> None:
    """Show a page in the browser of this machine: drop a log, read the report, take the model."""
    typer.echo(f"http://{HOST}:{port} (Ctrl-C ends it)")
    serve(port, show=browser)
