"""Delimited text: CSV, TSV and their kin, gzipped or not."""

import codecs
import csv
import gzip
import re
import sys
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import pandas as pd

from echocal.errors import DataError, UsageError
from echocal.observations.numbers import EXACT
from echocal.observations.quotes import Marks

__all__ = ["Head", "Layout", "below", "head_of", "is_zipped", "no_text", "read"]

_SEPARATORS = ",;\t|"
_PART = 1 << 20  # characters that are searched at a time


@dataclass(frozen=True)
class Layout:
    """How a text file is written, beyond what can be seen."""

    skip_lines: int = 0
    """Lines before the header; lines that begin with # there are skipped anyway."""
    decimal: str = "."
    encoding: str = "utf-8-sig"

    def __post_init__(self) -> None:
        if not isinstance(self.skip_lines, int | np.integer) or not 0 <= self.skip_lines <= sys.maxsize:
            message = f"skip_lines is {self.skip_lines!r}; give the number of lines before the header"
            raise UsageError(message)
        if self.decimal not in {".", ","}:
            message = f"decimal separator '{self.decimal}' is neither '.' nor ','"
            raise UsageError(message)
        try:
            codecs.lookup(self.encoding)
        except (LookupError, TypeError, ValueError):
            raise UsageError(_no_encoding(self.encoding)) from None


@dataclass(frozen=True)
class Head:
    """What a text file begins with.

    Attributes
    ----------
    above : int
        Lines down to the header, which is the last of them.
    separator : str
    names : list of str
        Columns; one without a name has one by its place.
    """

    above: int
    separator: str
    names: list[str]


def head_of(path: Path, layout: Layout) -> Head:
    """Read the header of a text file; the separator is the one that it has most of.

    Raises
    ------
    DataError
        If the file is not delimited text.
    """
    skip, lines = _first_lines(path, layout)
    header = lines[0]
    separator = max(_SEPARATORS, key=header.count)
    if separator not in header and any(other in lines[-1] for other in _SEPARATORS):
        message = (
            f"{path}: line {skip + 1} ('{header[:40]}') is one field and the next line has more; "
            f"if it is a logger's own line, skip it: --skip-lines {skip + 1}"
        )
        raise DataError(message)
    names = _names(next(csv.reader([header], delimiter=separator, skipinitialspace=True)))
    Marks(str(path), separator, len(names)).rows([header], skip + 1)
    return Head(skip + 1, separator, names)


def read(path: Path, layout: Layout, verbatim: bool) -> pd.DataFrame:
    """Read a text file.

    Raises
    ------
    DataError
        If the file is not delimited text.
    """
    head = head_of(path, layout)
    names = head.names
    body = _Body(path, layout, head.above, head.separator, len(names))
    count = body.rows()
    table = body.texts() if verbatim else body.values()
    if count not in {None, len(table)}:
        message = (
            f"{path} has {count} lines of fields below its header and was read as {len(table)} rows: "
            "a quotation mark may be the cause; remove those that are not needed"
        )
        raise DataError(message)
    table.columns = pd.Index(names)
    # a separator at the end of each line makes a column without name and values
    ends = [n for n in names if n.startswith("Unnamed") and table[n].isin(["", float("nan")]).all()]
    return table if verbatim else table.drop(columns=ends)


