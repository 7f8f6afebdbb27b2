"""Files of a fleet: from files, folders and globs to one list."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from echocal.correct.inputs import Source, find_inputs
from echocal.errors import DataError

__all__ = ["Files", "files_of"]


@dataclass(frozen=True)
class Files:
    """The files of a fleet.

    Attributes
    ----------
    sources : tuple of Source
        Each file once, in the order of the inputs and of their names.
    notes : tuple of str
        What is left out.
    """

    sources: tuple[Source, ...]
    notes: tuple[str, ...]


def files_of(inputs: Sequence[str | Path]) -> Files:
    """Find the files of paths, folders and globs.

    Raises
    ------
    DataError
        If a path does not exist, or has no table.
    """
    sources: dict[Path, Source] = {}
    notes: list[str] = []
    for given in inputs:
        found = find_inputs(given)
        if found.single and not found.files[0].file.exists():
            message = f"no file {given}"
            raise DataError(message)
        for source in found.files:
            sources.setdefault(source.file.resolve(), source)
        notes += found.left_out()
    return Files(tuple(sources.values()), tuple(notes))
