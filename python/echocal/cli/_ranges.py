"""Ranges: of the air and the distance on a grid, and those of ``--can-vary``."""

from collections.abc import Iterable
from typing import Annotated, TypeAlias

import typer

from echocal.errors import UsageError
from echocal.sweep import Range, parse

Temperature: TypeAlias = Annotated[
    str | None, typer.Option(metavar="RANGE", help="Air temperature [degC]: 20, 0:50:2 or 0,20,50.")
]
Distance: TypeAlias = Annotated[
    str | None, typer.Option(metavar="RANGE", help="True distance [m]; default 2.")
]
Humidity: TypeAlias = Annotated[
    str | None, typer.Option(metavar="RANGE", help="Relative humidity [1], 0 to 1; default 0.")
]
Pressure: TypeAlias = Annotated[str | None, typer.Option(metavar="RANGE", help="Air pressure [Pa].")]


def given_ranges(**texts: str | None) -> dict[str, Range]:
    """Those ranges that the user gives, by quantity."""
    return {name: parse(name, text) for name, text in texts.items() if text is not None}


def parsed_ranges(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Read several ranges, each of another condition."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, ends = _parsed(text)
        if name in ranges:
            low, high = ranges[name]
            raise UsageError(
                f"--can-vary gives {name} twice: {low:g}:{high:g} and {ends[0]:g}:{ends[1]:g}; give one range"
            )
        ranges[name] = ends
    return ranges


def _parsed(text: str) -> tuple[str, tuple[float, float]]:
    """Read ``distance=0.2:4``."""
    name, equals, ends = text.partition("=")
    low, colon, high = ends.partition(":")
    try:
        if equals and colon:
            return name, (float(low), float(high))
    except ValueError:
        pass
    raise UsageError(f"--can-vary '{text}' is not a range such as distance=0.2:4")
