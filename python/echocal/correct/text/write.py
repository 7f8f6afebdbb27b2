"""Lines with their results."""

from typing import Any

import numpy as np

from echocal.correct.results import RESULTS
from echocal.correct.rows import Rows
from echocal.correct.text.parse import Lines
from echocal.observations.arrow import arrow

__all__ = ["header_with_results", "with_results"]

_DIGITS = 9  # of a distance [m]: to a nanometer


def header_with_results(header: str, separator: str) -> str:
    """The header with the names of the results."""
    return separator.join((header, *RESULTS))


def with_results(lines: Lines, rows: Rows, separator: str, decimal: str) -> bytes:
    """The lines of a block, each row with its results."""
    suffixes = _suffixes(rows, separator, decimal)
    if lines.records is not None:
        made = suffixes.to_pylist()
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
    pa = arrow()
    pc = pa.compute
    reasons = [_quoted(reason, separator) for reason in rows.reasons]
    status = pa.array([f"{reason}{separator}{reason}" for reason in reasons])
    distance = _texts(np.round(rows.distance, _DIGITS), decimal)
    uncertainty = _texts(rows.uncertainty, decimal)
    return pc.binary_join_element_wise(distance, uncertainty, status.take(pa.array(rows.codes)), separator)


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
