"""End without a traceback after Ctrl-C, also while the command line is still being imported.

A request to terminate ends a program in the same way: it unwinds, so that nothing unfinished stays behind.
"""

import signal
import sys
import threading
from types import FrameType, TracebackType

__all__ = ["Terminated", "unwind_when_told"]

_REQUESTS = ("SIGTERM", "SIGHUP", "SIGBREAK")
"""Of a service manager, of a terminal that is closed, of Windows."""


class Terminated(SystemExit):
    """The end that another program asked for; its code is that of a shell."""


def unwind_when_told(*more: str) -> None:
    """Let requests to terminate raise `Terminated`; those that are ignored, as after nohup, stay so.

    Parameters
    ----------
    *more : str
        Further signals that do.
    """
    if threading.current_thread() is not threading.main_thread():
        return  # where no signal arrives
    numbers = [number for name in (*_REQUESTS, *more) if (number := getattr(signal, name, None)) is not None]
    handled = [number for number in numbers if signal.getsignal(number) is not signal.SIG_IGN]

    def stop(number: int, _: FrameType | None) -> None:
        for own in handled:
            signal.signal(own, signal.SIG_IGN)  # a second request would interrupt the cleaning
        raise Terminated(128 + number)

    for number in handled:
        signal.signal(number, stop)


def _quietly(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


def _named(word: str) -> bool:
    """Whether a word is the script, or the module after -m; without an import that takes time."""
    return word.replace("\\", "/").rpartition("/")[2].removesuffix(".exe") == "echocal"


if any(map(_named, sys.orig_argv[1:3])):
    sys.excepthook = _quietly
