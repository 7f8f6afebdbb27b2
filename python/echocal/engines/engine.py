"""What an engine is, and the simplest one: this process, one task after the other."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

Task = Mapping[str, Any]
Result = dict[str, Any]
Work = Callable[[Task], Result]


class Engine(Protocol):
    """Runs tasks, each at least once."""

    name: str  # as a message says it: "Dask scheduler tcp://10.0.0.5:8786"
    inside: bool  # whether tasks run in this process, so that they can tell how far they are

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Each task with its result, as they end; None of a task that keeps losing its worker.

        What `work` raises ends the run. It is a function of a module, which workers import; tasks are plain
        data.
        """
        ...

    def ask(self, question: Callable[..., Any], *given: Any) -> dict[str, Any]:
        """The answer of each worker by its name; an exception where it raised one.

        Empty where all workers are of this installation and of this machine.
        """
        return {}


class Here(Engine):
    """The process itself."""

    name = "this process"
    inside = True

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks."""
        for task in tasks:
            yield task, work(task)
