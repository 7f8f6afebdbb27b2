"""Files to correct: one, those of a folder, of a glob, of a tree of partitions."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from echocal.errors import DataError, UsageError
from echocal.observations.source import is_folder

__all__ = ["ENDINGS", "PARQUETS", "TEXTS", "Inputs", "Source", "find_inputs"]

PARQUETS = (".parquet", ".pq")
TEXTS = (".csv", ".tsv", ".csv.gz", ".tsv.gz")
ENDINGS = (*TEXTS, *PARQUETS)

_NOTHING = "__HIVE_DEFAULT_PARTITION__"
_GLOB = frozenset("*?[")


@dataclass(frozen=True)
class Source:
    """A file to correct.

    Attributes
    ----------
    path : Path
    place : Path
        The same below the folder that was given: its output has this name in the folder of the outputs.
    """

    path: Path
    place: Path

    @property
    def partition(self) -> dict[str, str]:
        """Keys that the names of its folders have: ``sensor_id=17``."""
        pairs = [part.partition("=") for part in self.place.parts[:-1] if "=" in part]
        values = {unquote(name): unquote(value) for name, _, value in pairs}
        return {name: "" if value == _NOTHING else value for name, value in values.items()}


@dataclass(frozen=True)
class Inputs:
    """Files to correct.

    Attributes
    ----------
    files : tuple of Source
        In the order of their names.
    single : bool
        Whether one file was named, so that the output is a file.
    hidden, unknown : tuple of Path
        Files that are left out: by a name that begins with ``.`` or ``_``, and by an unknown ending.
    """

    files: tuple[Source, ...]
    single: bool
    hidden: tuple[Path, ...] = field(default=())
    unknown: tuple[Path, ...] = field(default=())

    def left_out(self) -> list[str]:
        """A sentence on each kind of files that are left out."""
        kinds = (
            (self.hidden, "whose name, or that of a folder, begins with . or _"),
            (self.unknown, f"of another kind than {', '.join(ENDINGS)}"),
        )
        return [f"left out: {_listed(files)}, {why}" for files, why in kinds if files]


def find_inputs(given: str | Path) -> Inputs:
    """Find the files of a path, a folder or a glob.

    Raises
    ------
    DataError
        If there is none that can be corrected.
    """
    path = Path(given)
    if is_folder(path):
        return _sorted_out(path, (file for file in path.rglob("*")), str(given))
    if _GLOB & set(str(given)) and not _exists(path):
        fixed = _fixed(path)
        pattern = str(path.relative_to(fixed))
        return _sorted_out(fixed, fixed.glob(pattern), str(given))
    return Inputs((Source(path, Path(path.name)),), single=True)


def _sorted_out(root: Path, found: Iterator[Path], given: str) -> Inputs:
    files: list[Source] = []
    hidden: list[Path] = []
    unknown: list[Path] = []
    for path in sorted(set(found)):
        if not path.is_file():
            continue
        place = path.relative_to(root)
        if any(part.startswith((".", "_")) for part in place.parts):
            hidden.append(path)
        elif path.name.lower().endswith(ENDINGS):
            files.append(Source(path, place))
        else:
            unknown.append(path)
    if not files:
        message = f"{given} has no file that can be corrected; endings: {', '.join(ENDINGS)}"
        raise DataError(message)
    return Inputs(tuple(files), False, tuple(hidden), tuple(unknown))


def refuse_nested(inputs: Inputs, given: str | Path, out: Path) -> None:
    """Raise `UsageError` where outputs would lie among the inputs."""
    root = _fixed(Path(given)) if not is_folder(Path(given)) else Path(given)
    if not inputs.single and root.resolve() in (out.resolve(), *out.resolve().parents):
        message = f"{out} is or lies in the input itself; choose another output"
        raise UsageError(message)


def _fixed(path: Path) -> Path:
    """The folders of a glob before the first sign of one."""
    parts = []
    for part in path.parts[:-1]:
        if _GLOB & set(part):
            break
        parts.append(part)
    return Path(*parts)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def _listed(files: tuple[Path, ...]) -> str:
    shown = ", ".join(str(file) for file in files[:3])
    more = f" and {len(files) - 3} more" if len(files) > 3 else ""
    return f"{len(files)} {'file' if len(files) == 1 else 'files'} ({shown}{more})"
