"""End without a traceback after Ctrl-C, also while the command line is still being imported."""

import sys
from types import TracebackType


def _quietly(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


def _named(word: str) -> bool:
    """Whether a word is the script, or the module after -m; without an import that takes time."""
    return word.replace("\\", "/").rpartition("/")[2].removesuffix(".exe") == "echocal"


if any(map(_named, sys.orig_argv[1:3])):
    sys.excepthook = _quietly
