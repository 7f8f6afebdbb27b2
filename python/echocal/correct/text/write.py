"""Lines with their results."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from echocal.correct.results import RESULTS, results
from echocal.correct.rows import Rows
from echocal.correct.text.parse import Lines

__all__ = ["header_with_results", "with_empty", "with_results"]

_DIGITS = 9  # of a distance [m]: to a nanometer
_SMALL = 1e-6  # below, numbers have an exponent


def header_with_results(header: str, separator: str, first: str) -> str:
    """The header with the names of the results."""
    return separator.join((header, *results(first)))


def with_empty(lines: Sequence[str], separator: str) -> str:
    """Lines between the header and the rows, with an empty field for each result."""
    more = separator * len(RESULTS)
    bare = (line.rstrip("\r\n") for line in lines)
    return "".join(text + more + line[len(text) :] for text, line in zip(bare, lines, strict=True))


def with_results(lines: Lines, rows: Rows, separator: str, decimal: str) -> bytes | memoryview:
    """The lines of a block, each row with its results."""
    if lines.records is not None:
        made = _suffixes(rows, separator, decimal)
        places = {place: number for number, place in enumerate(lines.rows)}
        return "".join(
            f"{text}{separator}{made[places[place]]}{end}" if place in places else text + end
            for place, (text, end) in enumerate(lines.records)
        ).encode()
    assert lines.texts is not None
    written = lines.texts.with_results(
        rows.distance,
        rows.uncertainty,
        rows.codes,
        [status.encode() for status in _statuses(rows, separator)],
        separator.encode(),
        ord(decimal),
        bool(lines.last),
    )
    return written.data


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
