"""From bytes to rows, by the parsing of `echocal correct`; what is no row has a reason."""

import codecs
import io
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from echocal.correct.needed import refuse_repeated
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.found import CORRUPT, CUT
from echocal.observations.heading import FIRST, decimal_of, fields_of, head_in, is_value, names_of
from echocal.observations.layout import Head, Layout, said_no_text, seen_in
from echocal.observations.limits import from_json
from echocal.observations.scanner import Scanner
from echocal.watch.rows import Row

_MOST = 2000  # rows of a batch: what a stop by force repeats at most
_FEW = 20  # lines among which there is a header, or none comes
_SHOWN = 80  # letters of a text that a message shows
_KEPT = "surrogateescape"  # a byte that is no text stays, so that its line can be set aside as it is
_MARKS = {
    "utf-8-sig": {codecs.BOM_UTF8: "utf-8", b"": "utf-8"},
    "utf-16": {codecs.BOM_UTF16_BE: "utf-16-be", codecs.BOM_UTF16_LE: "utf-16-le", b"": "utf-16-le"},
    "utf-32": {codecs.BOM_UTF32_BE: "utf-32-be", codecs.BOM_UTF32_LE: "utf-32-le", b"": "utf-32-le"},
}
"""What a text in an encoding may begin with, and the encoding of what follows."""


class Unread(NamedTuple):
    """What is no row: where it came from, why it is none, and its text as it came."""

    source: str
    reason: str
    text: bytes


class Arrival(NamedTuple):
    """A row, what it was made of, where it came from, and why `echocal correct` would not read it."""

    row: Row
    text: bytes
    source: str
    why: str = ""


@dataclass
class Batch:
    """Rows that come together."""

    rows: list[Arrival] = field(default_factory=list)
    unread: list[Unread] = field(default_factory=list)
    decimal: str = "."
    """Decimal separator of texts."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units that a line below the header gives, by column."""
    notes: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.rows or self.unread or self.notes)

    def add(self, row: Row | None, why: str, text: bytes, source: str) -> None:
        """Add a row, or why a text is none."""
        if row is not None:
            self.rows.append(Arrival(row, text, source, why))
        else:
            self.unread.append(Unread(source, why, text))


