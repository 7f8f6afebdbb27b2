"""A process of this machine that runs one task after the other, and what each worker is asked before.

Each has a pipe of its own. The pool of the standard library has one queue for all of them: a process that is
killed while it holds the lock of the queue, or while another one begins, stops the others for ever (Python
3.11, issues 94777 and 109047). Every worker is asked whether it would do the same work as this process.
"""

import multiprocessing
import os
import pickle
import threading
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal._interrupt import Terminated, stop_if_told, unwind_when_told
from echocal.engines.engine import Engine, Result, Task, Work
from echocal.errors import EchocalError, UsageError
from echocal.model.folder import ModelFolder
from echocal.model.plain import from_plain
from echocal.places import exists, file_digest, place_of, stamp

ONE_THREAD = {
    "ECHOCAL_NUM_THREADS": "1",
    "POLARS_MAX_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a process that shares its machine with others of its kind."""
_VERSION = "__import__('importlib').import_module('echocal._core').__version__"
"""Asked as text: a worker without echocal, or with an early one, could not read a function of this module."""

_SHOWN = 3


class Worker:
    """A process that is started anew: a copy of this one might have locks that its threads held.

    Its work is a function of a module.
    """

    def __init__(self, work: Work) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(there, work), daemon=True)
        with _environment(ONE_THREAD):
            self._process.start()
        there.close()
        self.number: int | None = None
        """Of the task that it has."""

    def begin(self, number: int, task: Task) -> None:
        """Give it a task; a process that has died takes it, too."""
        self.number = number
        with suppress(OSError):
            self._pipe.send(task)

    def end(self) -> Result | None:
        """The result of its task, when it is there; None if the process died.

        Raises
        ------
        BaseException
            What the task raised.
        """
        self.number = None
        try:
            result, raised = self._pipe.recv() if self._pipe.poll() else (None, None)
        except (EOFError, OSError):  # it died before, or while it answered
            return None
        if raised is not None:
            raise raised
        return result

    def close(self) -> None:
        """Let it end: at once, and leave nothing unfinished, if it has a task that nobody waits for."""
        if self.number is not None:
            self._process.terminate()
        self._pipe.close()

    def join(self) -> None:
        """Wait until it has ended."""
        self._process.join()

    @classmethod
    def ready(cls, workers: Sequence["Worker"]) -> list["Worker"]:
        """Wait until some have an answer, or have died."""
        found = wait([each for one in workers for each in (one._pipe, one._process.sentinel)])
        return [one for one in workers if one._pipe in found or one._process.sentinel in found]


def _serve(pipe: Connection, work: Work) -> None:
    """Answer each task by its result, or by what it raised."""
    unwind_when_told("SIGINT")
    _end_with_parent()
    with suppress(EOFError, BrokenPipeError, KeyboardInterrupt):
        while True:
            answer = _answer(work, pipe.recv())
            stop_if_told()
            try:
                pipe.send(answer)
            except (pickle.PicklingError, AttributeError, TypeError) as error:
                pipe.send((None, RuntimeError(f"the answer of a process cannot be sent: {error}: {answer}")))


def _answer(work: Work, task: Task) -> tuple[Result | None, BaseException | None]:
    try:
        return work(task), None
    except (KeyboardInterrupt, Terminated):
        raise
    except BaseException as error:
        error.add_note(f"in a process:\n{traceback.format_exc()}")
        return None, _sent(error)


def _sent(error: BaseException) -> BaseException:
    """The error, or its text where it would not arrive as it is."""
    try:
        if type(pickle.loads(pickle.dumps(error))) is type(error):
            return error
    except Exception:
        pass
    return RuntimeError(f"{type(error).__name__}: {error}, {error.__notes__[-1]}")


def _end_with_parent() -> None:
    """End this process with the run; else it would write into the run that follows."""
    parent = multiprocessing.parent_process()
    assert parent is not None  # a process that another one began

    def watch() -> None:
        wait([parent.sentinel])
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


def check_workers(engine: Engine, question: Mapping[str, Any]) -> None:
    """Ask every worker for its version, and a question of `sees`.

    Raises `UsageError` if a worker would do other work than this process; the text names the worker.
    """
    wrong = {
        worker: f"has {found}" for worker, own in engine.ask(eval, _VERSION).items() if (found := _other(own))
    }
    if wrong:
        _refuse(engine, wrong, f"this process has echocal {__version__}; install the same version everywhere")
    wrong = {worker: str(own) for worker, own in engine.ask(sees, dict(question)).items() if own}
    if wrong:
        _refuse(engine, wrong, "every worker needs the same files, under the same paths")


def sees(question: Mapping[str, Any]) -> str:
    """What a worker does not see as the process that asks does; empty if all is the same.

    The question is plain data. ``files``: sizes of files [B] by their paths. ``written``: a path, and the
    SHA-256 of what the process that asks has written there. ``models``: models as a job has them, and
    ``digest``: theirs.
    """
    try:
        for path, size in question.get("files", {}).items():
            if (found := stamp(place_of(path))["size"]) != size:
                return f"sees {path} with {found} bytes, and this process with {size}"
        if "written" in question:
            path, digest = question["written"]
            place = place_of(path)
            if not exists(place) or file_digest(place) != digest:
                return f"does not see what this process wrote: {path} is absent or another file"
        if "models" in question and (digest := models_digest(question["models"])) != question["digest"]:
            return f"has other models: their digest is {digest[:12]}, and here {question['digest'][:12]}"
    except (EchocalError, OSError) as error:
        return f"reports: {error}"
    return ""


def models_digest(models: Mapping[str, Any]) -> str:
    """Digest of one model, or of a folder of models, from plain data."""
    if "model" in models:
        return from_plain(models["model"]).hash
    return ModelFolder(Path(models["folder"])).digest()


def _other(version: Any) -> str:
    """The version of a worker where it is another one."""
    if isinstance(version, ModuleNotFoundError):
        return f"no echocal ({version})"
    if isinstance(version, BaseException):
        return f"an echocal that cannot be imported ({version})"
    return "" if version == __version__ else f"echocal {version}"


def _refuse(engine: Engine, wrong: Mapping[str, str], advice: str) -> None:
    shown = "; ".join(f"worker {worker} {what}" for worker, what in list(wrong.items())[:_SHOWN])
    more = f"; and {len(wrong) - _SHOWN} more" if len(wrong) > _SHOWN else ""
    raise UsageError(f"{engine.name}: {shown}{more}. Nothing was begun: {advice}")
