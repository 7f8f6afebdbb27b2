"""Dask: a scheduler that runs already, or one on this machine for the time of a run."""

import re
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from echocal.engines.engine import Engine, Result, Task, Work
from echocal.engines.worker import ONE_THREAD
from echocal.errors import UsageError

_CONNECT = 10.0
"""Time that a scheduler has to answer [s]; judgement."""

_WITHOUT_WORKERS = 60.0
"""Time that a scheduler may have no worker before the run ends [s]: what restarts workers takes less."""

_LOOK = 5.0
"""Time between two looks whether there are workers [s]."""


class _Dask:
    inside = False

    def __init__(self, client: Any, name: str, patience: float = _WITHOUT_WORKERS) -> None:
        self._client = client
        self._patience = patience
        self.name = name

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks. Those that Dask gives up, because workers die of them, are run again, each alone."""
        suspects: list[Task] = []
        for task, result in self._all(work, tasks, alone=False):
            if result is None:
                suspects.append(task)
            else:
                yield task, result
        yield from self._all(work, suspects, alone=True)

    def ask(self, question: Callable[..., Any], *given: Any) -> dict[str, Any]:
        """Ask every worker that is there."""
        found: dict[str, Any] = self._client.run(question, *given, on_error="return")
        return found

    def _all(self, work: Work, tasks: Sequence[Task], *, alone: bool) -> Iterator[tuple[Task, Result | None]]:
        distributed = _distributed()
        coming = deque(tasks)
        running: dict[Any, Task] = {}
        seen = time.monotonic()
        with self._whole_errors():
            while coming or running:
                threads = sum(self._client.nthreads().values())
                while coming and len(running) < (1 if alone else max(2 * threads, 2)):
                    task = coming.popleft()
                    running[self._client.submit(work, task, pure=False)] = task
                try:
                    with self._client.as_current():
                        done = distributed.wait(list(running), _LOOK, "FIRST_COMPLETED").done
                except TimeoutError:
                    done = set()
                if threads or done:
                    seen = time.monotonic()
                elif time.monotonic() - seen > self._patience:
                    raise UsageError(
                        f"{self.name} has no workers any more; what is complete stays: run again when there "
                        "are workers"
                    )
                for future in done:
                    task = running.pop(future)
                    try:
                        result = future.result()
                    except distributed.KilledWorker:
                        result = None
                    yield task, result

    @contextmanager
    def _whole_errors(self) -> Iterator[None]:
        """Say in this project's words that the scheduler is gone."""
        from concurrent.futures import CancelledError

        try:
            yield
        except (CancelledError, OSError) as error:
            raise UsageError(
                f"{self.name} is gone ({error}); what is complete stays: run again when it is back"
            ) from None


@contextmanager
def scheduler(address: str) -> Iterator[Engine]:
    """Connect to a scheduler at HOST:PORT. Raises `UsageError` if it does not answer, or has no worker."""
    distributed = _distributed()
    name = f"Dask scheduler {address}"
    if not re.fullmatch(r".+:\d+", address):
        raise UsageError(f"dask://{address} is no address; it is dask://HOST:PORT")
    try:
        client = distributed.Client(f"tcp://{address}", timeout=_CONNECT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UsageError(f"no {name} answers: {error}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_CONNECT)
        except TimeoutError:
            raise UsageError(f"{name} has no workers; start some: dask worker tcp://{address}") from None
        yield _Dask(client, name)


@contextmanager
def local_cluster(workers: int) -> Iterator[Engine]:
    """Start a scheduler and workers on this machine, for the time of a block."""
    distributed = _distributed()
    cluster = distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        dashboard_address="127.0.0.1:0",
        env=ONE_THREAD,
        memory_limit=0,
    )
    with cluster, distributed.Client(cluster, set_as_default=False) as client:
        yield _Dask(client, f"Dask on this machine ({workers} workers)")


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise UsageError("Dask is not installed; pip install 'echocal[dask]'") from None
    return distributed
