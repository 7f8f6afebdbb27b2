"""What a model is built from: effects, a law that moves, numbers of a call, a covariance."""

from collections.abc import Mapping
from typing import Any, Never, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.conditions import numbers
from echocal.errors import ModelError
from echocal.registry import find_effect

_ROUNDING = 1e-9  # relative asymmetry that a solver may leave

K = TypeVar("K")
V = TypeVar("V")


def terms(effects: Mapping[str, Mapping[str, float]]) -> list[tuple[str, list[tuple[str, float]]]]:
    """Return effects in the form that the core takes, or raise `ModelError`."""
    if not isinstance(effects, Mapping) or not all(isinstance(own, Mapping) for own in effects.values()):
        raise ModelError(
            f"effects map an id to its parameters, e.g. {{'fixed_delay': {{'delay': 3e-5}}}}; got {effects!r}"
        )
    for id_, own in effects.items():
        for name, value in own.items():
            if isinstance(value, str) or not hasattr(value, "__float__"):
                raise ModelError(f"{id_}.{name} is {value!r}; give a number")
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
        raise ModelError(f"the law is {law!r}; give a name ('cramer') or an expression ('331.3+0.606*T')")


def refuse_standstill(law: str) -> None:
    """Raise `ModelError` where a law is a constant that is no speed."""
    try:
        speed = float(law)
    except ValueError:
        return  # depends on the air
    if speed <= 0.0:
        raise ModelError(f"law '{law}' is a speed of {speed:g} m/s; give a positive one, such as '343'")


def by_name(id_: str, values: list[float]) -> dict[str, float]:
    """Return an effect's parameters by name."""
    names = (parameter.name for parameter in find_effect(id_).parameters)
    return dict(zip(names, values, strict=True))


class Fixed(dict[K, V]):
    """A dict that cannot be edited; it compares, prints, copies and pickles as a dict does.

    Examples
    --------
    >>> values = Fixed({"delay": 3e-5})
    >>> values["delay"] = 0.0
    Traceback (most recent call last):
    echocal.errors.ModelError: a model does not change; build another one, such as Model(model.law, {...})
    """

    def _refuse(self, *_: object, **__: object) -> Never:
        raise ModelError("a model does not change; build another one, such as Model(model.law, {...})")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)


def fixed(mapping: Mapping[str, Any]) -> Fixed[str, Any]:
    """Return a mapping, and those inside it, as they are now."""
    return Fixed({key: fixed(own) if isinstance(own, Mapping) else own for key, own in mapping.items()})


def checked_covariance(given: ArrayLike | None, names: tuple[str, ...]) -> NDArray[np.float64] | None:
    """Return the covariance of these parameters if it can be one."""
    if given is None:
        return None
    count = len(names)
    try:
        matrix = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        message = f"covariance is no table of {count} rows of {count} numbers each: {', '.join(names)}"
        raise ModelError(message) from None
    if matrix.size == count == 0:
        return np.zeros((0, 0))
    if matrix.shape != (count, count):
        message = f"covariance has shape {matrix.shape}; the model has {count} parameters: {', '.join(names)}"
        raise ModelError(message)
    if not np.isfinite(matrix).all():
        raise ModelError("covariance has values that are not finite numbers")
    variances = np.diag(matrix)
    if (variances < 0.0).any():
        message = f"covariance gives {names[int(np.argmin(variances))]} the variance {variances.min():g} < 0"
        raise ModelError(message)
    scale = np.sqrt(variances)
    with np.errstate(over="ignore"):
        apart = np.abs(matrix - matrix.T)
    if (apart > _ROUNDING * np.multiply.outer(scale, scale)).any():
        raise ModelError("covariance is not symmetric")
    matrix.setflags(write=False)
    return matrix


def arranged_covariance(
    given: ArrayLike | None, listed: tuple[str, ...], names: tuple[str, ...]
) -> NDArray[np.float64] | None:
    """Return a covariance of listed parameters in the order of names; those not listed were held fixed."""
    matrix = checked_covariance(given, listed)
    if matrix is None:
        return None
    whole = np.zeros((len(names), len(names)))
    places = [names.index(name) for name in listed]
    whole[np.ix_(places, places)] = matrix
    whole.setflags(write=False)
    return whole
