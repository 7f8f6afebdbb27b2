"""Check that all outputs of a command can be written, before the command starts its work."""

import os
import shlex
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from echocal.cli._console import Console
from echocal.cli._made_by import Recognize
from echocal.cli._options import file_in_use
from echocal.errors import UsageError, writing
from echocal.outputs import refuse_name, replace_text

_FEW = 3  # files of a folder that are listed by name

Force: TypeAlias = Annotated[
    bool, typer.Option("--force", help="Replace existing files that this command did not make.")
]

PlotFormat: TypeAlias = Annotated[
    str, typer.Option(metavar="png|svg|pdf", help="Format of the plots of --plots.")
]

Report: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--report", metavar="OUT.html", help="Write one page to read in a browser, to print or to send."
    ),
]


@dataclass
class _Run:
    """What is known of the outputs of the command that runs."""

    before: dict[Path, object] = field(default_factory=dict)
    """Each file that it may write, with what tells the file from a later one; None if it was absent."""
    folders: list[Path] = field(default_factory=list)  # folders that it makes
    quiet: bool = False  # whether it says nothing
    stdout_taken: bool = False  # whether stdout is a result of its own


_run = _Run()


def be_quiet(quiet: bool) -> bool:
    """Callback of an option after which the command does not say what it wrote."""
    _run.quiet = quiet
    return quiet


Quiet: TypeAlias = Annotated[
    bool, typer.Option("--quiet", "-q", callback=be_quiet, help="Print nothing but errors.")
]


@dataclass(frozen=True)
class Output:
    """A file that a command writes."""

    option: str  # option that names it
    path: Path | str | None  # None and ``-``, which is stdout, need nothing
    recognize: Recognize
    """Whether an existing file is a former output of the same kind, which may be replaced."""


def check_outputs(
    *outputs: Output,
    inputs: Iterable[Path | str | None] = (),
    folder: Path | None = None,
    force: bool = False,
    told: bool = False,
) -> None:
    """Refuse outputs that cannot be written, or that would destroy a file of the user's.

    Raises `UsageError` with the option, the file and the way out.

    Parameters
    ----------
    *outputs : Output
        Files to write, those in the folder too as far as they are known.
    inputs : iterable of path or None
        Files and folders that the command reads.
    folder : path, optional
        A folder that the command makes if absent.
    force : bool
        Whether files that the command did not make may be replaced; an input never.
    told : bool
        Whether the command itself says what it writes.
    """
    if folder is not None:
        _refuse_folder(folder)
    inputs = [*inputs, file_in_use()]
    _refuse_pages(outputs)
    files = [(o, Path(o.path)) for o in outputs if o.path is not None and str(o.path) != "-"]
    for _, file in files:
        refuse_name(file)
        with writing(file):
            _refuse_file(file, folder)
    seen: dict[str, str] = {}
    for output, file in files:
        _refuse_input(output.option, file, inputs)
        first = seen.setdefault(os.path.realpath(file), output.option)
        if first != output.option:
            raise UsageError(f"{first} and {output.option} both name {file}; choose two names")
    if not force:
        for output, file in files:
            if file.is_file() and file.stat().st_size > 0 and not output.recognize(file):
                raise UsageError(
                    f"{output.option} {file} exists, and this command did not make it from this input, or "
                    "somebody has edited it since: choose another name, or replace it with --force"
                )
    _run.stdout_taken |= any(str(output.path) == "-" for output in outputs)
    if not told:
        _run.before |= {file: _state(file) for _, file in files}
        _run.folders += [] if folder is None else [folder]


def written() -> list[str]:
    """What the command has written since it checked its outputs, for a person; each file is told once."""
    files = [file for file, before in _run.before.items() if _state(file) != before]
    for file in files:
        del _run.before[file]
    places = {file: next((f for f in _run.folders if f in file.parents), file) for file in files}
    count = Counter(places.values())
    many = {place: f"{place} ({n} files)" for place, n in count.items() if n > _FEW}
    return list(dict.fromkeys(many.get(places[file], str(file)) for file in files))


