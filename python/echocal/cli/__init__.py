"""The command line: one file per command, no computation here."""

import sys
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from echocal._core import __version__
from echocal._interrupt import unwind_when_told
from echocal.cli._console import visible, write_what_can_be_written
from echocal.cli._options import refuse_useless
from echocal.cli._outputs import telling_what_is_written
from echocal.errors import DataError, EchocalError
from echocal.keywords import naming

__all__ = ["COMMANDS", "app", "main"]

COMMANDS = tuple(sorted(file.stem.replace("_", "-") for file in Path(__file__).parent.glob("[a-z]*.py")))
"""Every command: ``echocal NAME`` is ``command`` of ``echocal.cli.NAME``, a function or an app of its own; a
hyphen is an underscore there."""


LOG = "LOG"
"""Name of the command that a path stands for: ``echocal log.csv``."""

_HELP = {"help_option_names": ["-h", "--help"]}


def _is_log(word: str) -> bool:
    """Whether a word is the path of a log, also of one that does not exist: it has an ending or a folder."""
    path = Path(word)
    is_written_as_one = not word.startswith("-") and (path.suffix or len(path.parts) > 1)
    return word == "-" or path.exists() or bool(is_written_as_one)


class _Commands(TyperGroup):
    """Loads the file of a command only when it runs, because imports are slow."""

    def list_commands(self, ctx: Any) -> list[str]:
        return list(COMMANDS)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command; a path where a command would stand is a log, and stays an argument."""
        if args[0] not in COMMANDS and _is_log(args[0]):
            return LOG, self.get_command(ctx, LOG), args
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in (*COMMANDS, LOG):
            near = get_close_matches(cmd_name, COMMANDS, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(COMMANDS)}"
            ctx.fail(f"no command and no file '{cmd_name}'; {hint}")
        file = "_front" if cmd_name == LOG else cmd_name.replace("-", "_")
        command = import_module(f"echocal.cli.{file}").command
        if not isinstance(command, typer.Typer):
            single = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
            single.command(cmd_name)(command)
            command = single
        loaded = typer.main.get_command(command)
        loaded.name = cmd_name
        run = loaded.invoke

        def checked(own: Any) -> Any:
            refuse_useless(own)
            return run(own)

        loaded.invoke = checked  # type: ignore[method-assign, assignment]
        loaded.context_settings = {**loaded.context_settings, **_HELP}
        if ctx is not None and ctx.obj is not None:
            ctx.obj |= {one.name: one.opts[0] for one in loaded.params if one.opts[0].startswith("--")}
        return loaded

    def invoke(self, ctx: Any) -> Any:
        """Run a command; what its options and arguments are told wrong is shown, and steers no terminal."""
        ctx.obj = {}
        try:
            with naming(ctx.obj), telling_what_is_written():
                return super().invoke(ctx)
        except Exception as error:
            if isinstance(told := getattr(error, "message", None), str):
                error.message = visible(told)  # type: ignore[attr-defined]
            raise


app = typer.Typer(
    cls=_Commands,
    name="echocal",
    help="Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction. "
    "`echocal LOG` with the file of a log does all of it.",
    context_settings=_HELP,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # help texts name units in brackets, which markup would swallow
)


def _tell_version(asked: bool) -> None:
    if asked:
        typer.echo(f"echocal {__version__}")
        raise typer.Exit


@app.callback()
def _all_commands(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Without this, an app with no command of its own would be refused."""


def main() -> None:
    """Run the command line; a user's mistake is one line on stderr and an exit code."""
    write_what_can_be_written()
    unwind_when_told()
    try:
        app(prog_name="echocal")
    except EchocalError as error:
        sys.stderr.write(f"echocal: {visible(str(error))}\n")
        sys.exit(error.exit_code)
    except MemoryError as error:
        reason = f" ({error})" if str(error) else ""
        less = "fewer rows, fewer columns or a coarser grid"
        sys.stderr.write(f"echocal: memory ran out{reason}; ask for {less}\n")
        sys.exit(DataError.exit_code)
