"""Files of a fleet: from files, folders and globs to a list, and what their paths say of them."""

from collections.abc import Iterator, Sequence
from glob import has_magic
from pathlib import Path
from urllib.parse import unquote

from echocal.errors import DataError

__all__ = ["expanded", "is_many", "partitions"]

_ENDINGS = (".parquet", ".pq", ".csv", ".tsv", ".txt", ".csv.gz", ".tsv.gz", ".txt.gz")


def is_many(path: Path) -> bool:
    """Whether a path names several files: a folder, or a pattern."""
    try:
        return path.is_dir() or (has_magic(str(path)) and not path.exists())
    except (OSError, ValueError):
        return False


def expanded(inputs: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Files in the order of their paths, each once, and notes on what was left aside.

    In a folder, files and folders whose names begin with ``.`` or ``_`` are no data, as in every engine that
    writes such folders.

    Raises
    ------
    DataError
        If a path does not exist, or there is no table among the files.
    """
    found: dict[Path, None] = {}
    others: list[Path] = []
    for path in inputs:
        for file in _files_of(path):
            if file.name.lower().endswith(_ENDINGS) or file in inputs:
                found.setdefault(file)
            else:
                others.append(file)
    if not found:
        shown = ", ".join(str(path) for path in inputs[:3])
        message = f"there is no table in {shown}; a table ends in {', '.join(_ENDINGS)}"
        raise DataError(message)
    notes = []
    if others:
        named = ", ".join(file.name for file in others[:3]) + (", ..." if len(others) > 3 else "")
        notes = [f"{len(others)} files are no tables by their endings and are left aside: {named}"]
    return sorted(found), notes


def partitions(file: Path, root: Path | None = None) -> dict[str, str]:
    """What the folders of a path say: ``sensor_id=17/day=3/a.parquet``.

    Examples
    --------
    >>> from pathlib import Path
    >>> partitions(Path("logs/sensor_id=tank%207/a.parquet"))
    {'sensor_id': 'tank 7'}
    """
    pairs = (part.partition("=") for part in file.parent.parts)
    return {name: unquote(value) for name, equals, value in pairs if equals and name}


def _files_of(path: Path) -> Iterator[Path]:
    if path.is_dir():
        yield from _visible(path)
    elif path.exists():
        yield path
    elif has_magic(str(path)):
        root = Path(path.anchor)
        matches = sorted(root.glob(str(path.relative_to(root))))
        if not matches:
            message = f"no file matches {path}"
            raise DataError(message)
        for match in matches:
            yield from _visible(match) if match.is_dir() else [match]
    else:
        message = f"no file {path}"
        raise DataError(message)


def _visible(folder: Path) -> Iterator[Path]:
    for entry in sorted(folder.iterdir()):
        if entry.name.startswith((".", "_")):
            continue
        if entry.is_dir():
            yield from _visible(entry)
        elif entry.is_file():
            yield entry
