"""Lines with their results."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from echocal import _core
from echocal.correct.results import RESULTS
from echocal.correct.rows import Rows
from echocal.correct.text.parse import Lines
from echocal.observations.arrow import arrow

__all__ = ["header_with_results", "with_empty", "with_results"]

_DIGITS = 9  # of a distance [m]: to a nanometer
_SMALL = 1e-6  # below, numbers have an exponent


def header_with_results(header: str, separator: str) -> str:
    """The header with the names of the results."""
    return separator.join((header, *RESULTS))


def with_empty(lines: Sequence[str], separator: str) -> str:
    """Lines between the header and the rows, with an empty field for each result."""
    more = separator * len(RESULTS)
    bare = (line.rstrip("\r\n") for line in lines)
    return "".join(text + more + line[len(text) :] for text, line in zip(bare, lines, strict=True))


def with_results(lines: Lines, rows: Rows, separator: str, decimal: str) -> bytes:
    """The lines of a block, each row with its results."""
    if lines.ends is not None:
        made = _by_core(lines, rows, separator)
        if made is not None:
            return made if lines.last else made[: -len(lines.end)]
        lines = _apart(lines)  # a number is too large for the core
    if lines.records is not None:
        suffixes = _suffixes(rows, separator, decimal)
        places = {place: number for number, place in enumerate(lines.rows)}
        return "".join(
            f"{text}{separator}{suffixes[places[place]]}{end}" if place in places else text + end
            for place, (text, end) in enumerate(lines.records)
        ).encode()
    pa = arrow()
    distance, uncertainty = (_texts(own, decimal) for own in _numbers(rows))
    status = [(text + lines.end).encode() for text in _statuses(rows, separator)]
    taken = pa.array(status, pa.binary()).take(pa.array(rows.codes)) if rows.codes.any() else status[0]
    cut = separator.encode()
    joined = pa.compute.binary_join_element_wise(lines.texts, distance, uncertainty, taken, cut)
    data = b"".join(_bytes(part) for part in (joined.chunks if hasattr(joined, "chunks") else [joined]))
    return data if lines.last else data[: -len(lines.end)]


def _by_core(lines: Lines, rows: Rows, separator: str) -> bytes | None:
    """The same for plain lines; None if a number is too large."""
    tails = [f"{separator}{text}{lines.end}".encode() for text in _statuses(rows, separator)]
    results = rows.distance, rows.uncertainty, rows.codes, tails
    return _core.with_results(lines.data, lines.ends, len(lines.end), ord(separator), *results)


def _apart(lines: Lines) -> Lines:
    """Plain lines one by one."""
    ends = [*lines.ends.tolist()]
    begins = [0, *(end + len(lines.end) for end in ends)]
    texts = [lines.data[begin:end].decode() for begin, end in zip(begins, ends, strict=False)]
    records = [(text, lines.end) for text in texts[:-1]] + [(text, lines.last) for text in texts[-1:]]
    return Lines(records=records, rows=range(len(records)))


def _suffixes(rows: Rows, separator: str, decimal: str) -> list[str]:
    """Results of each row as text; slower, and without Arrow."""
    texts = [[_shortest(value).replace(".", decimal) for value in own] for own in _numbers(rows)]
    status = _statuses(rows, separator)
    own_status = [status[code] for code in rows.codes.tolist()]
    return [separator.join(fields) for fields in zip(*texts, own_status, strict=True)]


def _numbers(rows: Rows) -> tuple[Any, Any]:
    return np.round(rows.distance, _DIGITS), rows.uncertainty


def _statuses(rows: Rows, separator: str) -> list[str]:
    """Both columns of the reason, by its place."""
    reasons = [_quoted(reason, separator) for reason in rows.reasons]
    return [f"{reason}{separator}{reason}" for reason in reasons]


def _texts(numbers: Any, decimal: str) -> Any:
    """The shortest digits that are the number again; empty where there is none."""
    pa = arrow()
    pc = pa.compute
    absent = np.isnan(numbers)
    if absent.all():
        return b""
    texts = pc.cast(pa.array(numbers, mask=absent if absent.any() else None), pa.string())
    if absent.any():
        texts = pc.fill_null(texts, "")
    return (texts if decimal == "." else pc.replace_substring(texts, ".", decimal)).cast(pa.binary())


def _shortest(number: Any) -> str:
    """The same as Arrow writes."""
    if np.isnan(number):
        return ""
    if 0.0 < abs(number) < _SMALL:
        digits, exponent = np.format_float_scientific(number, trim="-").split("e")
        return f"{digits}e{int(exponent)}"
    return np.format_float_positional(number, trim="-")


def _quoted(reason: str, separator: str) -> str:
    if separator in reason or '"' in reason:
        return '"' + reason.replace('"', '""') + '"'
    return reason


def _bytes(array: Any) -> bytes:
    """The bytes of the texts of an array, one after the other."""
    if not len(array):
        return b""
    kind = np.int64 if str(array.type).startswith("large") else np.int32
    offsets = np.frombuffer(array.buffers()[1], kind)[array.offset : array.offset + len(array) + 1]
    return bytes(memoryview(array.buffers()[2])[offsets[0] : offsets[-1]])
