"""Linear algebra on one thread.

The matrices of a diagnosis are small. Threads of a BLAS then wait for each other most of the time, and the
last bits of a sum depend on how many there are.
"""

from contextlib import ContextDecorator
from functools import cache
from threading import Lock
from typing import Any

__all__ = ["one_thread"]


class one_thread(ContextDecorator):  # noqa: N801  # used like a function
    """Let the libraries of NumPy and SciPy work on one thread; also a decorator.

    It ends with the last of several diagnoses side by side. A library may not follow it in a thread other
    than the first; the diagnosis is then slower, and as right.
    """

    _lock = Lock()
    _inside = 0
    _limit: Any = None

    def __enter__(self) -> None:
        own = type(self)
        with own._lock:
            if own._inside == 0:
                own._limit = _libraries().limit(limits=1, user_api="blas")
            own._inside += 1

    def __exit__(self, *_: object) -> None:
        own = type(self)
        with own._lock:
            own._inside -= 1
            if own._inside == 0:
                own._limit.restore_original_limits()


@cache
def _libraries() -> Any:
    import scipy.linalg  # noqa: F401  # loads the library that is looked for
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
