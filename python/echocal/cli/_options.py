"""Options of a command from a TOML file: ``--options log.toml``. What is given as a flag wins."""

import atexit
import json
import sys
import tempfile
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from echocal.errors import UsageError
from echocal.keywords import command_line, keyword

_FIRST = "# how to read"

KNOWN = {
    "column", "missing", "trust", "at", "reading-speed", "time-zone", "time-format", "skip-lines", "decimal",
    "encoding", "sheet", "reference-distance", "constant-distance", "by", "since", "until", "base", "law",
    "same-target", "mount-height", "reference", "reference-join", "placements", "matters-mm",
}  # fmt: skip
"""Options that such a file may have; a command takes those that it has."""

_PAIRS = ("column", "missing", "at")
_KEY = "echocal.options"
_STDIN = "stdin-"  # how the name of a file begins that holds what stdin had
_BY_USER = ("COMMANDLINE", "DEFAULT_MAP", "ENVIRONMENT")
_stated: ContextVar[frozenset[str]] = ContextVar("options that the user gives", default=frozenset())
_file: ContextVar[Path | None] = ContextVar("file of options", default=None)


def _take(context: typer.Context, path: Path | None) -> Path | None:
    """Make the values of the file the defaults of the command."""
    _file.set(path)
    if path is not None and not context.resilient_parsing:
        names = {flag.removeprefix("--"): own.name for own in context.command.params for flag in own.opts}
        values = {names[option]: value for option, value in _read(path).items() if option in names}
        context.meta[_KEY] = values
        context.default_map = {**(context.default_map or {}), **values}
    return path


Options: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--options",
        metavar="FILE.toml",
        is_eager=True,
        callback=_take,
        help="Options of the log, as `echocal inspect LOG -o FILE.toml` writes them; a flag wins.",
    ),
]


_NEEDS = {"reference_join": "reference", "plot_format": "plots", "unit_number": "unit_data"}
"""Options that do nothing without another one."""


def stated(name: str) -> bool:
    """Whether the user gives an option of the running command: as a flag, or in the file of options."""
    return name in _stated.get()


def refuse_others(used: Iterable[str], but: str) -> None:
    """Refuse options that the user gives and that the running command does not use this time.

    Raises `UsageError` with each of them; `but` says what it does instead, and the way out.
    """
    useless = sorted(map(keyword, _stated.get() - {*used}))
    if useless:
        raise UsageError(f"{', '.join(useless)} would do nothing: {but}")


def refuse_useless(context: typer.Context) -> None:
    """Take note of the options that the user gives; refuse those without the one that they belong to.

    Raises `UsageError` with both.
    """
    flags = {own.name or "": own.opts[0] for own in context.command.params}
    sources = {name: context.get_parameter_source(name) for name in flags}
    _stated.set(frozenset(n for n, own in sources.items() if own is not None and own.name in _BY_USER))
    for name, other in _NEEDS.items():
        if name in flags and other in flags and stated(name) and context.params.get(other) is None:
            raise UsageError(
                f"{flags[name]} {context.params[name]} does nothing without {flags[other]}: give it, too, or "
                f"leave {flags[name]} out"
            )


def file_in_use() -> Path | None:
    """The file of options that the running command reads."""
    return _file.get()


def added(
    context: typer.Context, parameter: typer.CallbackParam, given: list[str] | None
) -> list[str] | None:
    """Pairs of the file before those that are given as flags: these win, for their own column."""
    source = context.get_parameter_source(parameter.name or "")
    if given is None or source is None or source.name != "COMMANDLINE":
        return given
    return [*context.meta.get(_KEY, {}).get(parameter.name, []), *given]


def from_stdin(data: Path) -> Path:
    """The file itself; for ``-`` a file with what stdin has, until the program ends."""
    if str(data) != "-":
        return data
    held = tempfile.NamedTemporaryFile(prefix=_STDIN, delete=False)  # noqa: SIM115
    with held as file:
        while part := sys.stdin.buffer.read(1 << 20):
            file.write(part)
    path = Path(held.name)
    atexit.register(path.unlink, missing_ok=True)
    return path


def is_stdin(path: Path) -> bool:
    """Whether it is the file that `from_stdin` made."""
    return path.name.startswith(_STDIN)


def options_text(log: Path, out: Path, given: Mapping[str, Any]) -> str:
    """A file of options, from arguments of `echocal.diagnose` and `echocal.read_observations`."""
    names = {"columns": "column"}
    plain = {names.get(name, name).replace("_", "-"): value for name, value in given.items()}
    tables = {name: own for name, own in plain.items() if isinstance(own, Mapping)}
    again = command_line("diagnose", log, options=out)
    lines = [f"{_FIRST} {log}, written by echocal; edit it, then: {again}"]
    lines += [f"{name} = {toml_value(own)}" for name, own in plain.items() if name not in tables]
    for name, own in tables.items():
        lines += ["", f"[{name}]", *(f"{toml_value(key)} = {toml_value(one)}" for key, one in own.items())]
    return "\n".join(lines) + "\n"


def toml_value(value: object) -> str:
    """A text, a number, a list of these, as TOML writes it."""
    return json.dumps(value, ensure_ascii=False)


def written_by_us(file: Path) -> bool:
    """Whether a command wrote this file of options, or this table for one."""
    with file.open(encoding="utf-8", errors="replace") as stream:
        return stream.readline().startswith(_FIRST)


def _read(path: Path) -> dict[str, Any]:
    from echocal.observations.plan import toml_of  # what it imports takes long

    values: dict[str, Any] = {}
    for name, value in toml_of(path, "options file").items():
        option = name.replace("_", "-")
        if option not in KNOWN:
            raise UsageError(
                f"options file {path}: unknown option '{name}'; there are {', '.join(sorted(KNOWN))}"
            )
        values[option] = _plain(path, option, value)
    return values


def _plain(path: Path, option: str, value: Any) -> Any:
    if option in _PAIRS and isinstance(value, dict):
        listed = [
            (name, own)
            for name, codes in value.items()
            for own in (codes if isinstance(codes, list) else [codes])
        ]
        return [f"{name}={own}" if name else str(own) for name, own in listed]
    if option in (*_PAIRS, "trust"):
        return [str(own) for own in (value if isinstance(value, list) else [value])]
    if isinstance(value, dict | list):
        raise UsageError(f"options file {path}: '{option}' takes one value")
    return value
