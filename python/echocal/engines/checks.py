"""Asked of every worker before the first task: whether it would do the same work as this process."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal.engines.engine import Engine
from echocal.errors import EchocalError, UsageError
from echocal.model.folder import ModelFolder
from echocal.model.plain import from_plain
from echocal.places import exists, file_digest, place_of, stamp

__all__ = ["check_workers", "models_digest", "sees"]

_VERSION = "__import__('importlib').import_module('echocal._core').__version__"
"""Asked as text: a worker without echocal, or with an early one, could not read a function of this module."""

_SHOWN = 3


def check_workers(engine: Engine, question: Mapping[str, Any]) -> None:
    """Ask every worker for its version, and for what it sees.

    Raises `UsageError` if a worker would do other work than this process; the text names the worker.

    Parameters
    ----------
    question : mapping
        See `sees`.
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

    Parameters
    ----------
    question : mapping
        Plain data. ``files``: sizes of files [B] by their paths. ``written``: a path, and the SHA-256 of
        what the process that asks has written there. ``models``: models as a job has them, and ``digest``:
        theirs.
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
    message = f"{engine.name}: {shown}{more}. Nothing was begun: {advice}"
    raise UsageError(message)
