"""What every command that reads a table shares: options, notes, JSON."""

import json
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, TypeAlias

import typer

from echocal.cli._console import Console
from echocal.cli._options import Options, added, from_stdin
from echocal.cli._outputs import pass_on
from echocal.engines.names import ENGINES
from echocal.errors import DataWarning, DomainWarning, UsageError
from echocal.observations import Observations, read_observations
from echocal.observations.plan import read_columns

__all__ = ["At", "Columns", "Engine", "Json", "Missing", "Options", "Quiet", "ReadingSpeed"]
__all__ += ["Sheet", "SkipLines", "SpreadsheetSafe", "TimeFormat", "TimeZone", "Trust"]
__all__ += ["conditions", "from_stdin"]
__all__ += ["column_requests", "error_codes", "noted", "notes", "options_of", "read"]
__all__ += ["toml_files", "write_json"]

_OURS = (DataWarning, DomainWarning)

Columns: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="A=B",
        callback=added,
        help='What a column holds: "SR_U=reading_m"; or a TOML file of pairs.',
    ),
]
Missing: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--missing",
        metavar="[A=]CODE",
        callback=added,
        help='Error code for "no value": -9999, or "Distance [mm]=9999".',
    ),
]
ReadingSpeed: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="C", help='Speed that readings were made with: 343, "331.4+0.6*T", a law.'),
]
Trust: TypeAlias = Annotated[
    list[str] | None,
    typer.Option("--trust", metavar="A", help="Column that is right although it looks like another unit."),
]
TimeZone: TypeAlias = Annotated[str, typer.Option(help="Zone of times without an offset.")]
SkipLines: TypeAlias = Annotated[int, typer.Option(min=0, help="Lines before the header.")]
Decimal: TypeAlias = Annotated[
    str | None, typer.Option(help="Decimal separator of a text file; default: seen in it.")
]
At: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--at",
        metavar="NAME=VALUE",
        callback=added,
        help="Condition that the table has no column for, with its standard uncertainty: temperature=20+-2 "
        "(degC), humidity=50+-20 (%), pressure=1013 (hPa).",
    ),
]
TimeFormat: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="FORMAT", help='How times are written, as of strptime: "%d/%m/%Y %H:%M"; default: seen.'
    ),
]
Sheet: TypeAlias = Annotated[str | None, typer.Option(metavar="NAME", help="Sheet of a spreadsheet.")]
Encoding: TypeAlias = Annotated[str, typer.Option(help="Encoding of a text file.")]
SpreadsheetSafe: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--spreadsheet-safe",
        help="In CSV, write an apostrophe before texts that a spreadsheet would take for formulas.",
    ),
]
Engine: TypeAlias = Annotated[
    str, typer.Option(metavar="NAME", help=f"Who does the work: {', '.join(ENGINES)}.")
]
Json: TypeAlias = Annotated[
    str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - is stdout.")
]
Quiet: TypeAlias = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]


def column_requests(texts: Sequence[str] | None) -> dict[str, str]:
    """Requests by column from ``A=B`` pairs and TOML files; what comes later wins."""
    requests: dict[str, str] = {}
    for text in texts or ():
        column, equals, request = text.rpartition("=")
        if equals:
            requests[column] = request
        elif text.endswith(".toml"):
            requests |= read_columns(text)
        else:
            message = f'--column "{text}" is neither a pair ("SR_U=reading_m") nor a TOML file'
            raise UsageError(message)
    return requests


def toml_files(texts: Sequence[str] | None) -> list[str]:
    """Files among the requests: inputs of the command, as the table is."""
    return [text for text in texts or () if "=" not in text and text.endswith(".toml")]


def error_codes(texts: Sequence[str] | None) -> dict[str, list[str]]:
    """Error codes by column; those for all columns under the empty name."""
    codes: dict[str, list[str]] = {}
    for text in texts or ():
        column, _, code = text.rpartition("=")
        codes.setdefault(column, []).append(code)
    return codes


def conditions(texts: Sequence[str] | None) -> dict[str, str]:
    """Stated conditions from ``NAME=VALUE`` pairs; what comes later wins."""
    found = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not equals:
            message = f'--at "{text}" is no pair; like --at temperature=20+-2'
            raise UsageError(message)
        found[name.strip()] = value
    return found


def options_of(
    columns: Sequence[str] | None,
    missing: Sequence[str] | None,
    trust: Sequence[str] | None,
    at: Sequence[str] | None = None,
    **others: Any,
) -> dict[str, Any]:
    """Arguments of `read_observations` from those of a command."""
    beside = {
        "at": conditions(at),
        "time_format": others.pop("time_format", None),
        "sheet": others.pop("sheet", None),
    }
    return {
        "columns": column_requests(columns),
        "missing": error_codes(missing),
        "trust": trust or (),
        **others,
        **{name: value for name, value in beside.items() if value},
    }


@contextmanager
def noted(quiet: bool, kind: type[Warning] | tuple[type[Warning], ...] = _OURS) -> Iterator[None]:
    """Turn warnings of a kind into notes, each once; no other warning is for users of a command."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    ours = (warning for warning in caught if issubclass(warning.category, kind))
    notes(list(dict.fromkeys(str(warning.message) for warning in ours)), quiet)


def read(source: Any, quiet: bool, **options: Any) -> Observations:
    """Read a table; its notes go to stderr."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # the notes say the same
        observations = read_observations(source, **options)
    notes(observations.notes, quiet)
    return observations


def notes(texts: Sequence[str], quiet: bool) -> None:
    """Print what a person should know, beside the result."""
    console = Console(stderr=True, quiet=quiet, soft_wrap=True, highlight=False)
    for text in texts:
        console.print(f"note: {text}", markup=False, style="yellow")


def write_json(document: dict[str, Any], target: str | None) -> None:
    """Write a document to a file, or to stdout for ``-``; not a number is null."""
    if target is not None:
        pass_on(json.dumps(_finite(document), indent=2, allow_nan=False) + "\n", target)


def _finite(value: Any) -> Any:
    match value:
        case dict():
            return {name: _finite(item) for name, item in value.items()}
        case list() | tuple():
            return [_finite(item) for item in value]
        case float() if not math.isfinite(value):
            return None
    return value
