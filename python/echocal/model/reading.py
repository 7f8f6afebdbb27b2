"""Reading of model files: every value is checked."""

import json
import re
import reprlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NoReturn, Protocol, Self, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, NonNegativeFloat, NonNegativeInt, ValidationError

from echocal.errors import ModelError, UsageError
from echocal.model.arguments import arranged_covariance
from echocal.model.document import NEWEST, SCHEMA, digest
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape, Smooth
from echocal.registry import find_effect

_WIDEST = 1e150  # standard uncertainty whose square is still a number
_DIGITS = 9  # of a schema's number; more are a mistake


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class _Parameter(_Entry):
    value: float
    standard_uncertainty: NonNegativeFloat | None = None
    unit: str | None = None


class _Effect(_Entry):
    id: str
    parameters: dict[str, _Parameter]


class _Shape(_Entry):
    against: str
    at: list[float]
    shift: list[float]
    standard_uncertainty: list[float]
    unit: Literal["m"]


class _ResidualUncertainty(_Entry):
    constant: NonNegativeFloat
    proportional: NonNegativeFloat = 0.0
    rows: NonNegativeInt = 0
    low: NonNegativeFloat = 0.0
    high: NonNegativeFloat = 0.0
    scheme: str = ""
    step: NonNegativeFloat = 0.0
    unit: Literal["m"]


class _Smooth(_Entry):
    offset: float
    terms: list[_Shape]
    unit: Literal["m"]
    residual_uncertainty: _ResidualUncertainty | None = None


class _File(_Entry):
    schema_: str = Field(alias="schema")
    law: str
    air: dict[str, float] = {}
    effects: list[_Effect]
    covariance: list[list[float]] | None = None
    shape: _Shape | None = None
    columns: dict[str, str] = {}
    smooth: _Smooth | None = None
    residual_uncertainty: _ResidualUncertainty | None = None
    hash: str | None = None
    data: dict[str, Any] = {}


class _Model(Protocol):
    @property
    def parameter_names(self) -> tuple[str, ...]: ...
    def with_covariance(self, covariance: Any) -> Self: ...


M = TypeVar("M", bound=_Model)


def built(model: Callable[..., M], path: Path, text: str | None = None) -> M:
    """Build the model of a file; with a text, this is its content.

    Raises `ModelError` if it is no valid model, or does not match its hash; the text begins with the path.
    """
    given, covariance, listed = _read(path, text)
    try:
        bare = model(**given)
        own = arranged_covariance(covariance, listed, bare.parameter_names)
        return bare if own is None else bare.with_covariance(own)
    except ModelError as error:
        raise ModelError(f"{path}: {error}") from None


