"""Docstrings of compiled functions: the stub has their types, the module has their text."""

from typing import Any

import griffe

import echocal._core as core

__all__ = ["CompiledDocstrings"]


class CompiledDocstrings(griffe.Extension):
    """Give each function of the stub the docstring of the compiled one."""

    def on_function_instance(self, *, func: griffe.Function, **_: Any) -> None:
        """Look a function up in the compiled module."""
        text = getattr(getattr(core, func.name, None), "__doc__", None)
        if func.path.startswith("echocal._core.") and text and not func.docstring:
            func.docstring = griffe.Docstring(text.strip(), parent=func)
