"""Delimited text: CSV, TSV and their kin, gzipped or not."""

import csv
import gzip
import warnings
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

import pandas as pd

from echocal.errors import DataError, UsageError

__all__ = ["Layout", "read"]

_SEPARATORS = ",;\t|"


@dataclass(frozen=True)
class Layout:
    """How a text file is written, beyond what can be seen."""

    skip_lines: int = 0
    """Lines before the header; lines that begin with # there are skipped anyway."""
    decimal: str = "."
    encoding: str = "utf-8-sig"

    def __post_init__(self) -> None:
        if self.skip_lines < 0:
            message = f"skip_lines is {self.skip_lines}; give the number of lines before the header"
            raise UsageError(message)
        if self.decimal not in {".", ","}:
            message = f"decimal separator '{self.decimal}' is neither '.' nor ','"
            raise UsageError(message)


def read(path: Path, layout: Layout, verbatim: bool) -> pd.DataFrame:
    """Read a text file; the separator is the one that its header has most of.

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
    names = _names(next(csv.reader([header], delimiter=separator)))
    options: dict[str, Any] = (
        {"dtype": str, "keep_default_na": False} if verbatim else {"decimal": layout.decimal}
    )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # fields would be lost
            table: pd.DataFrame = pd.read_csv(
                path, sep=separator, header=None, names=range(len(names)), index_col=False,
                skiprows=skip + 1, encoding=layout.encoding, skipinitialspace=True, low_memory=False,
                compression="gzip" if _zipped(path) else None, **options,
            )  # fmt: skip
    except pd.errors.EmptyDataError:
        table = pd.DataFrame(columns=range(len(names)))
    except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error tokenizing data. C error: ")
        message = f"{path} cannot be read as rows of {len(names)} fields like its header: {reason}"
        raise DataError(message) from None
    except UnicodeError:
        raise DataError(_no_text(path, layout)) from None
    table.columns = pd.Index(names)
    # a separator at the end of each line makes a column without name and values
    ends = [n for n in names if n.startswith("Unnamed") and table[n].isin(["", float("nan")]).all()]
    return table if verbatim else table.drop(columns=ends)


def _first_lines(path: Path, layout: Layout) -> tuple[int, list[str]]:
    """Lines to skip, and the header and the line after it."""
    skip = layout.skip_lines
    try:
        with _open(path, layout.encoding) as file:
            lines = list(islice(file, skip, skip + 100))
    except UnicodeError:
        raise DataError(_no_text(path, layout)) from None
    except LookupError:
        message = f"unknown encoding '{layout.encoding}'; common ones: utf-8, latin-1, utf-16"
        raise UsageError(message) from None
    except (OSError, EOFError) as error:
        message = f"{path} cannot be unpacked: {error}"
        raise DataError(message) from None
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


def _no_text(path: Path, layout: Layout) -> str:
    encoding = layout.encoding.removesuffix("-sig")
    with path.open("rb") as file:
        wide = file.read(2) in {b"\xff\xfe", b"\xfe\xff"}
    likely = "utf-16" if wide else "latin-1 (or cp1252, utf-16, ...)"
    return f"{path} is not text in {encoding}: a binary file, or name the encoding: --encoding {likely}"


def _names(fields: list[str]) -> list[str]:
    return [field.strip() or f"Unnamed {position + 1}" for position, field in enumerate(fields)]


def _zipped(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(2) == b"\x1f\x8b"


def _open(path: Path, encoding: str) -> TextIO:
    if _zipped(path):
        return gzip.open(path, "rt", encoding=encoding, newline="")
    return path.open(encoding=encoding, newline="")
