"""Model files, schema ``echocal.model/1``: what is written and what its hash covers."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echocal.errors import ModelError, UsageError
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape, Smooth
from echocal.outputs import replace_text
from echocal.registry import find_effect

NEWEST = 1
SCHEMA = f"echocal.model/{NEWEST}"


class _Described(Protocol):
    """What a file holds of a model."""

    air: Mapping[str, float]
    effects: Mapping[str, Mapping[str, float]]
    shape: Shape | Smooth | None
    covariance: NDArray[np.float64] | None
    provenance: Mapping[str, Any]
    residual_uncertainty: ResidualUncertainty | None

    @property
    def law(self) -> str: ...
    @property
    def columns(self) -> dict[str, str]: ...
    @property
    def standard_uncertainties(self) -> dict[str, float | None]: ...


def content(model: _Described) -> dict[str, Any]:
    """Return what the hash covers: all that the model computes with."""
    uncertainties = model.standard_uncertainties

    def parameters(id_: str) -> dict[str, Any]:
        return {
            p.name: {
                "value": model.effects[id_][p.name],
                "standard_uncertainty": uncertainties[f"{id_}.{p.name}"],
                "unit": p.unit,
            }
            for p in find_effect(id_).parameters
        }

    kind = "smooth" if isinstance(model.shape, Smooth) else "shape"
    shape = {} if model.shape is None else {kind: model.shape.to_dict()}
    columns = {"columns": model.columns} if model.columns else {}
    residual = model.residual_uncertainty
    measured = {} if residual is None else {"residual_uncertainty": residual.to_dict()}
    return {
        "schema": SCHEMA,
        "law": model.law,
        "air": model.air,
        "effects": [{"id": id_, "parameters": parameters(id_)} for id_ in model.effects],
        "covariance": None if model.covariance is None else model.covariance.tolist(),
        **shape,
        **columns,
        **measured,
    }


def digest(document: dict[str, Any]) -> str:
    """SHA-256 of a document in canonical form, without its hash and provenance."""
    return sha256({key: value for key, value in document.items() if key not in {"hash", "data"}})


def sha256(data: Any) -> str:
    """SHA-256 of plain data in canonical form.

    Raises `TypeError`, `ValueError` if it is not plain data with finite numbers.
    """
    canonical = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def to_plain(model: _Described) -> dict[str, Any]:
    """A model as its file has it, schema ``echocal.model/1``, with its hash."""
    document = content(model)
    return {**document, "hash": digest(document), "data": model.provenance}


def text_of(model: _Described) -> str:
    """A model's file as text.

    Raises `TypeError`, `ValueError`, `RecursionError` if its provenance is not plain data with finite
    numbers.
    """
    text = json.dumps(to_plain(model), indent=1, allow_nan=False, ensure_ascii=False)
    text.encode()  # a lone surrogate cannot be
    return text + "\n"


def write(model: _Described, path: Path) -> None:
    """Write a model's file."""
    try:
        text = text_of(model)
    except (TypeError, ValueError, RecursionError) as error:
        message = f"cannot write {path}: the provenance is not plain data with finite numbers ({error})"
        raise ModelError(message) from None
    try:
        replace_text(path, text)
    except UsageError as error:
        raise ModelError(str(error)) from None