@contextmanager
def telling_what_is_written() -> Iterator[None]:
    """Say what the command has written, where it has not said it itself."""
    global _run
    _run = _Run()
    try:
        yield
    except typer.Exit:
        _tell()
        raise
    _tell()


def _tell() -> None:
    if (files := written()) and not _run.quiet:
        Console(stderr=_run.stdout_taken, soft_wrap=True, highlight=False).print(
            f"wrote {', '.join(files)}", markup=False
        )


def _state(file: Path) -> object:
    try:
        known = file.stat()
    except OSError:
        return None
    return known.st_mtime_ns, known.st_size, known.st_ino


def made_in(folder: Path | None, option: str, names: Iterable[str], recognize: Recognize) -> list[Output]:
    """Outputs in a folder; none without a folder."""
    return [] if folder is None else [Output(option, folder / name, recognize) for name in names]


def refuse_picture(path: Path | None) -> None:
    """Refuse a picture of another format than those that the help names.

    Raises `UsageError` if the ending is none of them.
    """
    if path is not None and path.suffix.lower() not in (".png", ".svg", ".pdf"):
        told = f"the ending '{path.suffix}'" if path.suffix else "no ending"
        raise UsageError(f"{path} has {told}; a plot is .png, .svg or .pdf")


def _refuse_pages(outputs: Iterable[Output]) -> None:
    for path in (Path(o.path) for o in outputs if o.option == "--report" and o.path is not None):
        if path.suffix.lower() not in (".html", ".htm"):
            raise UsageError(f"--report {path} is a page for a browser; give a name that ends in .html")


def pass_on(text: str, target: Path | str | None) -> None:
    """Write a text to a file, or to stdout for ``-``; nowhere for None."""
    if target is None:
        return
    if str(target) == "-":
        sys.stdout.write(text)
    else:
        replace_text(target, text)


def _refuse_input(option: str, file: Path, inputs: Iterable[Path | str | None]) -> None:
    for source in (Path(path) for path in inputs if path is not None):
        if _is_part(file, source):
            named = f"{source}" if str(source) == str(file) else f"{source}, by another name"
            raise UsageError(f"{option} {file} is an input of this command ({named}); choose another name")


def _is_part(file: Path, source: Path) -> bool:
    """Whether a file is the source, by whatever path or link, or lies in that folder."""
    try:
        if not file.is_file() or not source.exists():
            return False
    except OSError:  # a name that no file can have: the reader tells
        return False
    return file.samefile(source) or (source.is_dir() and source.resolve() in file.resolve().parents)


def _refuse_folder(folder: Path) -> None:
    refuse_name(folder)
    with writing(folder):
        nearest = _nearest(folder.absolute())
    if not nearest.is_dir():
        _refuse(folder, f"{nearest} is a file; name a folder")
    if not os.access(nearest, os.W_OK | os.X_OK):
        _refuse(folder, f"no permission to write into {nearest}")


def _refuse_file(file: Path, coming: Path | None) -> None:
    parent = file.absolute().parent
    if file.is_dir():
        _refuse(file, "it is a folder; name a file in it")
    is_coming = coming is not None and coming.absolute() in (parent, *parent.parents)
    if not parent.exists() and not is_coming:
        _refuse(file, f"there is no folder {file.parent}; make it first")
    if parent.exists() and not parent.is_dir():
        _refuse(file, f"{file.parent} is a file; name a folder")
    if file.exists() and not os.access(file, os.W_OK):
        _refuse(file, "no permission to write")
    if (file.is_file() or not file.exists()) and not os.access(_nearest(parent), os.W_OK | os.X_OK):
        _refuse(file, f"no permission to write into {_nearest(parent)}")


def _nearest(folder: Path) -> Path:
    return next(place for place in (folder, *folder.parents) if place.exists())


def _refuse(path: Path, reason: str) -> None:
    raise UsageError(f"{path} cannot be written: {reason}")


def this_command() -> str:
    """The command that runs."""
    return shlex.join(["echocal", *sys.argv[1:]])


def write_report(path: Path, page: Callable[[Any, str, str], str], result: Any, heading: str) -> None:
    """Write the page of a result, with the command that runs."""
    replace_text(path, page(result, heading, this_command()))
