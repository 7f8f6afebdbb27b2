"""From text to Parquet and back: the whole file is in memory."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from echocal.correct.columns import as_text, from_text, with_results
from echocal.correct.corrector import Context, Corrector, Tally
from echocal.correct.job import Job
from echocal.correct.logs import surroundings
from echocal.correct.results import DISTANCE
from echocal.correct.tables import results_of
from echocal.errors import UsageError
from echocal.observations.arrow import arrow, read_parquet
from echocal.observations.found import Found
from echocal.observations.hints import completed
from echocal.observations.source import is_parquet, load, refuse_unstreamed
from echocal.observations.text import resolved

__all__ = ["convert"]

_COMPRESSIONS = {"UNCOMPRESSED": "NONE", "LZ4_RAW": "LZ4"}
"""Names for writing, where files call them differently."""


def convert(source: Path, out: Path, ending: str, job: Job, key: str | None) -> Tally:
    """Correct a file into one of another kind.

    Parameters
    ----------
    ending : str
        Of the output: ``.parquet``, ``.csv``, ...

    Raises
    ------
    DataError
        If the file cannot be read or written.
    """
    if job.append_only is not None:
        raise UsageError("--append-only is for Parquet to Parquet")
    parquet = is_parquet(source)
    if ending in (".parquet", ".pq"):
        arrow()  # fail early without it
    stored, compression = read_parquet(source) if parquet else (None, "SNAPPY")
    if parquet:
        job = replace(job, layout=replace(job.layout, decimal=job.layout.decimal or "."))
    else:
        refuse_unstreamed(source, job.layout)
        head, layout = resolved(source, job.layout)
        job = replace(
            job, layout=layout, requests=completed(head.names, job.requests, Found(units=head.units))[0]
        )
    table = load(source if stored is None else stored, job.layout)
    corrector = Corrector(list(table.columns), job, key)
    if corrector.remembers:
        context = surroundings([source], 0, corrector, lambda path: table, 1 << 62).context
    else:
        context = Context()
    rows, parts = corrector.correct(table, context, (0, len(table)))
    tally = Tally(columns=[str(name) for name in table.columns])
    tally.add(rows, parts)
    if tally.doubtful(job):
        corrector.correct(table, Context(), (0, len(table)), whole=True)
    results = pd.DataFrame(results_of(rows))
    if ending in (".parquet", ".pq"):
        if stored is None:
            verbatim = load(source, job.layout, verbatim=True)
            stored = from_text(verbatim[list(table.columns)], job.layout.decimal)
        metadata = {name.encode(): text.encode() for name, text in job.metadata.items()}
        whole = with_results(stored, results)
        whole = whole.replace_schema_metadata({**(whole.schema.metadata or {}), **metadata})
        codec = _COMPRESSIONS.get(compression, compression)
        arrow().parquet.write_table(whole, out, compression=codec)
        return tally
    fields, notes = as_text(stored)
    tally.notes |= dict.fromkeys(notes)
    _write_text(fields.join(results), out, ending, job.layout.decimal)
    return tally


def _write_text(table: pd.DataFrame, path: Path, ending: str, decimal: str) -> None:
    # a separator at the end of lines made columns without a name
    names = ["" if str(name).startswith("Unnamed ") else str(name) for name in table.columns]
    separator = "\t" if ending.startswith(".tsv") else ";" if decimal == "," else ","
    compression: Literal["gzip"] | None = "gzip" if ending.endswith(".gz") else None
    rounded = table.assign(**{DISTANCE: np.round(table[DISTANCE], 9)})  # to a nanometer
    rounded.to_csv(path, index=False, header=names, sep=separator, decimal=decimal, compression=compression)
