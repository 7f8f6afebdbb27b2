"""Logs as they are: one format, one file. Each turns a log into a table of named columns.

A format is a module with ``NAME``, ``recognizes(lines)`` of the first lines, and ``read(lines)``.
Delimited text, TOA5 and LabVIEW among it, is read by `echocal.observations.text`.
"""

from collections.abc import Iterator
from itertools import islice
from types import ModuleType
from typing import TextIO

import pandas as pd

from echocal.observations.file import TextFile
from echocal.observations.found import Found, found_in, keep
from echocal.observations.heading import FIRST
from echocal.observations.limits import LOG_LINE
from echocal.observations.readers import (
    bursts,
    date_pieces,
    esphome,
    json_records,
    line_protocol,
    literals,
    long_tables,
    maxbotix,
    messages,
    mqtt_lines,
    nmea,
    recordings,
    serial_lines,
    spreadsheet,
    times,
    unit_steps,
    white_space,
)
from echocal.observations.readers.stamps import plain

__all__ = ["format_of", "read", "tidy", "with_dates"]

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
_STEPS = (
    unit_steps.units_of_messages,
    unit_steps.units_in_cells,
    long_tables.step,
    bursts.step,
    date_pieces.step,
    times.step,
    unit_steps.columns_named_by_unit,
    unit_steps.repeated,
)


_OF_JSON = (json_records, mqtt_lines, messages)
_NO_LINE = "(a line that is longer than those of a log)"  # without a value, as which it is counted
_LOOK = 1 << 16  # characters of a line that tell the format; a document of JSON is one line


def read(file: TextFile, sheet: str | None = None) -> pd.DataFrame | None:
    """Read a log that is no delimited text; None for one that is. Raises `DataError` if it cannot be read."""
    if file.recording:
        return recordings.read(file.path, file.recording)
    if file.is_spreadsheet:
        return spreadsheet.read(file.path, sheet, file.layout.skip_lines)
    form = _form(file)
    if form is None:
        return None
    with file.opened() as data, file.below(data, file.layout.skip_lines) as text:
        log = form.read(list(_lines(text, form)), str(file.path))
    table = log.table(str(file.path))
    beside = (log.units, tuple(log.notes), log.corrupt, False, log.requests, tuple(log.requests), log.joined)
    return keep(table, Found(form.NAME, *beside))


def _lines(text: TextIO, form: ModuleType) -> Iterator[str]:
    for line in (one.rstrip("\r\n") for one in text):
        yield plain(line if len(line) <= LOG_LINE or form in _OF_JSON else _NO_LINE)


def format_of(file: TextFile) -> str:
    """What a person calls the format of a log that `echocal correct` cannot keep line by line; else empty."""
    if file.is_spreadsheet or file.recording:
        return file.recording or spreadsheet.NAME
    form = _form(file)
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


def with_dates(table: pd.DataFrame) -> pd.DataFrame:
    """A table of a library with one time, where it has a date in pieces."""
    made, found = date_pieces.step(table, found_in(table))
    return table if made is table else keep(made, found)


def _form(file: TextFile) -> ModuleType | None:
    begins = (line[at : at + _LOOK] for line in file.first for at in range(0, len(line), _LOOK))
    plainly = (plain(line.rstrip("\r\n")) for line in islice(begins, FIRST))
    lines = [line for line in plainly if line.strip()]
    return next((form for form in _FORMATS if lines and form.recognizes(lines)), None)
