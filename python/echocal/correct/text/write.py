"""Lines with their results."""

from typing import Any

import numpy as np

from echocal.correct.results import RESULTS
from echocal.correct.rows import Rows
from echocal.correct.text.parse import Lines
from echocal.observations.arrow import arrow, has_arrow

__all__ = ["header_with_results", "with_results"]

_DIGITS = 9  # of a distance [m]: to a nanometer
_SMALL = 1e-6  # below, numbers have an exponent


def header_with_results(header: str, separator: str) -> str:
    """The header with the names of the results."""
    return separator.join((header, *RESULTS))


def with_results(lines: Lines, rows: Rows, separator: str, decimal: str) -> bytes:
    """The lines of a block, each row with its results."""
    suffixes = _suffixes(rows, separator, decimal)
    if lines.records is not None:
        made = suffixes if isinstance(suffixes, list) else suffixes.to_pylist()
        places = {place: number for number, place in enumerate(lines.rows)}
        return "".join(
            f"{text}{separator}{made[places[place]]}{ended[len(text) :]}" if place in places else ended
            for place, (text, ended) in enumerate(lines.records)
        ).encode()
    pa = arrow()
    pc = pa.compute
    ended = pc.binary_join_element_wise(suffixes, "", lines.end)
    joined = pc.binary_join_element_wise(lines.texts, ended, separator)
    data = b"".join(_bytes(part) for part in (joined.chunks if hasattr(joined, "chunks") else [joined]))
    return data if lines.last else data[: -len(lines.end)]


def _suffixes(rows: Rows, separator: str, decimal: str) -> Any:
    """Results of each row as text, in an Arrow array; in a list where Arrow is not installed."""
    reasons = [_quoted(reason, separator) for reason in rows.reasons]
    status = [f"{reason}{separator}{reason}" for reason in reasons]
    numbers = (np.round(rows.distance, _DIGITS), rows.uncertainty)
    if not has_arrow():
        texts = [[_shortest(value).replace(".", decimal) for value in own] for own in numbers]
        own_status = [status[code] for code in rows.codes.tolist()]
        return [separator.join(fields) for fields in zip(*texts, own_status, strict=True)]
    pa = arrow()
    distance, uncertainty = (_texts(own, decimal) for own in numbers)
    taken = pa.array(status).take(pa.array(rows.codes))
    return pa.compute.binary_join_element_wise(distance, uncertainty, taken, separator)


def _texts(numbers: Any, decimal: str) -> Any:
    """The shortest digits that are the number again; empty where there is none."""
    pa = arrow()
    pc = pa.compute
    absent = np.isnan(numbers)
    if absent.all():
        return pa.array([""]).take(pa.array(np.zeros(len(numbers), np.int8)))
    texts = pc.cast(pa.array(numbers, mask=absent if absent.any() else None), pa.string())
    texts = pc.fill_null(texts, "")
    return texts if decimal == "." else pc.replace_substring(texts, ".", decimal)


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
