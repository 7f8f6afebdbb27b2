"""Run tasks on all processors: one process each, one thread in each."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

__all__ = ["processors", "run_all"]

Task = Mapping[str, Any]
Run = Callable[[Task], dict[str, Any]]

_THREADS = (
    "ECHOCAL_NUM_THREADS",
    "POLARS_MAX_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
)
_TWICE = 2  # times that a task may lose its worker


def processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


def run_all(run: Run, tasks: Sequence[Task], workers: int) -> Iterator[tuple[Task, dict[str, Any] | None]]:
    """Run tasks in processes, and yield each with its result as it ends.

    One worker is this process itself. If one of several is killed, its task is run again alone. A task that
    loses its worker even alone yields None.
    """
    if workers == 1:
        for task in tasks:
            yield task, run(task)
        return
    left = list(tasks)
    lost: dict[int, int] = {}
    while left:
        suspects = [task for task in left if lost.get(task["number"], 0)]
        few = suspects[:1] if suspects else left
        for task, result in _one_pool(run, few, 1 if suspects else workers):
            if result is not None:
                left = [other for other in left if other is not task]
                yield task, result
            else:
                lost[task["number"]] = lost.get(task["number"], 0) + 1
                if suspects and lost[task["number"]] >= _TWICE:
                    left = [other for other in left if other is not task]
                    yield task, None


def _one_pool(run: Run, tasks: Sequence[Task], workers: int) -> Iterator[tuple[Task, dict[str, Any] | None]]:
    """Run tasks until all are done or a worker is killed; then yield those that were running with None."""
    context = multiprocessing.get_context("spawn")
    with _single_threads():
        pool = ProcessPoolExecutor(min(workers, len(tasks)), mp_context=context)
        try:
            waiting: dict[Future[dict[str, Any]], Task] = {}
            coming = iter(tasks)
            for task in coming:
                waiting[pool.submit(run, task)] = task
                if len(waiting) >= 2 * workers:
                    break
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    task = waiting.pop(future)
                    try:
                        yield task, future.result()
                    except BrokenProcessPool:
                        yield task, None
                        for other in waiting.values():
                            yield other, None
                        return
                    following = next(coming, None)
                    if following is not None:
                        try:
                            waiting[pool.submit(run, following)] = following
                        except BrokenProcessPool:  # the next result tells
                            continue
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _single_threads() -> Iterator[None]:
    """Workers that are started meanwhile use one thread each."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
