"""End without a traceback after Ctrl-C, also while the command line is still being imported.

A request to terminate ends a program in the same way: it unwinds, so that nothing unfinished stays behind.
"""

import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType

__all__ = ["Terminated", "after_imports", "stop_if_told", "unwind_when_told"]

Handler = Callable[[int, FrameType | None], None]

_REQUESTS = ("SIGTERM", "SIGHUP", "SIGBREAK")
"""Of a service manager, of a terminal that is closed, of Windows."""

_SAME = 2.0
"""Time in which a second request is the first one, sent to a process and to its group [s]; judgement."""

_SOON = 0.01  # s, until a request that came during an import is looked at again

_told: list[tuple[float, int]] = []
"""When this process was asked to end, and by which signal."""


class Terminated(SystemExit):
    """The end that another program asked for; its code is that of a shell."""


def unwind_when_told(*more: str) -> None:
    """Let requests to terminate, and further signals, raise `Terminated`; those that are ignored stay so."""
    if threading.current_thread() is not threading.main_thread():
        return  # where no signal arrives
    numbers = [number for name in (*_REQUESTS, *more) if (number := getattr(signal, name, None)) is not None]
    for number in numbers:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, after_imports(_stop))


def after_imports(handler: Handler) -> Handler:
    """Handle a signal once no import is under way.

    What is imported may swallow an exception, and its locks would stay closed to other threads.
    """

    def handle(number: int, frame: FrameType | None) -> None:
        if _is_importing(frame) and hasattr(signal, "setitimer"):
            signal.signal(signal.SIGALRM, lambda _, then: handle(number, then))
            signal.setitimer(signal.ITIMER_REAL, _SOON)
        else:
            handler(number, frame)

    return handle


def stop_if_told() -> None:
    """Raise `Terminated` once more, if this process was asked to end.

    A library that is called meanwhile may swallow it, or raise another error in its place.
    """
    if _told:
        raise Terminated(128 + _told[0][1])


def _stop(number: int, _frame: FrameType | None) -> None:
    now = time.monotonic()
    if _told and now - _told[-1][0] < _SAME:
        return  # it would interrupt the cleaning
    _told.append((now, number))
    stop_if_told()


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _quietly(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


def _named(word: str) -> bool:
    """Whether a word is the script, or the module after -m; without an import that takes time."""
    return word.replace("\\", "/").rpartition("/")[2].removesuffix(".exe") == "echocal"


if any(map(_named, sys.orig_argv[1:3])):
    sys.excepthook = _quietly
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, after_imports(signal.default_int_handler))
