"""Processes of this machine: one task at a time in each, with one thread."""

import os
from collections import deque
from collections.abc import Iterator, Sequence

from echocal.engines.engine import Engine, Result, Task, Work
from echocal.engines.worker import Worker


def processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


class Processes(Engine):
    """Several processes of this machine, which run the same files."""

    inside = False

    def __init__(self, count: int) -> None:
        self._count = count
        self.name = f"{count} processes"

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks. One whose process is killed is run again at the end, with no other beside it."""
        lost = []
        for number, result in _run(work, dict(enumerate(tasks)), self._count):
            if result is None:
                lost.append(number)
            else:
                yield tasks[number], result
        for alone in lost:
            for number, result in _run(work, {alone: tasks[alone]}, 1):
                yield tasks[number], result


def _run(work: Work, tasks: dict[int, Task], count: int) -> Iterator[tuple[int, Result | None]]:
    """Each task with its result, as they end; None if its process was killed."""
    left = deque(tasks.items())
    workers = [Worker(work) for _ in range(min(count, len(left)))]
    try:
        for worker in workers:
            worker.begin(*left.popleft())
        while busy := [worker for worker in workers if worker.number is not None]:
            ended = []
            for worker in Worker.ready(busy):
                number, result = worker.number, worker.end()
                assert number is not None
                ended.append((number, result))
                if left and result is None:
                    worker.close()
                    workers[workers.index(worker)] = worker = Worker(work)
                if left:
                    worker.begin(*left.popleft())
            yield from ended
    finally:
        for worker in workers:
            worker.close()
        for worker in workers:
            worker.join()
