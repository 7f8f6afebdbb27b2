"""Progress: of a run over files, share done, rows per second, time left; of what is counted, the share."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from echocal.cli._console import Console
from echocal.correct.driver import Progress as State


def bar(quiet: bool, *columns: ProgressColumn) -> Progress:
    """Progress bar on a terminal with what it does, the bar and further columns; none in a log or a pipe."""
    console = Console(stderr=True)
    shown = (TextColumn("{task.description}"), BarColumn(), *columns)
    return Progress(*shown, console=console, transient=True, disable=quiet or not console.is_terminal)


@contextmanager
def rows_bar(quiet: bool) -> Iterator[Callable[[State], None]]:
    """Progress bar of files, with rows a second."""
    columns = (TaskProgressColumn(), TextColumn("{task.fields[speed]}"), TimeRemainingColumn())
    with bar(quiet, *columns) as shown:
        task = shown.add_task("correcting", total=None, speed="")
        begun = monotonic()

        def tell(state: State) -> None:
            speed = state.rows / max(monotonic() - begun, 1e-3)
            shown.update(
                task,
                total=max(state.of_bytes, 1),
                completed=state.bytes,
                description=f"{state.files} of {state.of_files} files"
                if state.of_files > 1
                else "correcting",
                speed=f"{speed:,.0f} rows/s",
            )

        yield tell


@contextmanager
def counted_bar(quiet: bool, what: str) -> Iterator[Callable[[int, int], None]]:
    """Progress bar that is told the number done and that of all."""
    with bar(quiet, TaskProgressColumn(), TimeRemainingColumn()) as shown:
        task = shown.add_task(what, total=None)
        yield lambda done, total: shown.update(task, total=max(total, 1), completed=done)
