"""Spreadsheets: .xlsx, .xls, .ods."""

import re
import zipfile
import zlib
from datetime import date, time, timedelta
from pathlib import Path
from typing import IO, Any

import pandas as pd

from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.found import Found, keep
from echocal.observations.heading import is_value
from echocal.observations.limits import refuse_cells
from echocal.observations.readers.log import numeric
from echocal.observations.units import is_unit_row

NAME = "a spreadsheet"

_SHEET = re.compile(r"xl/worksheets/[^/]+\.xml")
_CELL = re.compile(rb"\br=[\"']([A-Z]{1,3})(\d{1,7})[\"']")  # a row has digits only
_TAG = 1 << 16  # bytes of such an attribute at most
_PART = 1 << 20  # bytes that are looked at together

_LARGEST = 1 << 30
"""Bytes of a part of a spreadsheet, unpacked: twenty million cells; judgement."""


def read(path: Path, sheet: str | None, skip_rows: int = 0) -> pd.DataFrame:
    """Read a sheet; its header is the first row with as many texts as the rows below have values.

    Raises `DataError` if the file is none, or no sheet has a table, and `UsageError` if there is no such
    sheet.
    """
    try:
        from python_calamine import CalamineWorkbook
    except ImportError:
        raise DataError(
            f"{path} is a spreadsheet: pip install 'echocal[excel]', or save the table as CSV"
        ) from None
    _refuse_extent(path)
    try:
        book = CalamineWorkbook.from_path(str(path))
    except Exception as error:
        raise DataError(
            f"{path} is a zip archive or a spreadsheet; save the table as CSV ({error})"
        ) from None
    names = book.sheet_names
    if sheet is not None and sheet not in names:
        raise UsageError(f"{path} has no sheet '{sheet}'; it has: {', '.join(names)}")
    for name in [sheet] if sheet else names:
        rows = [
            row
            for row in book.get_sheet_by_name(name).to_python()[skip_rows:]
            if any(_filled(v) for v in row)
        ]
        table = _table(rows)
        if table is not None:
            other = f"sheet '{name}' of {len(names)} is read; another: {keyword('sheet', 'NAME')}"
            notes = (other,) if len(names) > 1 else ()
            frame, units = table
            return keep(frame, Found(NAME, units, () if sheet else notes, streams=False))
    raise DataError(f"{path} has no sheet with a row of names and rows of values below")


def _refuse_extent(path: Path) -> None:
    """Refuse a sheet with a cell far from the others: all cells between would be held in memory."""
    try:
        with zipfile.ZipFile(path) as archive:
            for part in archive.infolist():
                if part.file_size > _LARGEST:
                    raise DataError(
                        f"{path}: {part.filename} in it has {part.file_size:,} bytes, and {_LARGEST:,} are "
                        "the most; save the table as CSV"
                    )
                if _SHEET.fullmatch(part.filename):
                    with archive.open(part) as file:
                        refuse_cells(*_extent(file), f"{path}: {part.filename}")
    except (OSError, RuntimeError, NotImplementedError, EOFError, zipfile.BadZipFile, zlib.error):
        return  # the reader tells


def _extent(file: IO[bytes]) -> tuple[int, int, int]:
    """Rows and columns of a sheet down to its last cell, and the cells that it has."""
    rows = columns = filled = 0
    rest = b""
    while data := file.read(_PART):
        data = rest + data
        end = data.rfind(b">", max(len(data) - _TAG, 0)) + 1 or len(data)
        if cells := _CELL.findall(data, 0, end):
            letters, digits = zip(*cells, strict=True)
            rows = max(rows, *map(int, set(digits)))
            columns = max(columns, *map(_number, set(letters)))
            filled += len(cells)
        rest = data[end:]
    return rows, columns, filled


def _number(letters: bytes) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + letter - 64
    return number


def _table(rows: list[list[Any]]) -> tuple[pd.DataFrame, dict[str, str]] | None:
    for place, row in enumerate(rows[:-1]):
        width = sum(map(_filled, row))
        texts = [v for v in row if isinstance(v, str) and v.strip() and not is_value(v)]
        below = rows[place + 1 : place + 21]
        usual = sorted(sum(map(_filled, own)) for own in below)[len(below) // 2]
        if len(texts) != width or width < usual or not width:
            continue
        names = [str(v).strip() if _filled(v) else f"Unnamed {n + 1}" for n, v in enumerate(row)]
        units: dict[str, str] = {}
        first = place + 1
        if first < len(rows) and all(isinstance(v, str) for v in rows[first]) and is_unit_row(rows[first]):
            units = {n: u.strip() for n, u in zip(names, rows[first], strict=False) if u.strip()}
            first += 1
        values = [[_plain(v) for v in (own + [""] * len(names))[: len(names)]] for own in rows[first:]]
        frame = pd.DataFrame(values, columns=pd.Index(names), dtype=object)
        empty = [n for n in names if n.startswith("Unnamed") and frame[n].isin([None, ""]).all()]
        frame = frame.drop(columns=empty)
        return frame.apply(numeric), units
    return None


def _filled(value: Any) -> bool:
    return not (value is None or (isinstance(value, str) and not value.strip()))


def _plain(value: Any) -> Any:
    if isinstance(value, date | time | timedelta):
        return str(value)
    return (value.strip() or None) if isinstance(value, str) else value
