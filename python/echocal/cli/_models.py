"""What every command that takes a model shares."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from echocal.cli._complete import effects, laws
from echocal.cli._tables import Given
from echocal.errors import UsageError
from echocal.model import Model
from echocal.model.indicated_speed import speed_of
from echocal.observations.given import mounted_options

Effects: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--effect",
        metavar="ID:NAME=VALUE,...",
        help='Effect on the law: "fixed_speed:weight=1,speed=343".',
        autocompletion=effects,
    ),
]
Law: TypeAlias = Annotated[
    str | None,
    typer.Option(help="Law or expression, in place of a model; default cramer.", autocompletion=laws),
]

ModelFile: TypeAlias = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Model file; default: a law alone.")
]
MarkRows: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--mark-rows/--no-mark-rows",
        help="Mark rows that are as those which the diagnosis of the model left out.",
    ),
]
Uncertain: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--uncertainty",
        metavar="NAME=U",
        help="What is known of an input: temperature_C=0.5, echo_us=2, thermometer=DHT22, "
        "hygrometer=SHT31, barometer=BME280, tape=II, timer_us=4, resolution_mm=10, law_ppm=300.",
    ),
]


def model_of(law: str | None, path: Path | None, effects: Sequence[str] | None) -> Model:
    """Model of a file, or of a law and effects.

    Raises `UsageError` if both are given, or an effect is not of the form ``ID:NAME=VALUE,...``.
    """
    if path is None:
        return Model(law or "cramer", dict(_effect(text) for text in effects or ()))
    if law is not None or effects:
        raise UsageError("give a model file or a law with effects, not both")
    return Model.load(path)


def read_for(model: Model, reading: Given) -> Given:
    """Options of a table that a model corrects: its speed and its height of the sensor, if none is stated."""
    speed = speed_of(model, reading.reading_speed)
    return replace(reading, reading_speed=speed, **mounted_options(reading, model))


def end(decision: str) -> None:
    """End a command with the exit code of what is decided."""
    code = {"conforms": 0, "does not conform": 1, "undecided": 5}[decision]
    if code:
        raise typer.Exit(code)


def _effect(text: str) -> tuple[str, dict[str, float]]:
    id_, _, parameters = text.partition(":")
    try:
        pairs = (pair.split("=") for pair in parameters.split(",") if pair)
        return id_, {name.strip(): float(value) for name, value in pairs}
    except ValueError:
        raise UsageError(
            f'--effect "{text}" is not of the form ID:NAME=VALUE,...; e.g. "fixed_delay:delay=30e-6"'
        ) from None
