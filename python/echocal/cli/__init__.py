"""The command line: one file per command, no computation here."""

import sys
from importlib import import_module

import typer

from echocal.errors import EchocalError

__all__ = ["COMMANDS", "app", "main"]

COMMANDS = ("calibrate", "correct", "diagnose", "effects", "firmware", "study", "sweep", "verify")
"""Every command: ``echocal NAME`` is ``command`` of ``echocal.cli.NAME``, a function or an app of its own."""

app = typer.Typer(
    name="echocal",
    help="Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # help texts name units in brackets, which markup would swallow
)

for _name in COMMANDS:
    _command = import_module(f"echocal.cli.{_name}").command
    if isinstance(_command, typer.Typer):
        app.add_typer(_command, name=_name)
    else:
        app.command(_name)(_command)


def main() -> None:
    """Run the command line; a user's mistake is one line on stderr and an exit code."""
    try:
        app()
    except EchocalError as error:
        sys.stderr.write(f"echocal: {error}\n")
        sys.exit(error.exit_code)
