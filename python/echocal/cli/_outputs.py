"""Whether all outputs of a command can be written, asked before it works for minutes and writes some."""

import os
from pathlib import Path

from echocal.errors import UsageError

__all__ = ["refuse_unwritable"]


def refuse_unwritable(*files: Path | str | None, folder: Path | None = None) -> None:
    """Refuse outputs that cannot be written.

    Parameters
    ----------
    *files : path or str or None
        Files, whose folders must be there; None and ``-``, which is stdout, need nothing.
    folder : path, optional
        A folder, which the command makes if absent.

    Raises
    ------
    UsageError
        If one of them cannot be written, with the reason.
    """
    if folder is not None:
        _refuse_folder(folder)
    for file in files:
        if file is not None and str(file) != "-":
            _refuse_file(Path(file), folder)


def _refuse_folder(folder: Path) -> None:
    nearest = _nearest(folder.absolute())
    if not nearest.is_dir():
        _refuse(folder, f"{nearest} is a file; name a folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        _refuse(folder, f"no permission to write into {nearest}")


def _refuse_file(file: Path, coming: Path | None) -> None:
    parent = file.absolute().parent
    if file.is_dir():
        _refuse(file, "it is a folder; name a file in it")
    if not parent.exists() and (coming is None or parent != coming.absolute()):
        _refuse(file, f"there is no folder {file.parent}; make it first")
    if parent.exists() and not parent.is_dir():
        _refuse(file, f"{file.parent} is a file; name a folder")
    if not os.access(file if file.exists() else _nearest(parent), os.W_OK):
        _refuse(file, "no permission to write")


def _nearest(folder: Path) -> Path:
    return next(place for place in (folder, *folder.parents) if place.exists())


def _refuse(path: Path, reason: str) -> None:
    message = f"{path} cannot be written: {reason}"
    raise UsageError(message)
