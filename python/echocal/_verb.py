"""A module that is called like the function it is named after: ``echocal.correct(table, model)``.

The function would hide its module, and the module its function: this is both.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from inspect import Signature, signature
from types import ModuleType
from typing import Any

__all__ = ["callable_as"]


class _Verb(ModuleType):
    """What ``echocal.correct`` is: the function when it is called, and the module of the same name."""

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        function: Callable[..., Any] = vars(self)[self.__name__.rpartition(".")[2]]
        return function

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*args, **keywords)

    @property
    def __signature__(self) -> Signature:
        return signature(self.__wrapped__)

    @property
    def __doc__(self) -> str | None:  # type: ignore[override]
        return self.__wrapped__.__doc__

    def __reduce__(self) -> tuple[Any, ...]:
        """Travel by name, as functions do: a pool of processes may be given it."""
        return import_module, (self.__name__,)


def callable_as(module: str) -> None:
    """Let a module, by its ``__name__``, be called like its function of the same name, which it has."""
    sys.modules[module].__class__ = _Verb
