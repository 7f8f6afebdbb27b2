"""Figures as files."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from echocal.errors import UsageError
from echocal.outputs import replacing

__all__ = ["FORMS", "in_form", "save_figure"]

FORMS = ("png", "svg", "pdf")
"""Formats of the plots of a command."""

_MAKER = {"png": "Software", "svg": "Creator", "pdf": "Creator", "ps": "Creator", "eps": "Creator"}
"""Name of the metadata field for the maker of a figure, by format."""


def save_figure(figure: Figure, path: Path, command: str, **options: Any) -> None:
    """Write a figure, complete or not at all, in the format of its ending.

    Raises `UsageError` if the file cannot be written.

    Parameters
    ----------
    command : str
        Command that made it; written to the file if its format allows.
    **options
        As for `Figure.savefig`.
    """
    ending = path.suffix.lower().removeprefix(".")
    metadata = {_MAKER[ending]: f"echocal {command}"} if ending in _MAKER else None
    with replacing(path) as unfinished:
        figure.savefig(unfinished, format=ending, dpi=150, metadata=metadata, **options)


def in_form(names: Iterable[str], form: str) -> tuple[str, ...]:
    """Names of files with the ending of a format.

    Raises `UsageError` if it is none of `FORMS`.

    Examples
    --------
    >>> in_form(["gain.png"], "svg")
    ('gain.svg',)
    """
    if form not in FORMS:
        message = f"plots are written as {', '.join(FORMS)}, not as '{form}'"
        raise UsageError(message)
    return tuple(str(Path(name).with_suffix(f".{form}")) for name in names)
