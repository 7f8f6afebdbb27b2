"""Who runs the tasks: this process, or a pool of processes. Results come in any order."""

import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Protocol

from echocal.correct.task import run_task

__all__ = ["Executor", "Here", "Processes"]

Task = Mapping[str, Any]
Result = dict[str, Any]

_TRIES = 3
"""How often a task is begun whose process dies."""


class Executor(Protocol):
    """Runs tasks; `echocal.correct.driver` needs no more of an engine than this."""

    def run(self, tasks: Iterable[Task], progress: Callable[[int], None]) -> Iterator[Result]:
        """Results of tasks as they come; `progress` is told the rows that are done."""
        ...


class Here:
    """One task after the other in this process; a task uses several threads."""

    def run(self, tasks: Iterable[Task], progress: Callable[[int], None]) -> Iterator[Result]:
        """Run tasks."""
        for task in tasks:
            yield run_task(task, progress)


class Processes:
    """Several processes of this machine, each with one task at a time.

    Parameters
    ----------
    count : int
        Number of processes. They are started anew and not copied from this one, whose threads may hold locks.
    """

    def __init__(self, count: int) -> None:
        self._count = count

    def run(self, tasks: Iterable[Task], progress: Callable[[int], None]) -> Iterator[Result]:
        """Run tasks; one whose process dies is begun again, up to three times."""
        queue = [(task, 1) for task in reversed(list(tasks))]
        while queue:
            pool = ProcessPoolExecutor(self._count, mp_context=multiprocessing.get_context("spawn"))
            running: dict[Future[Result], tuple[Task, int]] = {}
            broken = False
            try:
                while (queue or running) and not broken:
                    while queue and len(running) < 2 * self._count:
                        task, tries = queue.pop()
                        running[pool.submit(run_task, task)] = task, tries
                    done, _ = wait(running, return_when=FIRST_COMPLETED)
                    for future in done:
                        task, tries = running.pop(future)
                        try:
                            result = future.result()
                        except BrokenProcessPool:
                            broken = True
                            running[future] = task, tries
                            break
                        progress(result.get("rows", 0))
                        yield result
                for task, tries in running.values():
                    if tries < _TRIES:
                        queue.append((task, tries + 1))
                    else:
                        yield _died(task)
            except BrokenProcessPool:
                queue += [(task, tries + 1) for task, tries in running.values()]
            finally:
                pool.shutdown(cancel_futures=True)


def _died(task: Task) -> Result:
    text = f"{task['source']}: the process that corrected it ended {_TRIES} times; too little memory?"
    return {
        "schema": "echocal.task_result/1",
        "source": task["source"],
        "target": task["target"],
        "error": {"kind": "ProcessDied", "text": text},
        "seconds": 0.0,
    }
