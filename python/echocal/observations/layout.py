"""How a text file is written."""

import codecs
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from echocal.errors import UsageError
from echocal.keywords import keyword

CUT_SIGN = "echocal.cut_sign"
"""How a file that is cut within a sign is decoded; anything else that is no text is an error."""

NO_SIGN = "\ufffd"
"""What stands in place of the sign."""

_OF_CUTS = ("unexpected end of data", "truncated data", "incomplete multibyte sequence")

_DEFAULT = "utf-8-sig"
_WESTERN = frozenset(b"\xb0\xb1\xb2\xb3\xb5\xe4\xf6\xfc\xc4\xd6\xdc\xdf")
"""Degree, plus-minus, square, cube, micro and German letters: the signs of units and names in cp1252."""


@dataclass(frozen=True)
class Layout:
    """How a text file is written, beyond what can be seen."""

    skip_lines: int = 0
    """Lines before the header; lines that begin with # there are skipped anyway."""
    decimal: str | None = None
    """Decimal separator; None: seen in the file."""
    encoding: str = _DEFAULT
    text_column: str = ""
    """Column whose fields stay as they are: ids, of which 7 and 007 are two."""

    def plain(self) -> dict[str, Any]:
        """As arguments of `echocal.read_observations`."""
        return {"skip_lines": self.skip_lines, "decimal": self.decimal, "encoding": self.encoding}

    def __post_init__(self) -> None:
        if not isinstance(self.skip_lines, int | np.integer) or not 0 <= self.skip_lines <= sys.maxsize:
            raise UsageError(f"skip_lines is {self.skip_lines!r}; give the number of lines before the header")
        if self.decimal not in {".", ",", None}:
            raise UsageError(f"decimal separator '{self.decimal}' is neither '.' nor ','")
        try:
            "".encode(self.encoding)  # also refuses one of bytes, such as zip
        except (LookupError, TypeError, ValueError):
            raise UsageError(
                f"unknown encoding '{self.encoding}'; common ones: utf-8, latin-1, utf-16"
            ) from None


@dataclass(frozen=True)
class Head:
    """What a delimited text begins with."""

    above: int
    """Lines down to the names of the columns, which are the last of them."""
    separator: str
    names: list[str]
    """Columns; one without a name has one by its place."""
    below: int = 0
    """Lines between the names and the first row: units, and how a logger made its values."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units that these lines give, by column."""
    decimal: str = "."
    comments: bool = True
    """Whether lines that begin with # are comments below the names, too."""
    repeated: frozenset[str] = frozenset()
    """The lines of the header: a logger that starts again writes them again."""
    kind: str = "delimited text"
    """What a person calls the format."""
    nameless: bool = False
    """Whether the file has no names of columns."""

    @property
    def start(self) -> int:
        """Lines down to the first row."""
        return self.above + self.below

    def is_no_row(self, line: str) -> bool:
        """Whether a line below the header is a comment, or the header once more."""
        return (self.comments and line.startswith("#")) or line in self.repeated


def _cut_sign(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeDecodeError):
        raise error
    if error.reason not in _OF_CUTS or error.end < len(error.object):
        raise error
    return NO_SIGN, error.end


codecs.register_error(CUT_SIGN, _cut_sign)


def said_no_text(name: str, encoding: str, begins: bytes) -> str:
    """Say that a text is none in its encoding, by its name and what it begins with."""
    encoding = encoding.removesuffix("-sig")
    wide = begins[:2] in {b"\xff\xfe", b"\xfe\xff"}
    likely = keyword("encoding", "utf-16" if wide else "latin-1") + (
        "" if wide else " (or cp1252, utf-16, ...)"
    )
    return f"{name} is not text in {encoding}: a binary file, or name the encoding: {likely}"


def seen_in(sample: bytes, layout: Layout) -> Layout:
    """The layout of a text that begins so, where its signs above ASCII can only be those of cp1252."""
    if layout.encoding != _DEFAULT or sample.isascii() or 0 in sample:
        return layout
    try:
        codecs.getincrementaldecoder("utf-8")().decode(sample)
    except UnicodeError:
        above = {byte for byte in sample if byte > 127}
        return replace(layout, encoding="cp1252") if above <= _WESTERN else layout
    return layout