def _read(path: Path, text: str | None) -> tuple[dict[str, Any], Any, tuple[str, ...]]:
    """Return a model's arguments, its covariance, and the names of the covariance's rows."""
    try:
        document = _parse(path, text)
        _check_schema(document)
        file = _File.model_validate(document)
        arguments, covariance = _arguments(file), _covariance(file)
        _check_hash(file, document)
    except OSError as error:
        raise ModelError(f"cannot read model file {path}: {error.strerror}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        message = f"{path}: {place}: {first['msg']} (found {reprlib.repr(first['input']):.60})"
        raise ModelError(message) from None
    except UsageError as error:
        raise ModelError(f"{path}: {error}") from None
    return arguments, covariance, tuple(_uncertainties(file))


def _parse(path: Path, text: str | None) -> dict[str, Any]:
    def refuse(constant: str) -> NoReturn:
        raise ModelError(f"has {constant} for a number; a model has finite values only")

    try:
        text = path.read_text(encoding="utf-8-sig") if text is None else text
    except UnicodeDecodeError:
        raise ModelError("is not JSON, not even text") from None
    except ValueError as error:  # a NUL byte, a lone surrogate
        raise ModelError(f"cannot be the name of a file: {error}") from None
    try:
        document = json.loads(text, parse_constant=refuse, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise ModelError(f"is not JSON: line {error.lineno}, column {error.colno}: {error.msg}") from None
    except ModelError:
        raise
    except (RecursionError, ValueError) as error:  # endless nesting, thousands of digits
        raise ModelError(f"is no model: {error}") from None
    if not isinstance(document, dict):
        raise ModelError(f"is no model: expected an object of schema {SCHEMA}")
    return document


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object each of whose names occurs once."""
    names = [name for name, _ in pairs]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise ModelError(f"has '{repeated}' twice in one object; keep the one that is meant")
    return dict(pairs)


def _check_schema(document: dict[str, Any]) -> None:
    schema = document.get("schema")
    version = re.fullmatch(r"echocal\.model/(\d+)", str(schema))
    if version and len(version[1]) <= _DIGITS and int(version[1]) > NEWEST:
        message = f"written by a newer echocal: schema {schema}; this one reads up to /{NEWEST}; update"
        raise ModelError(message)
    if schema != SCHEMA:
        raise ModelError(f"schema is {reprlib.repr(schema)}; expected '{SCHEMA}'")


def _check_hash(file: _File, document: dict[str, Any]) -> None:
    found = digest(document)
    if file.hash is not None and file.hash != found:
        raise ModelError(
            f"hash is {file.hash[:12]}..., the content has {found[:12]}...: it was edited or damaged; "
            "if the edit is meant, delete the hash"
        )


def _arguments(file: _File) -> dict[str, Any]:
    ids = [effect.id for effect in file.effects]
    repeated = next((id_ for id_ in ids if ids.count(id_) > 1), None)
    if repeated:
        raise ModelError(f"effect '{repeated}' is listed twice")
    for effect in file.effects:
        _check_units(effect)
        _check_sizes(effect)
    if file.shape is not None and file.smooth is not None:
        raise ModelError("has a shape and a smooth correction; a model has one of them at most")
    return {
        "law": file.law,
        "air": file.air,
        "effects": {e.id: {n: p.value for n, p in e.parameters.items()} for e in file.effects},
        "provenance": file.data,
        "shape": _smooth(file.smooth) if file.shape is None else _shape(file.shape),
        "columns": file.columns,
        "residual_uncertainty": _residual(file.residual_uncertainty),
    }


def _shape(entry: _Shape) -> Shape:
    return Shape(entry.against, tuple(entry.at), tuple(entry.shift), tuple(entry.standard_uncertainty))


def _smooth(entry: _Smooth | None) -> Smooth | None:
    if entry is None:
        return None
    terms = tuple(_shape(term) for term in entry.terms)
    return Smooth(entry.offset, terms, _residual(entry.residual_uncertainty))


def _residual(entry: _ResidualUncertainty | None) -> ResidualUncertainty | None:
    return None if entry is None else ResidualUncertainty(**entry.model_dump(exclude={"unit"}))


def _check_units(effect: _Effect) -> None:
    units = {parameter.name: parameter.unit for parameter in find_effect(effect.id).parameters}
    for name, parameter in effect.parameters.items():
        expected = units.get(name, parameter.unit)
        if parameter.unit not in {None, expected}:
            raise ModelError(f"{effect.id}.{name} is in '{parameter.unit}'; expected '{expected}'")


def _check_sizes(effect: _Effect) -> None:
    """Refuse an effect without any of its sizes, which would do nothing."""
    sizes = [parameter for parameter in find_effect(effect.id).parameters if parameter.role == "size"]
    if sizes and not any(parameter.name in effect.parameters for parameter in sizes):
        first = sizes[0]
        raise ModelError(
            f"effect '{effect.id}' has no parameter '{first.name}', so it would change nothing; "
            f'give it: {{"{first.name}": {{"value": ..., "unit": "{first.unit}"}}}}'
        )


def _uncertainties(file: _File) -> dict[str, float | None]:
    """Standard uncertainties, in the order of the rows of the covariance.

    The parameters of an effect have the order of the registry: the names of a JSON object have none, and
    whatever sorts them must not move the rows.
    """
    return {
        f"{effect.id}.{name}": effect.parameters[name].standard_uncertainty
        for effect in file.effects
        for name in sorted(effect.parameters, key=_order_of(effect.id))
    }


def _order_of(id_: str) -> Callable[[str], int]:
    """Position of each parameter of an effect; unknown ones last, which the model refuses."""
    names = [parameter.name for parameter in find_effect(id_).parameters]
    return lambda name: names.index(name) if name in names else len(names)


def _covariance(file: _File) -> Any:
    """Return the covariance; without one, that of independent parameters with stated uncertainties."""
    stated = _uncertainties(file)
    for name, uncertainty in stated.items():
        if uncertainty is not None and uncertainty > _WIDEST:
            raise ModelError(f"{name} has standard_uncertainty {uncertainty:g}; give {_WIDEST:g} at most")
    known = {name: u for name, u in stated.items() if u is not None}
    if file.covariance is not None:
        for (name, uncertainty), variance in zip(stated.items(), _diagonal(file.covariance), strict=False):
            if uncertainty is not None and not np.isclose(variance, uncertainty**2, rtol=1e-6, atol=0.0):
                raise ModelError(f"{name} has standard_uncertainty {uncertainty:g} but variance {variance:g}")
        return file.covariance  # its shape is checked against the model's parameters
    if known and len(known) < len(stated):
        unstated = next(name for name in stated if name not in known)
        message = f"{unstated} has no standard_uncertainty while others have; state it (0 if it was held)"
        raise ModelError(message)
    return np.diag(np.square(list(known.values()))) if known else None


def _diagonal(matrix: list[list[float]]) -> list[float]:
    return [row[position] for position, row in enumerate(matrix) if position < len(row)]
