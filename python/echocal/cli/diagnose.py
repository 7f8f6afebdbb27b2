"""``echocal diagnose``: name what the base simulation gets wrong."""

import json
import sys
import warnings
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from echocal.diagnose import Diagnosis, diagnose
from echocal.errors import DataWarning, UsageError
from echocal.model import Model
from echocal.report import print_diagnosis


def command(
    data: Annotated[Path, typer.Argument(help="Table of echoes: CSV, TSV, Parquet.")],
    base: Annotated[str, typer.Option(help="Law, expression, fixed speed in m/s, or model file.")] = "linear",
    column: Annotated[
        list[str] | None, typer.Option(metavar="A=B", help='What a column holds, e.g. "SR_U=reading_m".')
    ] = None,
    reference_distance: Annotated[
        float | None, typer.Option(metavar="M", help="Distance of the target in every row, in m.")
    ] = None,
    constant_distance: Annotated[
        bool, typer.Option("--constant-distance", help="The target never moved; its distance is not known.")
    ] = False,
    reading_speed: Annotated[
        str | None,
        typer.Option(metavar="C", help="Speed that the device made its readings with; default: the base."),
    ] = None,
    missing: Annotated[
        list[str] | None, typer.Option(metavar="[A=]CODE", help="Error code that means: no value.")
    ] = None,
    since: Annotated[str | None, typer.Option(metavar="TIME", help="Use rows from this time on.")] = None,
    until: Annotated[
        str | None, typer.Option(metavar="TIME", help="Use rows up to this time; a date means its whole day.")
    ] = None,
    hold_out_after: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Hold out rows from this time on: ISO 8601, or seconds."),
    ] = None,
    model: Annotated[Path | None, typer.Option(metavar="OUT.json", help="Write the extended model.")] = None,
    plots: Annotated[Path | None, typer.Option(metavar="DIR", help="Write plots.")] = None,
    json_: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the diagnosis as JSON; - is stdout.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the gain's interval.")] = 0,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing.")] = False,
) -> None:
    """Name what the base simulation gets wrong, and measure what the extended model gains."""
    with warnings.catch_warnings(action="ignore", category=DataWarning):  # they are among the notes
        diagnosis = diagnose(
            data,
            base=Model.load(base) if base.endswith(".json") else base,
            reference_distance=reference_distance,
            constant_distance=constant_distance,
            columns=dict(_pair(text, "--column") for text in column or ()),
            reading_speed=reading_speed,
            missing=_codes(missing or []),
            since=since,
            until=until,
            hold_out_after=_time(hold_out_after),
            seed=seed,
        )
    _write(diagnosis, model, plots, json_)
    if not quiet and json_ != "-":
        print_diagnosis(diagnosis, Console())


def _write(diagnosis: Diagnosis, model: Path | None, plots: Path | None, json_: str | None) -> None:
    if model is not None:
        diagnosis.model.save(model)
    if plots is not None:
        from echocal.plots.diagnosis import save_diagnosis  # matplotlib takes a second to import

        save_diagnosis(diagnosis, plots)
    if json_ == "-":
        sys.stdout.write(json.dumps(diagnosis.to_dict(), indent=2) + "\n")
    elif json_ is not None:
        diagnosis.to_json(json_)


def _pair(text: str, option: str) -> tuple[str, str]:
    left, equals, right = text.partition("=")
    if not (left and equals and right):
        message = f'{option} "{text}" is not of the form A=B, such as "SR_U=reading_m"'
        raise UsageError(message)
    return left, right


def _codes(texts: list[str]) -> list[float | str] | dict[str, list[float | str]]:
    """Codes for all columns, or by column where every text names one."""
    named = [text for text in texts if "=" in text]
    if not named:
        return [_number(text) for text in texts]
    if len(named) < len(texts):
        message = "--missing names a column for every code or for none: A=CODE, or CODE"
        raise UsageError(message)
    codes: dict[str, list[float | str]] = {}
    for text in named:
        name, code = _pair(text, "--missing")
        codes.setdefault(name, []).append(_number(code))
    return codes


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _time(text: str | None) -> str | float | None:
    """Seconds where it is a number, else a time; a bare year is a time."""
    if text is None or len(text) == 4:
        return text
    return _number(text)