@dataclass(frozen=True)
class _Body:
    """The rows below a file's header."""

    path: Path
    layout: Layout
    above: int
    """Lines down to the header."""
    separator: str
    width: int
    """Fields of the header."""

    def rows(self) -> int | None:
        """Number of rows that quotation marks leave; None where there are no such marks."""
        with below(self.path, self.layout, self.above) as file:
            if not any('"' in part for part in iter(lambda: file.read(_PART), "")):
                return None
        with below(self.path, self.layout, self.above) as file:
            return Marks(str(self.path), self.separator, self.width).rows(file, self.above + 1)

    def texts(self) -> pd.DataFrame:
        """Every field as the text that it is."""
        return self._parsed(dtype=str, keep_default_na=False)

    def values(self) -> pd.DataFrame:
        """Numbers where all fields of a column are, else text."""
        decimal = self.layout.decimal
        table = self._parsed(decimal=decimal)
        # integers in a column with empty fields became floats, and the long ones were rounded
        wide = [
            n for n in range(self.width) if table[n].dtype == np.float64 and (table[n].abs() >= EXACT).any()
        ]
        texts = self._parsed(dtype=dict.fromkeys(wide, str)) if wide else table
        for n in wide:
            table[n] = texts[n].str.replace(decimal, ".", regex=False)
        return table

    def _parsed(self, **options: Any) -> pd.DataFrame:
        try:
            with below(self.path, self.layout, self.above) as file, warnings.catch_warnings():
                warnings.simplefilter("error", pd.errors.ParserWarning)  # fields would be lost
                table: pd.DataFrame = pd.read_csv(
                    file, sep=self.separator, header=None, names=range(self.width), index_col=False,
                    skipinitialspace=True, low_memory=False, **options,
                )  # fmt: skip
                return table
        except pd.errors.EmptyDataError:
            return pd.DataFrame(columns=range(self.width))
        except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
            reason = str(error).strip().splitlines()[-1].removeprefix("Error tokenizing data. C error: ")
            reason = re.sub(r"(?<=in line )\d+", lambda line: str(int(line[0]) + self.above), reason)
            message = f"{self.path} cannot be read as rows of {self.width} fields like its header: {reason}"
            raise DataError(message) from None


def _first_lines(path: Path, layout: Layout) -> tuple[int, list[str]]:
    """Lines to skip, and the header and the line after it."""
    skip = layout.skip_lines
    with below(path, layout, skip) as file:
        lines = list(islice(file, 100))
    while lines and (lines[0].startswith("#") or not lines[0].strip()):
        skip += 1
        lines.pop(0)
    if not lines:
        message = f"{path} has no header" + (f" after {skip} skipped lines" if skip else "")
        raise DataError(message)
    if "\0" in lines[0]:
        message = f"{path} is not text: its first line has NUL bytes"
        raise DataError(message)
    return skip, [line.rstrip("\r\n") for line in lines[:2]]


def _no_encoding(name: object) -> str:
    return f"unknown encoding '{name}'; common ones: utf-8, latin-1, utf-16"


def no_text(path: Path, layout: Layout) -> str:
    """Say that a file is not text in its encoding."""
    encoding = layout.encoding.removesuffix("-sig")
    with path.open("rb") as file:
        wide = file.read(2) in {b"\xff\xfe", b"\xfe\xff"}
    likely = "utf-16" if wide else "latin-1 (or cp1252, utf-16, ...)"
    return f"{path} is not text in {encoding}: a binary file, or name the encoding: --encoding {likely}"


def _names(fields: list[str]) -> list[str]:
    return [field.strip() or f"Unnamed {position + 1}" for position, field in enumerate(fields)]


def is_zipped(path: Path) -> bool:
    """Whether a file begins as gzip does."""
    with path.open("rb") as file:
        return file.read(2) == b"\x1f\x8b"


@contextmanager
def below(path: Path, layout: Layout, lines: int) -> Iterator[TextIO]:
    """Open a file below its first lines."""
    try:
        with _open(path, layout.encoding) as file:
            for _ in islice(file, lines):
                pass
            yield file
    except UnicodeError:
        raise DataError(no_text(path, layout)) from None
    except LookupError:  # one for bytes, such as zip
        raise UsageError(_no_encoding(layout.encoding)) from None
    except (OSError, EOFError, zlib.error) as error:
        message = f"{path} cannot be unpacked: {error}"
        raise DataError(message) from None


def _open(path: Path, encoding: str) -> TextIO:
    if is_zipped(path):
        return gzip.open(path, "rt", encoding=encoding, newline="")
    return path.open(encoding=encoding, newline="")
