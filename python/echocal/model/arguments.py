"""What a model is built from: effects, a law that moves, numbers of a call."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from echocal.conditions import numbers
from echocal.errors import ModelError
from echocal.registry import find_effect

__all__ = ["apart", "by_name", "numeric", "refuse_no_text", "refuse_standstill", "terms"]


def terms(effects: Mapping[str, Mapping[str, float]]) -> list[tuple[str, list[tuple[str, float]]]]:
    """Return effects in the form that the core takes, or raise `ModelError`."""
    if not isinstance(effects, Mapping) or not all(isinstance(own, Mapping) for own in effects.values()):
        message = (
            f"effects map an id to its parameters, e.g. {{'fixed_delay': {{'delay': 3e-5}}}}; got {effects!r}"
        )
        raise ModelError(message)
    for id_, own in effects.items():
        for name, value in own.items():
            if isinstance(value, str) or not hasattr(value, "__float__"):
                message = f"{id_}.{name} is {value!r}; give a number"
                raise ModelError(message)
    return [(id_, list(own.items())) for id_, own in effects.items()]


def numeric(name: str, given: Any) -> Any:
    """Real numbers: as they are where a ufunc keeps their type, else as an array of their own."""
    kind = getattr(getattr(given, "dtype", None), "kind", "f")
    typed = hasattr(given, "__array_ufunc__") and not isinstance(given, np.ma.MaskedArray)
    if isinstance(given, float | int) or (typed and kind in "biuf"):
        return given
    return numbers(name, given)


def apart(given: Mapping[str, Any]) -> tuple[dict[str, Any], Any, Any]:
    """Conditions among keywords, and the two that are none: `out` and `n_threads`.

    Callers unpack tables into the conditions.
    """
    named = {name: value for name, value in given.items() if name not in {"out", "n_threads"}}
    return named, given.get("out"), given.get("n_threads")


def refuse_no_text(law: object) -> None:
    """Raise `ModelError` where a law is given by no text."""
    if not isinstance(law, str):
        message = f"the law is {law!r}; give a name ('cramer') or an expression ('331.3+0.606*T')"
        raise ModelError(message)


def refuse_standstill(law: str) -> None:
    """Raise `ModelError` where a law is a constant that is no speed."""
    try:
        speed = float(law)
    except ValueError:
        return  # depends on the air
    if speed <= 0.0:
        message = f"law '{law}' is a speed of {speed:g} m/s; give a positive one, such as '343'"
        raise ModelError(message)


def by_name(id_: str, values: list[float]) -> dict[str, float]:
    """Return an effect's parameters by name."""
    names = (parameter.name for parameter in find_effect(id_).parameters)
    return dict(zip(names, values, strict=True))
