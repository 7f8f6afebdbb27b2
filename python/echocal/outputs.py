"""Files that are complete or absent: written under a temporary name, then renamed."""

import io
import os
import re
import secrets
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from echocal.errors import UsageError, writing

__all__ = ["WriteError", "opened_output", "refuse_name", "replace_all", "replace_text", "replacing"]
__all__ += ["csv_text", "spreadsheet_safe", "write_table"]

_NAMED = 50  # characters of the file's name that its unfinished copy shows


_FORMULA = re.compile(r"[\s\x00-\x1f]*[=+\-@＝＋－＠]")
_NUMBER = re.compile(r"\s*[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d+)?\s*|[-+\s]*")


def spreadsheet_safe(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula: with an apostrophe before what begins as one.

    Numbers stay numbers. Source: CSV Injection, of the Open Worldwide Application Security Project (OWASP).

    Examples
    --------
    >>> from echocal.outputs import spreadsheet_safe
    >>> spreadsheet_safe("=1+1"), spreadsheet_safe("-5.2"), spreadsheet_safe("tank 7")
    ("'=1+1", '-5.2', 'tank 7')
    """
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def csv_text(table: Any, **options: Any) -> str:
    r"""Return a table of pandas as CSV, by options of its `to_csv`; each line ends with a line feed.

    A carriage return ends a line, too, so a text that has one is quoted. Python's writer only quotes what its
    own ends of lines are made of.

    Examples
    --------
    >>> import pandas as pd
    >>> csv_text(pd.DataFrame({"a": ["x\ry"], "b": [1]}))
    'a,b\n"x\ry",1\n'
    """
    text: str = table.to_csv(index=False, lineterminator="\n", **options)
    if "\r" in text:
        end = "\r" * (1 + max(map(len, re.findall("\r+", text)))) + "\n"  # which no text has
        text = table.to_csv(index=False, lineterminator=end, **options).replace(end, "\n")
    return text


class WriteError(OSError):
    """The system's refusal to write, where a reader's `OSError` could be meant, too."""


def opened_output(path: Path) -> io.BufferedWriter:
    """Open a file to write, whose errors are `WriteError`."""
    with _of_writing():
        return io.BufferedWriter(_Output(path, "wb"))


class _Output(io.FileIO):
    def write(self, data: Any) -> int:
        with _of_writing():
            return super().write(data)

    def close(self) -> None:
        with _of_writing():
            super().close()


@contextmanager
def _of_writing() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise WriteError(error.errno, error.strerror) from None


@contextmanager
def replacing(path: str | Path, last: Callable[[], None] = lambda: None) -> Iterator[Path]:
    """Give a path to write to, and put that file in place when it is complete.

    What was there stays until then, whatever ends the work: an error, a full disk, Ctrl-C. Two processes that
    write one file never write into each other's; the last one that is done has it. A link stays a link: the
    file that it points to is replaced, and keeps its permissions. A device or a pipe is written to as it
    stands. Raises `UsageError` if the file cannot be written.

    Parameters
    ----------
    path : str or Path
        File to make or to replace.
    last : callable
        Called when the file is complete, right before it is put in place. What it raises keeps the old file.

    Yields
    ------
    Path
        File to write, in the same folder; its name has another ending, so name the format.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from echocal.outputs import replacing
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "a.txt"
    >>> with replacing(path) as unfinished:
    ...     _ = unfinished.write_text("whole")
    >>> path.read_text(), [file.name for file in path.parent.iterdir()]
    ('whole', ['a.txt'])
    """
    path = Path(path)
    refuse_name(path)
    with writing(path):
        if path.exists() and not path.is_file():
            yield path  # nothing to rename; a folder refuses by itself
            return
        target = Path(os.path.realpath(path))
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(None, "no permission to replace it")
        unfinished = target.with_name(f".{target.name[:_NAMED]}.{secrets.token_hex(8)}.unfinished")
        mode = target.stat().st_mode & 0o7777 if target.exists() else None
        made = os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666 if mode is None else 0o600
        try:
            os.close(os.open(unfinished, *made))
            yield unfinished
            if mode is not None:  # of the file that is replaced, whatever the process grants new ones
                unfinished.chmod(mode)
            _keep(unfinished)
            last()
            unfinished.replace(target)
        finally:
            unfinished.unlink(missing_ok=True)


def replace_text(path: str | Path, text: str, *, newline: str | None = None) -> None:
    """Write a text in UTF-8, complete or not at all. Raises `UsageError` if the file cannot be written."""
    with replacing(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline=newline)


def write_table(table: Any, path: Path) -> None:
    """Write a table of pandas as .parquet, or else as CSV; complete or not at all.

    Raises `UsageError` if Parquet lacks its library, or the file cannot be written.
    """
    if path.suffix.lower() != ".parquet":
        replace_text(path, csv_text(table), newline="")
        return
    try:
        with replacing(path) as unfinished:
            table.to_parquet(unfinished, index=False)
    except ImportError:
        raise UsageError("Parquet needs pyarrow: pip install 'echocal[batch]'") from None


def replace_all(folder: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write texts that belong together, by their paths in a folder, which is made if absent.

    All are complete before the first is put in its place. Raises `UsageError` if one cannot be written.
    """
    paths = {folder / name: text for name, text in texts.items()}
    with ExitStack() as together, writing(folder):
        for path, text in paths.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            unfinished = together.enter_context(replacing(path))
            unfinished.write_text(text, encoding="utf-8", newline="\n")
    return list(paths)


def refuse_name(path: Path) -> None:
    """Refuse a name that no file can have.

    Raises `UsageError` if it holds a zero byte or is no text in Unicode.
    """
    try:
        possible = b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:
        possible = False
    if not possible:
        raise UsageError(f"{str(path)!r} cannot be written: no file can have this name")


def _keep(file: Path) -> None:
    """Wait until the disk has it: else a crash could leave the new name without its content."""
    descriptor = os.open(file, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
