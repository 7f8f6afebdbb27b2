"""``df.echocal`` and ``ds.echocal``: registered when their library is there, before or after this package."""

import sys
from collections.abc import Callable
from importlib.machinery import ModuleSpec
from typing import Any

__all__ = ["register"]


def _of(table: Any) -> Any:
    """The verbs of a table; what they need is imported when they are asked for."""
    from echocal.accessor import Accessor

    return Accessor(table)


_LIBRARIES: dict[str, Callable[[Any], object]] = {
    "pandas": lambda library: library.api.extensions.register_dataframe_accessor("echocal")(_of),
    "xarray": lambda library: library.register_dataset_accessor("echocal")(_of),
}


class _Afterwards:
    """Finds no module itself: it registers the accessor when a library has been imported."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if name not in _LIBRARIES:
            return None
        others = (own for own in sys.meta_path if own is not _AFTERWARDS and hasattr(own, "find_spec"))
        spec = next((found for own in others if (found := own.find_spec(name, path, target))), None)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: Any) -> None:
                execute(module)
                _LIBRARIES[name](module)

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec


_AFTERWARDS = _Afterwards()


def register() -> None:
    """Register the accessors of what is imported already, and of what will be; nothing is imported here."""
    for name, own in _LIBRARIES.items():
        if name in sys.modules:
            own(sys.modules[name])
    if not any(isinstance(one, _Afterwards) for one in sys.meta_path):
        sys.meta_path.insert(0, _AFTERWARDS)
