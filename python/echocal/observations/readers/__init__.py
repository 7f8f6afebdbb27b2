"""Logs as they are: one format, one file. Each turns a log into a table of named columns.

A format is a module with ``NAME``, ``recognizes(lines)`` of the first lines, and ``read(lines)``.
Delimited text, TOA5 and LabVIEW among it, is read by `echocal.observations.text`.
"""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import TextIO

import pandas as pd

from echocal.observations.found import Found, found_in, keep
from echocal.observations.layout import Layout, settled
from echocal.observations.limits import refuse_log_line
from echocal.observations.readers import (
    bursts,
    cell_units,
    esphome,
    json_records,
    line_protocol,
    literals,
    long_tables,
    maxbotix,
    messages,
    mqtt_lines,
    nmea,
    repeats,
    ros,
    serial_lines,
    spreadsheet,
    times,
    unit_names,
    white_space,
)
from echocal.observations.readers.stamps import plain

__all__ = ["format_of", "read", "tidy"]

_FORMATS = (
    nmea,
    json_records,
    literals,
    maxbotix,
    esphome,
    mqtt_lines,
    messages,
    line_protocol,
    serial_lines,
    white_space,
)
_STEPS = (ros.step, cell_units.step, long_tables.step, bursts.step, times.step, unit_names.step, repeats.step)
_FIRST = 200
_LOOK = 1 << 16  # characters of a line that tell the format; a document of JSON is one line


def read(path: Path, layout: Layout, sheet: str | None = None) -> pd.DataFrame | None:
    """Read a log that is no delimited text; None for one that is.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    if spreadsheet.is_one(path):
        return spreadsheet.read(path, sheet, layout.skip_lines)
    form = _form(path, layout)
    if form is None:
        return None
    from echocal.observations.text import below

    with below(path, settled(path, layout), layout.skip_lines) as file:
        log = form.read(list(_lines(file, form, path)), str(path))
    table = log.table(str(path))
    found = Found(
        form.NAME,
        log.units,
        tuple(log.notes),
        log.corrupt,
        False,
        log.requests,
        tuple(log.requests),
        log.joined,
    )
    return keep(table, found)


def _lines(file: TextIO, form: ModuleType, path: Path) -> Iterator[str]:
    for number, line in enumerate(file, 1):
        if form is not json_records:
            refuse_log_line(line, number, path)
        yield plain(line.rstrip("\r\n"))


def format_of(path: Path, layout: Layout) -> str:
    """What a person calls the format of a log that `echocal correct` cannot keep line by line; else empty."""
    if spreadsheet.is_one(path):
        return spreadsheet.NAME
    form = _form(path, layout)
    return "" if form is None else str(form.NAME)


def tidy(table: pd.DataFrame) -> pd.DataFrame:
    """The table of a log with one column for each quantity and one time."""
    if table.columns.has_duplicates:
        return table  # which is refused
    for step in _STEPS:
        found = found_in(table)
        made, found = step(table, found)
        table = keep(made, found)
    return table


def _form(path: Path, layout: Layout):  # type: ignore[no-untyped-def]
    from echocal.observations.text import below  # which knows this room

    with below(path, settled(path, layout), layout.skip_lines) as file:
        begins = iter(lambda: file.readline(_LOOK), "")
        lines = [plain(line.rstrip("\r\n")) for line in islice(begins, _FIRST)]
    lines = [line for line in lines if line.strip()]
    return next((form for form in _FORMATS if lines and form.recognizes(lines)), None)
