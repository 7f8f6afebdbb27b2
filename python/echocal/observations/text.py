"""Delimited text: CSV, TSV and their kin, gzipped or not."""

import codecs
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import DataError
from echocal.observations.file import TextFile
from echocal.observations.found import Found, keep, pointed, said_of
from echocal.observations.layout import Head
from echocal.observations.numbers import EMPTY, EXACT
from echocal.observations.scanner import Block, Scanner, texts_of

_PART = 1 << 24  # bytes that are scanned at a time
_TRUTHS = {"True": True, "TRUE": True, "true": True, "False": False, "FALSE": False, "false": False}


def blocks_of(file: TextFile, size: int) -> Iterator[Block]:
    """Blocks of the rows below the header, of so many bytes.

    Raises `DataError` if the file cannot be unpacked or is not text, or a quotation mark is wrong.
    """
    return Scanner(str(file.path), file.head).blocks(_parts(file, size), file.head.start + 1)


def _parts(file: TextFile, size: int) -> Iterator[bytes]:
    """Bytes below the header, in UTF-8."""
    with file.opened() as data:
        if codecs.lookup(file.layout.encoding).name not in ("utf-8", "utf-8-sig"):
            with file.below(data, file.head.start) as text:
                yield from (part.encode() for part in iter(lambda: text.read(size), ""))
            return
        data.seek(len(file.mark) + len("".join(file.prelude).encode()))
        yield from iter(lambda: data.read(size), b"")


def read(file: TextFile) -> pd.DataFrame:
    """Read a text file. Raises `DataError` if the file is not delimited text."""
    head = file.head
    corrupt: dict[int, str] = {}
    blocks, count = [], 0
    for block in blocks_of(file, _PART):
        if not block.is_text:
            raise file.no_text()
        corrupt |= {count + row: why for row, why in block.unread.items()}
        count += len(block.lines)
        blocks.append(block)
    _refuse_wide(str(file.path), head, blocks, count)
    label = file.layout.text_column
    columns = _columns(
        blocks, head, [place for place, name in enumerate(head.names) if name.strip() == label]
    )
    table = pd.DataFrame(dict(enumerate(columns)), copy=False)
    # a separator at the end of each line makes a column without name and values
    ends = [
        place
        for place, name in enumerate(head.names)
        if name.startswith("Unnamed") and table[place].isin(["", float("nan")]).all()
    ]
    found = Found(head.kind, dict(head.units), said_of(file.layout, head), corrupt)
    table = table.drop(columns=ends)
    table.columns = pd.Index([name for place, name in enumerate(head.names) if place not in ends])
    return keep(table, found)


def _refuse_wide(path: str, head: Head, blocks: Sequence[Block], count: int) -> None:
    """Refuse a text of which half the rows or more have more fields than the header."""
    wide = [
        (block.first + line, fields)
        for block in blocks
        for _, line, fields, is_cut in block.lines.unread()
        if not is_cut
    ]
    if not wide or 2 * len(wide) < count:
        return
    (number, fields), width = wide[0], len(head.names)
    comma = head.separator == "," and fields <= 2 * width
    hint = "; if its commas are decimal signs, quote such numbers, or write points" if comma else ""
    raise DataError(
        f"{path} cannot be read as rows of {width} fields like its header: Expected {width} fields in line "
        f"{number}, saw {fields}{hint}"
    )


def _columns(blocks: Sequence[Block], head: Head, labels: Sequence[int]) -> list["pd.Series[Any]"]:
    """Numbers where all fields of a column are, else texts; those of labels always."""
    decimal, absent = ord(head.decimal), [text.encode() for text in sorted(EMPTY)]
    places = [place for place in range(len(head.names)) if place not in labels]
    read = [block.lines.numbers(places, decimal, absent) for block in blocks]
    columns: dict[int, Any] = {}
    for place, *pieces in zip(places, *read, strict=True):
        if None not in pieces:
            numbers = np.concatenate([np.empty(0), *(values for values, _ in pieces)])
            # integers in a column with empty fields became floats, and the long ones were rounded
            if not (np.abs(numbers) >= EXACT).any():
                whole = all(are_whole for _, are_whole in pieces) and len(numbers)
                columns[place] = pd.Series(numbers.astype(np.int64) if whole else numbers)
    others = [place for place in range(len(head.names)) if place not in columns]
    wide = {place for place, *pieces in zip(places, *read, strict=True) if None not in pieces}
    texts = [block.lines.texts(others) for block in blocks]
    for place, *fields in zip(others, *texts, strict=True):
        own = texts_of(fields, EMPTY)
        columns[place] = own if place in labels else _told(own, head.decimal, is_wide=place in wide)
    return [columns[place] for place in range(len(head.names))]


def _told(texts: "pd.Series[Any]", decimal: str, *, is_wide: bool) -> "pd.Series[Any]":
    """Truths, integers that no float is, or texts in which numbers have a point."""
    filled = texts.dropna()
    if is_wide:
        if len(filled) == len(texts):
            try:
                return pd.Series([int(text) for text in texts], dtype=np.int64)
            except (ValueError, OverflowError):
                pass
        return texts.str.replace(decimal, ".", regex=False)
    if filled.iloc[:1].isin(_TRUTHS).all() and filled.isin(_TRUTHS).all():
        truths = texts.astype(object).map(_TRUTHS)
        return truths.astype(bool) if len(filled) == len(texts) else truths
    return pointed(texts) if decimal == "," else texts
