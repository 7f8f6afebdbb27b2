"""What every command that reads a table shares: options, notes, JSON."""

import json
import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, TypeAlias, get_type_hints

import typer

from echocal.cli._console import Console
from echocal.cli._options import Options, added
from echocal.cli._outputs import pass_on
from echocal.engines import ENGINES
from echocal.errors import DataWarning, DomainWarning, UsageError
from echocal.observations import Observations, read_observations
from echocal.observations.options import ReadOptions
from echocal.observations.plan import read_columns

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


_FLAGS = {
    "columns": Columns,
    "missing": Annotated[
        list[str] | None,
        typer.Option(
            "--missing",
            metavar="[A=]CODE",
            callback=added,
            help='Error code for "no value": -9999, or "Distance [mm]=9999".',
        ),
    ],
    "trust": Annotated[
        list[str] | None,
        typer.Option(
            "--trust", metavar="A", help="Column that is right although it looks like another unit."
        ),
    ],
    "reading_speed": Annotated[
        str | None,
        typer.Option(metavar="C", help='Speed that readings were made with: 343, "331.4+0.6*T", a law.'),
    ],
    "time_zone": Annotated[str, typer.Option(help="Zone of times without an offset.")],
    "skip_lines": Annotated[int, typer.Option(min=0, help="Lines before the header.")],
    "decimal": Annotated[
        str | None, typer.Option(help="Decimal separator of a text file; default: seen in it.")
    ],
    "encoding": Annotated[str, typer.Option(help="Encoding of a text file.")],
    "at": Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            metavar="NAME=VALUE",
            callback=added,
            help="Condition that the table has no column for, with its standard uncertainty: "
            "temperature=20+-2 (degC), humidity=50+-20 (%), pressure=1013 (hPa).",
        ),
    ],
    "time_format": Annotated[
        str | None,
        typer.Option(
            metavar="FORMAT", help='How times are written, as of strptime: "%d/%m/%Y %H:%M"; default: seen.'
        ),
    ],
    "sheet": Annotated[str | None, typer.Option(metavar="NAME", help="Sheet of a spreadsheet.")],
    "mount_height": Annotated[
        float | None,
        typer.Option(
            metavar="M",
            help="Height of the sensor above the zero of a level, in m, with --column NAME=level_m; else "
            "fitted.",
        ),
    ],
    "reference": Annotated[
        Path | None,
        typer.Option(
            "--reference",
            metavar="FILE",
            help="Another log with the reference distances, or levels: joined by time. A correction needs "
            "none; it leaves out what --column says of it.",
        ),
    ],
    "reference_join": Annotated[
        str,
        typer.Option(metavar="interpolated|nearest", help="How its values come to the times of the rows."),
    ],
    "options": Options,
}
"""Flags of every command that reads a table."""
_USUAL = {one.name: one.default for one in fields(ReadOptions) if isinstance(one.default, str | int)}


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
            raise UsageError(f'--column "{text}" is neither a pair ("SR_U=reading_m") nor a TOML file')
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
            raise UsageError(f'--at "{text}" is no pair; like --at temperature=20+-2')
        found[name.strip()] = value
    return found


@dataclass(frozen=True, kw_only=True)
class Given(ReadOptions):
    """Options of a command line, and the files that they came from."""

    files: tuple[str, ...] = ()


AS_IT_IS = Given()


def reading_options(*without: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command a flag for each of `ReadOptions` but some; it takes them together, as `reading`."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        hints = get_type_hints(command, include_extras=True)
        parameters: list[Parameter] = []
        for one in signature(command).parameters.values():
            names = [name for name in _FLAGS if name not in without] if one.name == "reading" else []
            usual = {name: _USUAL.get(name) for name in names}
            parameters += [one.replace(name=n, annotation=_FLAGS[n], default=usual[n]) for n in names]
            parameters += [] if names else [one.replace(annotation=hints[one.name])]

        @wraps(command)
        def whole(**given: Any) -> None:
            said = {name: given.pop(name) for name in _FLAGS if name in given}
            command(**given, reading=_given(**said))

        whole.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
        whole.__annotations__ = {one.name: one.annotation for one in parameters}
        return whole

    return decorate


def _given(*, columns: Any, missing: Any, trust: Any, at: Any, options: Path | None, **others: Any) -> Given:
    return Given(
        columns=column_requests(columns),
        missing=error_codes(missing),
        trust=trust or (),
        at=conditions(at),
        files=(*toml_files(columns), *map(str, filter(None, [options, others.get("reference")]))),
        **{name: value for name, value in others.items() if value is not None},
    )


def reading_words(reading: Given) -> dict[str, Any]:
    """The same as options of `echocal.keywords.command_line`."""
    given = reading.given()
    pairs = {"columns": "column", "at": "at"}
    listed = {name: given.pop(name) for name in pairs if name in given}
    words = {pairs[name]: [f"{own}={one}" for own, one in each.items()] for name, each in listed.items()}
    if (codes := given.pop("missing", None)) is not None:
        words["missing"] = [f"{own}={one}" if own else one for own, each in codes.items() for one in each]
    return words | {name: list(one) if isinstance(one, tuple) else one for name, one in given.items()}


@contextmanager
def noted(quiet: bool, kind: type[Warning] | tuple[type[Warning], ...] = _OURS) -> Iterator[None]:
    """Turn warnings of a kind into notes, each once; no other warning is for users of a command."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    ours = (warning for warning in caught if issubclass(warning.category, kind))
    notes(list(dict.fromkeys(str(warning.message) for warning in ours)), quiet)


def read(source: Any, quiet: bool, options: ReadOptions) -> Observations:
    """Read a table; its notes go to stderr."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # the notes say the same
        observations = read_observations(source, **options.given())
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
