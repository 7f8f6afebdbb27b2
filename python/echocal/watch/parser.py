"""From lines and messages to rows; what is none has a reason."""

import csv
import json
import re
from dataclasses import dataclass, field
from typing import Any

from echocal.errors import DataError
from echocal.observations.heading import is_value
from echocal.watch.rows import Row

__all__ = ["Batch", "Parser", "Unread", "json_of", "parsed"]

_COMMA = re.compile(r"\s*[-+]?\d*,\d+\s*")
_POINT = re.compile(r"\s*[-+]?\d*\.\d+(?:[eE][-+]?\d+)?\s*")
_DEEPEST = 100  # lists and objects in each other: what writes them again stands on a stack of its own
_SHOWN = 80  # letters of a text that a message shows


@dataclass(frozen=True)
class Unread:
    """What is no row.

    Attributes
    ----------
    source : str
        File or topic.
    reason : str
    text : bytes
        As it came.
    """

    source: str
    reason: str
    text: bytes


@dataclass
class Batch:
    """Rows that come together.

    Attributes
    ----------
    rows : list of Row
    texts : list of bytes
        What each row was made of.
    unread : list of Unread
    source : str
    decimal : str
        Decimal separator of texts.
    notes : list of str
    """

    rows: list[Row] = field(default_factory=list)
    texts: list[bytes] = field(default_factory=list)
    unread: list[Unread] = field(default_factory=list)
    source: str = ""
    decimal: str = "."
    notes: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.rows or self.unread or self.notes)

    def add(self, row: Row | None, why: str, text: bytes, source: str) -> None:
        """Add a row, or why a text is none; nothing for a header."""
        if row is not None:
            self.rows.append(row)
            self.texts.append(text)
        elif why:
            self.unread.append(Unread(source, why, text))


class Parser:
    """From lines to rows: JSON where a line begins with a brace, else fields below a header.

    Parameters
    ----------
    separator : str
    header : list of str or None
        None: the next line is one.
    decimal : str
        Decimal separator, as far as it was seen; empty for not yet.
    """

    def __init__(self, separator: str = ",", header: list[str] | None = None, decimal: str = "") -> None:
        self.separator, self.header, self.decimal = separator, header, decimal

    def batch(self, lines: list[bytes], source: str) -> Batch:
        """Rows of whole lines."""
        found = Batch(source=source)
        for line in lines:
            row, why = self.row(line)
            found.add(row, why, line, source)
        found.decimal = self.decimal or "."
        return found

    def row(self, line: bytes) -> tuple[Row | None, str]:
        """A row, or why the line is none; neither for a header or an empty line."""
        text = line.decode("utf-8", errors="replace").strip("\r\n\ufeff")
        why = no_utf8(line) if "\ufffd" in text else ""
        if self.header is None and (why or "\0" in text):
            message = f"the header is no text in UTF-8, in which a watched file must be: {text[:_SHOWN]}"
            raise DataError(message)
        if why:
            return None, f"{why}: {text[:_SHOWN]}"
        if not text.strip() or text.startswith("#"):
            return None, ""
        if text.lstrip().startswith("{"):
            return parsed(line)
        try:
            fields = next(csv.reader([text], delimiter=self.separator, strict=True))
        except csv.Error as error:
            return None, f"a line cannot be cut into fields ({error}): {text[:_SHOWN]}"
        if self.header is None or self._is_header(fields):
            self._begin(text, fields)
            return None, ""
        if len(fields) != len(self.header):
            return None, f"a line has {len(fields)} fields, its header {len(self.header)}: {text[:_SHOWN]}"
        self._see(fields)
        return dict(zip(self.header, fields, strict=True)), ""

    def _is_header(self, fields: list[str]) -> bool:
        """Whether most fields are names of the header: it comes again, or another one comes in its place."""
        names = {field.strip() for field in fields}
        return 2 * len(names & set(self.header or ())) > len(fields) and not any(map(is_value, fields))

    def _begin(self, text: str, fields: list[str]) -> None:
        if ";" in text and len(fields) == 1:
            self.separator = ";"
            fields = next(csv.reader([text], delimiter=";"))
        self.header = [field.strip() for field in fields]
        if len(set(self.header)) < len(self.header):
            message = f"the header names a column twice: {text[:200]}"
            raise DataError(message)

    def _see(self, fields: list[str]) -> None:
        """See the decimal separator in the first line that has one."""
        if self.decimal or self.separator == ",":
            return
        if any(map(_POINT.fullmatch, fields)):
            self.decimal = "."
        elif any(map(_COMMA.fullmatch, fields)):
            self.decimal = ","

    def to_dict(self) -> dict[str, Any]:
        """As plain data: the arguments of another one that goes on."""
        return dict(vars(self))


def parsed(text: bytes) -> tuple[Row | None, str]:
    """A row from a JSON object, or why there is none.

    Examples
    --------
    >>> from echocal.watch.parser import parsed
    >>> parsed(b'{"echo_us": 11660}'), parsed(b"[1]")
    (({'echo_us': 11660}, ''), (None, 'no JSON object: [1]'))
    """
    shown = text[:_SHOWN].decode("utf-8", errors="replace")
    found, why = json_of(text)
    if not why and not (isinstance(found, dict) and found):
        why = "no JSON object" if found != {} else "an object without fields"
    return (None, f"{why}: {shown}") if why else (found, "")


def json_of(text: bytes) -> tuple[Any, str]:
    """What a JSON text holds, or why it cannot be read."""
    try:
        found = json.loads(text.decode("utf-8-sig"), object_pairs_hook=_object)
        if _is_deep(found):
            return None, f"nested more than {_DEEPEST} deep"
        json.dumps(found, ensure_ascii=False).encode()  # what cannot be written is not read
    except UnicodeDecodeError:
        return None, no_utf8(text)
    except UnicodeEncodeError:
        return None, "one half of a sign, which no text can have"
    except RecursionError:
        return None, "nested too deeply"
    except _RepeatedError as error:
        return None, str(error)
    except ValueError as error:
        return None, f"no JSON ({error})"
    return found, ""


def no_utf8(text: bytes) -> str:
    """Where a text is no UTF-8; empty if it is."""
    try:
        text.decode()
    except UnicodeDecodeError as error:
        return f"no UTF-8 ({error.reason} at byte {error.start})"
    return ""


def _is_deep(found: Any) -> bool:
    level, depth = [found], 0
    while level and depth <= _DEEPEST:
        inner = [one for one in level if isinstance(one, dict | list)]
        level = [item for one in inner for item in (one.values() if isinstance(one, dict) else one)]
        depth += bool(inner)
    return depth > _DEEPEST


class _RepeatedError(Exception):
    """A JSON object has two fields of one name."""


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            message = f"the field '{name[:_SHOWN]}' twice"
            raise _RepeatedError(message)
        found[name] = value
    return found