class Parser:
    """From the bytes of one source to rows: JSON where a line begins with a brace, else below a header.

    The `source` is the name of the file or stream; `line` is the number of lines that were taken. With
    `only_json` every line is JSON; `kept` is what `to_dict` gave.
    """

    def __init__(
        self, source: str, layout: Layout, *, only_json: bool = False, kept: Mapping[str, Any] | None = None
    ) -> None:
        self._source, self._layout, self._only_json = source, layout, only_json
        new = {"encoding": "", "sure": False, "decimal": layout.decimal or "", "line": 0, "head": None}
        plain: Mapping[str, Any] = kept or new
        self._encoding, self._sure = str(plain["encoding"]), bool(plain["sure"])
        self._decimal, self.line = str(plain["decimal"]), int(plain["line"])
        self._head: Head | None = None
        if plain["head"] is not None:
            self._begin(Head(**{**plain["head"], "repeated": frozenset(plain["head"]["repeated"])}))

    @property
    def begun(self) -> bool:
        """Whether the header was found; lines of JSON need none."""
        return self._only_json or self._head is not None

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        head = self._head and {**vars(self._head), "repeated": sorted(self._head.repeated)}
        own = {"encoding": self._encoding, "sure": self._sure, "decimal": self._decimal, "line": self.line}
        return {**own, "head": head}

    def batches(self, data: bytes, *, final: bool) -> Iterator[tuple[Batch, int]]:
        """Rows of the whole lines at the beginning of some bytes, and how many bytes they are.

        Raises `DataError` if the header is no text, or none that `echocal correct` reads. `data` follows the
        lines so far; if it is `final`, nothing comes behind it, and the last line is whole without an end.
        """
        marked = self._open(data, final)
        if marked is None:
            return
        lines = list(io.StringIO(self._decoded(data[marked:], final), newline=""))
        if lines and not final and not lines[-1].endswith("\n"):
            lines.pop()  # also one with a carriage return, which a line feed may follow
        at, before = 0, self.line
        while at < len(lines):
            batch = Batch()
            end = self._some(lines, at, before, batch, final)
            if end == at:
                return
            size = marked + len("".join(lines[at:end]).encode(self._encoding, _KEPT))
            at, marked, self.line = end, 0, before + end
            self._see(batch)
            batch.decimal = self._decimal or "."
            batch.units = {} if self._head is None else self._head.units
            yield batch, size

    def _open(self, data: bytes, final: bool) -> int | None:
        """Bytes of the mark that a text begins with; None where that is not known yet."""
        marked = 0
        if not self._encoding:
            if len(data) < 4 and not final:
                return None
            name = codecs.lookup(self._layout.encoding).name
            marks = _MARKS.get(name, {b"": name})
            mark = next(mark for mark in marks if data.startswith(mark))
            marked, self._encoding = len(mark), marks[mark]
            self._sure = bool(mark) or name != "utf-8-sig"
        if not self._sure and not data.isascii():
            seen = seen_in(data, self._layout).encoding
            self._encoding, self._sure = self._encoding if seen == self._layout.encoding else seen, True
        return marked

    def _decoded(self, data: bytes, final: bool) -> str:
        try:
            return codecs.getincrementaldecoder(self._encoding)(_KEPT).decode(data, final)
        except UnicodeError:
            raise DataError(said_no_text(self._source, self._layout.encoding, data)) from None

    def _some(self, lines: list[str], at: int, before: int, batch: Batch, final: bool) -> int:
        """Take lines until a batch is full; the place of the next one."""
        while at < len(lines) and len(batch.rows) < _MOST:
            if before + at < self._layout.skip_lines:
                at += 1
                continue
            if self._only_json or (self._head is None and lines[at].lstrip().startswith("{")):
                self._add_json(lines[at], batch)
                at += 1
                continue
            end = (
                self._rows(lines, at, before, batch, final)
                if self._head is not None
                else self._look(lines, at, before, final)
            )
            if end == at:
                break
            at = end
        return at

    def _look(self, lines: list[str], at: int, before: int, final: bool) -> int:
        """Find the header; no line is taken while it may be another one that comes."""
        first = lines[at : at + FIRST]
        told = [line for line in first if line.strip() and not line.startswith("#")]
        if not told:
            return len(lines) if final else at
        if not _is_text(told[0]):
            raise DataError(said_no_text(self._source, self._layout.encoding, told[0].encode("utf-8", _KEPT)))
        try:
            head = head_in(first, replace(self._layout, skip_lines=before + at), self._source)
        except DataError:
            if final or len(told) >= _FEW or "\0" in told[0]:
                raise
            return at
        if head.nameless:
            raise DataError(
                f"{self._source} is text without a header, which cannot be watched: write the names of its "
                "columns into a first line"
            )
        below = [line for line in first[head.start - before - at :] if line.strip()]
        if not final and len(first) < FIRST and not any(_fits(line, head) for line in below):
            return at
        refuse_repeated(head.names)
        self._decimal = self._layout.decimal or decimal_of(below, head.separator)
        self._begin(head)
        return head.start - before

    def _begin(self, head: Head) -> None:
        self._head, self._names = head, set(head.names)
        self._scanner = Scanner(self._source, head, with_json=True)

    def _rows(self, lines: list[str], at: int, before: int, batch: Batch, final: bool) -> int:
        """Take rows below a header; the place of the next line."""
        assert self._head is not None
        for end in (
            at + _MOST - len(batch.rows),
            len(lines),
        ):  # a quoted field may have more lines than a batch
            data = "".join(lines[at:end]).encode("utf-8", _KEPT)
            block, wrong = self._scanner.scan(data, before + at + 1, last=end >= len(lines))
            if block.lines.taken or wrong:
                break
        begin = 0
        for _, behind, count, fields, is_cut in block.lines.records():
            if is_cut and not final:  # a quoted field that goes on
                self._begin(self._head)
                return at
            why = "" if is_cut is None else CUT if is_cut else CORRUPT
            texts = None if fields is None else [field.decode("utf-8", _KEPT) for field in fields]
            at += count
            if not self._take(data[begin:behind], texts, why, batch):
                return at
            begin = behind
        if wrong:  # of one line: the others go on
            batch.add(None, wrong, lines[at].encode("utf-8", _KEPT), self._source)
            at += 1
        return at

    def _take(self, text: bytes, fields: list[str] | None, why: str, batch: Batch) -> bool:
        """Take a row or a line that is none; not so for another header, below which all is new."""
        assert self._head is not None
        raw = text.decode("utf-8", _KEPT)
        if fields is None:
            if raw.lstrip().startswith("{") and not self._head.is_no_row(raw.rstrip("\r\n")):
                self._add_json(raw, batch)
            return True
        own = fields_of(raw, self._head.separator) if why else fields
        if any(map(raw.__contains__, self._names)) and self._is_header(own):
            refuse_repeated(names_of(own))
            again = self._head.repeated | {raw.rstrip("\r\n")}
            self._begin(replace(self._head, names=names_of(own), repeated=again))
            return False
        if not _is_text(raw):
            other = f"{keyword('encoding', 'latin-1')} (or cp1252, utf-16, ...)"
            how = f"; if the file is in another encoding: {other}"
            batch.add(None, f"{no_utf8(text) or 'no text'}{how}: {_shown(text)}", text, self._source)
        else:
            batch.add(dict(zip(self._head.names, fields, strict=True)), why, text, self._source)
        return True

    def _is_header(self, fields: list[str]) -> bool:
        """Whether most fields are names of the header: it comes again, or another one comes in its place."""
        own = self._names.intersection(map(str.strip, fields))
        return 2 * len(own) > len(fields) and not any(map(is_value, fields))

    def _add_json(self, line: str, batch: Batch) -> None:
        if line.strip():
            text = line.encode("utf-8", _KEPT)
            batch.add(*parsed(text), text, self._source)

    def _see(self, batch: Batch) -> None:
        """See the decimal separator in the first rows that have one, as far as `echocal correct` looks."""
        if self._head is not None and not self._decimal:
            rows = [arrival.text.decode("utf-8", "replace") for arrival in batch.rows]
            self._decimal = decimal_of(rows, self._head.separator) or ("." if self.line > FIRST else "")


def _fits(line: str, head: Head) -> bool:
    """Whether a line is a row below a header, so that this is the header."""
    fields = fields_of(line.rstrip("\r\n"), head.separator)
    while fields and not fields[-1].strip():
        fields.pop()
    if not 0 < len(fields) <= len(head.names) or any(map(is_value, head.names)):
        return False
    return any(map(is_value, fields))


def _is_text(line: str) -> bool:
    """Whether each byte is a part of a sign."""
    return line.isascii() or not any("\udc80" <= sign <= "\udcff" for sign in line)


def _shown(text: bytes) -> str:
    return text[:_SHOWN].decode("utf-8", errors="replace").rstrip("\r\n")


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
        found = from_json(text.decode("utf-8-sig"), object_pairs_hook=_object)
        json.dumps(found, ensure_ascii=False).encode()  # what cannot be written is not read
    except UnicodeDecodeError:
        return None, no_utf8(text)
    except UnicodeEncodeError:
        return None, "one half of a sign, which no text can have"
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


class _RepeatedError(Exception):
    """A JSON object has two fields of one name."""


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _RepeatedError(f"the field '{name[:_SHOWN]}' twice")
        found[name] = value
    return found
