"""Files to correct: one, those of a folder, of a glob, of a tree of partitions."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePath, PurePosixPath
from urllib.parse import unquote

from echocal.errors import DataError, UsageError, writing
from echocal.objects import Object, is_url
from echocal.observations.source import is_folder
from echocal.places import Place

PARQUETS = (".parquet", ".pq")
TEXTS = (".csv", ".tsv", ".csv.gz", ".tsv.gz")
ENDINGS = (*TEXTS, *PARQUETS)

_NOTHING = "__HIVE_DEFAULT_PARTITION__"
_GLOB = frozenset("*?[")


@dataclass(frozen=True)
class Source:
    """A file to correct."""

    path: Place
    place: PurePath
    """The same below the folder that was given: its output has this name in the folder of the outputs."""

    @property
    def file(self) -> Path:
        """The file of a disk. Raises `UsageError` if it is an object of a store."""
        if isinstance(self.path, Path):
            return self.path
        raise UsageError(f"{self.path} is in an object store, and this command reads files: copy it first")

    @property
    def partition(self) -> dict[str, str]:
        """Keys that the names of its folders have: ``sensor_id=17``."""
        pairs = [part.partition("=") for part in self.place.parts[:-1] if "=" in part]
        values = {unquote(name): unquote(value) for name, _, value in pairs}
        return {name: "" if value == _NOTHING else value for name, value in values.items()}


@dataclass(frozen=True)
class Inputs:
    """Files to correct."""

    files: tuple[Source, ...]  # in the order of their names
    single: bool  # whether one file was named, so that the output is a file
    # hidden, unknown: files that are left out: by a name that begins with ``.`` or ``_``, and by an unknown
    # ending
    hidden: tuple[Place, ...] = field(default=())
    unknown: tuple[Place, ...] = field(default=())

    def left_out(self) -> list[str]:
        """A sentence on each kind of files that are left out."""
        kinds = (
            (self.hidden, "whose name, or that of a folder, begins with . or _"),
            (self.unknown, f"of another kind than {', '.join(ENDINGS)}"),
        )
        return [f"left out: {_listed(files)}, {why}" for files, why in kinds if files]


def find_inputs(given: str | Path) -> Inputs:
    """Find the files of a path, a folder or a glob; of a disk, or of an object store by its URL.

    Raises `DataError` if there is none that can be corrected.
    """
    if is_url(given):
        return _objects(str(given))
    path = Path(given)
    if is_folder(path):
        return _sorted_out(_below(path, path.rglob("*")), str(given))
    if _GLOB & set(str(given)) and not _exists(path):
        fixed = _fixed(path)
        pattern = str(path.relative_to(fixed))
        return _sorted_out(_below(fixed, fixed.glob(pattern)), str(given))
    return Inputs((Source(path, Path(path.name)),), single=True)


def _objects(url: str) -> Inputs:
    """Find objects."""
    root, pattern = Object(url), "**"
    if not root.is_folder():
        if not _GLOB & set(url) or root.exists():
            return Inputs((Source(root, PurePosixPath(root.name)),), single=True)
        scheme, _, path = url.partition("://")
        fixed = _fixed(Path(path)).as_posix()
        root, pattern = Object(f"{scheme}://{fixed}"), path[len(fixed) + 1 :]
    found = ((root / name, PurePosixPath(name)) for name in root.below(pattern))
    return _sorted_out(found, url)


def _below(root: Path, found: Iterator[Path]) -> Iterator[tuple[Path, PurePath]]:
    return ((path, path.relative_to(root)) for path in sorted(set(found)) if not _is_real_folder(path))


def _is_real_folder(path: Path) -> bool:
    try:
        return path.is_dir() and not path.is_symlink()
    except OSError:  # no permission to look: its task tells
        return False


def _is_special(path: Place) -> bool:
    """Whether a path is neither a file nor a link that leads nowhere, of which its task tells."""
    try:
        return isinstance(path, Path) and path.exists() and not path.is_file()
    except OSError:
        return False


def _sorted_out(found: Iterable[tuple[Place, PurePath]], given: str) -> Inputs:
    files: list[Source] = []
    hidden: list[Place] = []
    unknown: list[Place] = []
    for path, place in found:
        if any(part.startswith((".", "_")) for part in place.parts):
            hidden.append(path)
        elif path.name.lower().endswith(ENDINGS) and not _is_special(path):
            files.append(Source(path, place))
        else:
            unknown.append(path)
    if not files:
        raise DataError(f"{given} has no file that can be corrected; endings: {', '.join(ENDINGS)}")
    return Inputs(tuple(files), False, tuple(hidden), tuple(unknown))


def refuse_ending(path: Place) -> None:
    """Raise `UsageError` for an output of an unknown kind."""
    if not path.name.lower().endswith(ENDINGS):
        raise UsageError(f"cannot write {path}; endings: {', '.join(ENDINGS)}")


def refuse_outputs(inputs: Inputs, given: str | Path, out: Place) -> None:
    """Raise `UsageError` where outputs would replace inputs, lie among them, or have an unknown ending."""
    if inputs.single:
        refuse_ending(out)
        file = inputs.files[0].path
        if isinstance(file, Path) and isinstance(out, Path):
            with writing(out):
                same = out.exists() and out.samefile(file)
            if same:
                raise UsageError(f"{out} is the input itself; choose another output")
    if is_url(given) or is_url(out):
        folder = str(given).rstrip("/") + "/"
        if not inputs.single and f"{out}/".startswith(folder):
            raise UsageError(f"{out} is or lies in the input itself; choose another output")
        return
    root, out = _fixed(Path(given)) if not is_folder(Path(given)) else Path(given), Path(str(out))
    if not inputs.single and root.resolve() in (out.resolve(), *out.resolve().parents):
        raise UsageError(f"{out} is or lies in the input itself; choose another output")


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


def _listed(files: tuple[Place, ...]) -> str:
    shown = ", ".join(str(file) for file in files[:3])
    more = f" and {len(files) - 3} more" if len(files) > 3 else ""
    return f"{len(files)} {'file' if len(files) == 1 else 'files'} ({shown}{more})"
