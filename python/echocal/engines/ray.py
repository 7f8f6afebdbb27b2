"""Ray on this machine, for the time of a run."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from echocal.engines.engine import Engine, Result, Task, Work
from echocal.engines.worker import ONE_THREAD
from echocal.errors import UsageError

_RETRIES = 3
"""How often Ray begins a task again whose worker dies."""


class _Ray:
    inside = False

    def __init__(self, ray: Any, name: str) -> None:
        self._ray = ray
        self.name = name

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks; Ray begins one again whose worker dies, and gives it up after the fourth time."""
        ray = self._ray
        remote = ray.remote(max_retries=_RETRIES, num_cpus=1)(_done(work))
        coming = deque(tasks)
        running: dict[Any, Task] = {}
        while coming or running:
            while coming and len(running) < max(2 * int(ray.cluster_resources().get("CPU", 1)), 2):
                task = coming.popleft()
                running[remote.remote(task)] = task
            done, _ = ray.wait(list(running), num_returns=1)
            for reference in done:
                task = running.pop(reference)
                try:
                    result = ray.get(reference)
                except (ray.exceptions.WorkerCrashedError, ray.exceptions.OutOfMemoryError):
                    result = None
                except ray.exceptions.RayTaskError as error:
                    raise error.cause from None
                except ray.exceptions.RayError as error:
                    raise UsageError(
                        f"{self.name} is gone ({error}); what is complete stays: run again when it is back"
                    ) from None
                yield task, result

    def ask(self, question: Callable[..., Any], *given: Any) -> dict[str, Any]:
        """Ask a worker of every node."""
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

        ray = self._ray
        asked = {}
        for node in ray.nodes():
            if node["Alive"] and node["Resources"].get("CPU"):
                here = NodeAffinitySchedulingStrategy(node["NodeID"], soft=False)
                remote = ray.remote(scheduling_strategy=here, num_cpus=0, max_retries=0)(_done(question))
                asked[node["NodeManagerHostname"] + " " + node["NodeID"][:8]] = remote.remote(*given)
        return {name: self._answer(reference) for name, reference in asked.items()}

    def _answer(self, reference: Any) -> Any:
        try:
            return self._ray.get(reference)
        except self._ray.exceptions.RayTaskError as error:
            return error.cause
        except self._ray.exceptions.RayError as error:
            return error


def _done(work: Callable[..., Any]) -> Callable[..., Any]:
    """A plain function that Ray takes, for one that it does not take: a builtin."""

    def call(*given: Any) -> Any:
        return work(*given)

    return call


@contextmanager
def local_cluster(workers: int) -> Iterator[Engine]:
    """Start a cluster of this machine, for the time of a block."""
    ray = _ray()
    ray.init(
        "local",
        num_cpus=workers,
        include_dashboard=False,
        log_to_driver=False,
        logging_level="error",
        runtime_env={"env_vars": ONE_THREAD},
    )
    try:
        yield _Ray(ray, f"Ray on this machine ({workers} workers)")
    finally:
        ray.shutdown()


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        raise UsageError("Ray is not installed; pip install 'echocal[ray]'") from None
    return ray
