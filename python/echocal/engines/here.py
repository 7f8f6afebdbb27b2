"""The process itself: one task after the other. A task may use several threads."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from echocal.engines.engine import Result, Task, Work

__all__ = ["Here"]


class Here:
    """The process itself."""

    name = "this process"
    inside = True

    def run(self, work: Work, tasks: Sequence[Task]) -> Iterator[tuple[Task, Result | None]]:
        """Run tasks."""
        for task in tasks:
            yield task, work(task)

    def ask(self, question: Callable[..., Any], *given: Any) -> dict[str, Any]:
        """Nobody to ask."""
        return {}
