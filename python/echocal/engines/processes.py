"""Processes of this machine: one task at a time in each, with one thread.

They are started anew and not copied from this process, whose threads may hold locks.
"""

import multiprocessing
import os
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait as wait_for
from typing import Any

from echocal.engines.engine import Result, Task, Work

__all__ = ["ONE_THREAD", "Processes", "processors"]

ONE_THREAD = {
    "ECHOCAL_NUM_THREADS": "1",
    "POLARS_MAX_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a process that shares its machine with others of its kind."""

_TWICE = 2  # times that a task may lose its worker


def processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


class Processes:
    """Several processes of this machine.

    Parameters
    ----------
    count : int
        Number of processes.
    """

    inside = False

    def __init__(self, count: int) -> None:
        self._count = count
        self.name = f"{count} processes"

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks. Those that were running when a process was killed are run again, one after the other."""
        left = dict(enumerate(tasks))
        lost: Counter[int] = Counter()
        while left:
            suspects = {number: task for number, task in left.items() if lost[number]}
            for number, result in self._one_pool(work, suspects or dict(left), alone=bool(suspects)):
                lost[number] += result is None
                if result is not None or lost[number] >= _TWICE:
                    yield left.pop(number), result

    def ask(self, question: Callable[..., Any], *given: Any) -> dict[str, Any]:
        """Nobody to ask: the processes run the same files."""
        return {}

    def _one_pool(
        self, work: Work, tasks: Mapping[int, Task], *, alone: bool
    ) -> Iterator[tuple[int, Result | None]]:
        """Run tasks until all are done or a process is killed; None then for those that were running."""
        count = 1 if alone else min(self._count, len(tasks))
        ahead = 1 if alone else 2 * count
        with _environment(ONE_THREAD):
            context = multiprocessing.get_context("spawn")
            pool = ProcessPoolExecutor(count, mp_context=context, initializer=_end_with_parent)
            try:
                coming = iter(tasks.items())
                running: dict[Future[Result], int] = {}
                while True:
                    while len(running) < ahead and (following := next(coming, None)) is not None:
                        running[pool.submit(work, following[1])] = following[0]
                    if not running:
                        return
                    done, _ = wait(running, return_when=FIRST_COMPLETED)
                    for future in done:
                        result = future.result()
                        yield running.pop(future), result
            except BrokenProcessPool:
                for future, number in running.items():
                    whole = future.done() and future.exception() is None
                    yield number, future.result() if whole else None
            finally:
                pool.shutdown(wait=True, cancel_futures=True)


def _end_with_parent() -> None:
    """End this process with the run; else it would wait for ever, or write into the run that follows."""
    parent = multiprocessing.parent_process()
    assert parent is not None  # a process of a pool

    def watch() -> None:
        wait_for([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="end with parent", daemon=True).start()


@contextmanager
def _environment(more: Mapping[str, str]) -> Iterator[None]:
    """Processes that are started meanwhile have these variables."""
    before = {name: os.environ.get(name) for name in more}
    os.environ.update(more)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
