"""Work for the tests of the pool, which its processes import."""

import os
import signal
import sys
from pathlib import Path
from typing import Any

from echocal.fleet import diagnose_fleet

ONE_EACH = 400 * 130  # bytes: so that each task has one sensor


def plain(task: Any) -> dict[str, Any]:
    return {"number": task["number"], "process": os.getpid(), "threads": os.environ["POLARS_MAX_THREADS"]}


def deadly(task: Any) -> dict[str, Any]:
    """Some tasks kill their process: 3 always, 5 the first time."""
    once = Path(task["folder"]) / "was here"
    if task["number"] == 3 or (task["number"] == 5 and not once.exists()):
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return plain(task)


class Alone(Exception):  # noqa: N818
    """An error that cannot be read where it arrives."""

    def __init__(self, part: int, whole: int) -> None:
        super().__init__(f"{part} of {whole}")


def alone(task: Any) -> dict[str, Any]:
    raise Alone(1, 2)


def leaves(task: Any) -> dict[str, Any]:
    sys.exit(3)


def unspeakable(task: Any) -> dict[str, Any]:
    """A result that no process can send."""
    return {"answer": lambda: task}


if __name__ == "__main__":
    diagnose_fleet(
        "logs", "sensor_id", out=sys.argv[1], models=sys.argv[2], base="cramer", memory=ONE_EACH, workers=2
    )
