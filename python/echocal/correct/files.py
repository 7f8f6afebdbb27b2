"""Correct files: CSV and Parquet, one or a folder of them. An output is complete or absent."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from echocal.correct.columns import as_text, from_text, with_results
from echocal.correct.tables import RESULTS, Corrected, correct_table
from echocal.errors import DataError, UsageError, writing
from echocal.model import Model
from echocal.observations.arrow import Table, arrow, read_parquet
from echocal.observations.source import is_folder, is_parquet, load
from echocal.observations.text import Layout
from echocal.outputs import replacing

__all__ = ["correct_file", "correct_folder"]

_TEXTS = (".csv", ".tsv", ".csv.gz", ".tsv.gz")
_COMPRESSIONS = {"UNCOMPRESSED": "NONE", "LZ4_RAW": "LZ4"}
"""Names for writing, where files call them differently."""


def correct_file(
    source: Path,
    out: Path,
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    layout: Layout | None = None,
    **options: Any,
) -> Corrected:
    """Correct one file. From text to text, every field stays the same text.

    Parameters
    ----------
    source, out : Path
        Text or Parquet; `out` by its ending (.csv, .tsv, either with .gz, .parquet).
    model : Model
        The model of air and device.
    columns : mapping of str to str, optional
        Meaning of columns, by their names.
    layout : Layout, optional
        How a text file is written.
    **options
        As in `echocal.read_observations`.

    Raises
    ------
    DataError
        If a file cannot be read or written; there is no output then.
    UsageError
        If the ending of `out` is unknown, or `out` is `source`.
    """
    ending = _ending(out)
    parquet = is_parquet(source)
    with writing(out):
        same = out.exists() and out.samefile(source)
    if same:
        message = f"{out} is the input itself; choose another output"
        raise UsageError(message)
    layout = layout or Layout()
    if ending == ".parquet":
        arrow()  # fail early without it
    stored, compression = read_parquet(source) if parquet else (None, "SNAPPY")
    corrected = correct_table(load(source if stored is None else stored, layout), model, columns, **options)
    results = corrected.table[list(RESULTS)]
    notes: list[str] = []
    if ending == ".parquet":
        if stored is None:
            kept = [name for name in corrected.table.columns if name not in RESULTS]
            stored = from_text(load(source, layout, verbatim=True)[kept], layout.decimal)
        whole = with_results(stored, results)
        with replacing(out) as unfinished:
            _write_parquet(whole, unfinished, compression)
    else:
        fields, notes = as_text(stored) if parquet else (load(source, layout, verbatim=True), [])
        with replacing(out) as unfinished:
            _write_text(fields.join(results), unfinished, ending, layout.decimal)
    return replace(corrected, notes=(*corrected.notes, *notes))


def correct_folder(
    source: Path,
    out: Path,
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    progress: Callable[[int, int], None] = lambda done, total: None,
    **options: Any,
) -> dict[Path, Corrected]:
    """Correct every Parquet file of a folder into another folder, under the same names.

    Parameters
    ----------
    progress : callable
        Called with the files done and their total, after each.

    Returns
    -------
    dict of Path to Corrected
        By output file, without the tables.
    """
    files = sorted(source.rglob("*.parquet")) if is_folder(source) else []
    if not files:
        message = f"{source} has no .parquet file"
        raise DataError(message)
    if source.resolve() in (out.resolve(), *out.resolve().parents):
        message = f"{out} is or lies in the input itself; choose another output"
        raise UsageError(message)
    done: dict[Path, Corrected] = {}
    for file in files:
        target = out / file.relative_to(source)
        try:
            with writing(target.parent):
                target.parent.mkdir(parents=True, exist_ok=True)
            result = correct_file(file, target, model, columns, **options)
        except (DataError, UsageError) as error:
            message = f"{file}: {error} ({len(done)} of {len(files)} files are done)"
            raise type(error)(message) from None
        done[target] = replace(result, table=result.table.iloc[:0])
        progress(len(done), len(files))
    return done


def _ending(path: Path) -> str:
    ending = next((ending for ending in (*_TEXTS, ".parquet") if path.name.lower().endswith(ending)), None)
    if ending is None:
        message = f"cannot write {path}; endings: {', '.join(_TEXTS)}, .parquet"
        raise UsageError(message)
    return ending


def _write_parquet(table: Table, path: Path, compression: str) -> None:
    arrow().parquet.write_table(table, path, compression=_COMPRESSIONS.get(compression, compression))


def _write_text(table: pd.DataFrame, path: Path, ending: str, decimal: str) -> None:
    # a separator at the end of lines made columns without a name
    names = ["" if str(name).startswith("Unnamed ") else str(name) for name in table.columns]
    separator = "\t" if ending.startswith(".tsv") else ";" if decimal == "," else ","
    compression: Literal["gzip"] | None = "gzip" if ending.endswith(".gz") else None
    rounded = table.assign(**{RESULTS[0]: np.round(table[RESULTS[0]], 9)})  # to a nanometer
    rounded.to_csv(path, index=False, header=names, sep=separator, decimal=decimal, compression=compression)
