"""The search for reference cycles waits until a diagnosis has ended.

A diagnosis makes some 10^5 small objects and no cycle among large ones. CPython looks at all objects of the
process each time that some thousands are new: a tenth of the time for 1,000 rows.
"""

import gc
from contextlib import ContextDecorator
from threading import Lock

__all__ = ["no_cycle_search"]


class no_cycle_search(ContextDecorator):  # noqa: N801  # used like a function
    """Switch the cyclic garbage collector off; also a decorator.

    Objects without cycles are freed as always. It ends with the last of several diagnoses side by side. A
    collector that the caller switched off stays off.
    """

    _lock = Lock()
    _inside = 0
    _was_enabled = False

    def __enter__(self) -> None:
        own = type(self)
        with own._lock:
            if own._inside == 0:
                own._was_enabled = gc.isenabled()
                gc.disable()
            own._inside += 1

    def __exit__(self, *_: object) -> None:
        own = type(self)
        with own._lock:
            own._inside -= 1
            if own._inside == 0 and own._was_enabled:
                gc.enable()
