"""The command line: one file per command, no computation here."""

import sys
from importlib import import_module

import typer

from echocal.errors import EchocalError

__all__ = ["COMMANDS", "app", "main"]

COMMANDS = ("effects",)
"""Every command: ``echocal NAME`` is the function ``command`` of ``echocal.cli.NAME``."""

app = typer.Typer(
    name="echocal",
    help="Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

for _name in COMMANDS:
    app.command(_name)(import_module(f"echocal.cli.{_name}").command)


def main() -> None:
    """Run the command line; a user's mistake is one line on stderr and an exit code."""
    try:
        app()
    except EchocalError as error:
        sys.stderr.write(f"echocal: {error}\n")
        sys.exit(error.exit_code)
