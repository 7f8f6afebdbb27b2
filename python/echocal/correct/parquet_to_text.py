"""From Parquet to text: row by row in the order of the file, some thousand rows at a time."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal.correct.columns import as_text
from echocal.correct.corrector import Tally
from echocal.correct.job import Job
from echocal.correct.parquet.file import Parquet, arrow_file
from echocal.correct.rows import Rows, no_distance
from echocal.correct.tables import results_of
from echocal.correct.text.file import writing_text
from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.observations.arrow import Table, arrow, as_stored
from echocal.outputs import csv_text, spreadsheet_safe

_DAY = 86_400
_TICKS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}


def parquet_to_text(
    source: Path,
    out: Path,
    ending: str,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a Parquet file into a text file; see `correct_parquet`.

    Raises `DataError` if the file cannot be read, a value cannot be text, or a model needs what the file
    does not have; `out` is incomplete then. The `ending` is that of the output: ``.csv``, ``.tsv.gz``, ...
    """
    if job.append_only is not None:
        raise UsageError(f"{keyword('append_only')} is for Parquet to Parquet")
    read = Parquet(source, job, whole=True)
    with read.corrected(key, log, lambda rows, _: rows) as (tally, made):
        finest = _finest(read)
        with writing_text(out, ending.endswith(".gz")) as file:
            empty, _ = as_text(read.file.schema_arrow.empty_table())
            nothing = no_distance(0, first=job.reading.first)
            file.write(_lines(empty, nothing, ending, job, header=True).encode())
            for rows, table in zip(made, _stored(read), strict=True):
                fields, notes = as_text(table if finest is None else _with(table, finest))
                tally.notes |= dict.fromkeys(notes)
                text = _lines(fields, rows, ending, job, header=False)
                if finest is not None:
                    text = text[: text.rindex("\n", 0, -1) + 1] if "\n" in text[:-1] else ""
                file.write(text.encode())
                progress(len(rows.codes))
    return tally


def _stored(read: Parquet) -> Iterator[Table]:
    """All columns of each piece."""
    schema = (read.file.metadata.metadata or {}).get(b"ARROW:schema")
    with arrow_file(read.path) as file:
        for table in read.tables(file, None):
            yield as_stored(table, schema)


def _lines(fields: pd.DataFrame, rows: Rows, ending: str, job: Job, *, header: bool) -> str:
    results = pd.DataFrame(results_of(rows))
    results[rows.first] = np.round(results[rows.first], 9)  # to a nanometer
    table = fields.join(results)
    # a separator at the end of lines made columns without a name
    names = ["" if str(name).startswith("Unnamed ") else str(name) for name in table.columns]
    if job.spreadsheet_safe:
        names = [spreadsheet_safe(name) for name in names]
        table = table.map(lambda value: spreadsheet_safe(value) if isinstance(value, str) else value)
    decimal = job.reading.layout.decimal or "."
    separator = "\t" if ending.startswith(".tsv") else ";" if decimal == "," else ","
    return csv_text(table, header=names if header else False, sep=separator, decimal=decimal)


def _finest(read: Parquet) -> Mapping[str, int] | None:
    """The time of each column that needs most digits: how a column is written depends on all of its times."""
    pa = arrow()
    schema = read.file.schema_arrow
    times = [own.name for own in schema if pa.types.is_timestamp(own.type) or pa.types.is_duration(own.type)]
    if not times or len(read.pieces) < 2:
        return None
    found: dict[str, tuple[int, int]] = {}
    for table in read.tables(read.file, times):
        for name in times:
            column = table[name]
            ticks = column.drop_null().cast(pa.int64()).to_numpy()
            if len(ticks):
                best = _digits(ticks, _TICKS[column.type.unit])
                found[name] = max(found.get(name, (-1, 0)), best, key=lambda own: own[0])
    return {name: own[1] for name, own in found.items()} or None


def _digits(ticks: Any, second: int) -> tuple[int, int]:
    """How fine the finest of some times is, and that time: days, seconds, ms, us, ns."""
    steps = [_DAY * second, *(second // part for part in (1, 10**3, 10**6) if second >= part)]
    for level, step in reversed(list(enumerate(steps, start=1))):
        finer = ticks % step != 0
        if finer.any():
            return level, int(ticks[np.argmax(finer)])
    return 0, int(ticks[0])


def _with(table: Table, finest: Mapping[str, int]) -> Table:
    """A table with one row more, which has these times."""
    pa = arrow()
    columns = [
        pa.array([finest[own.name]], pa.int64()).cast(own.type)
        if own.name in finest
        else pa.nulls(1, own.type)
        for own in table.schema
    ]
    return pa.concat_tables([table, pa.table(columns, schema=table.schema)])
