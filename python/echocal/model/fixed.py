"""Mappings that do not change: what a model is made of."""

from collections.abc import Mapping
from typing import Any, Never, TypeVar

from echocal.errors import ModelError

__all__ = ["Fixed", "fixed"]

K = TypeVar("K")
V = TypeVar("V")


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
