"""Correct one file or a folder, by the functions of an earlier version."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from echocal.correct.batch import correct_files
from echocal.correct.inputs import ENDINGS
from echocal.correct.said import sentences
from echocal.correct.tables import Corrected
from echocal.errors import DataError, UsageError, writing
from echocal.model import Model
from echocal.observations.layout import Layout
from echocal.observations.source import is_folder
from echocal.places import Place

__all__ = ["correct_file", "correct_folder"]


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
        Text or Parquet; `out` by its ending (.csv, .tsv, either with .gz, .parquet, .pq).
    model : Model
        The model of air and device.
    columns : mapping of str to str, optional
        Meaning of columns, by their names.
    layout : Layout, optional
        How a text file is written.
    **options
        As in `echocal.correct_files`.

    Returns
    -------
    Corrected
        Without the table.

    Raises
    ------
    DataError
        If a file cannot be read or written; there is no output then.
    UsageError
        If the ending of `out` is unknown, or `out` is `source`.
    """
    source, out = Path(source), Path(out)
    refuse_ending(out)
    with writing(out):
        same = out.exists() and out.samefile(source)
    if same:
        message = f"{out} is the input itself; choose another output"
        raise UsageError(message)
    if is_folder(source):
        message = f"{source} is a folder; correct_files corrects all files of it"
        raise DataError(message)
    summary = correct_files(source, out, model, columns=columns, layout=layout, **options)
    (result,) = summary.results.values()
    return _corrected(result)


def correct_folder(
    source: Path,
    out: Path,
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    progress: Callable[[int, int], None] = lambda done, total: None,
    **options: Any,
) -> dict[Path, Corrected]:
    """Correct every file of a folder into another folder, under the same names.

    Parameters
    ----------
    progress : callable
        Called with the files done and their total, after each.
    **options
        As in `echocal.correct_files`.

    Returns
    -------
    dict of Path to Corrected
        By output file, without the tables.

    Raises
    ------
    DataError
        If a file cannot be corrected; all others are.
    """
    seen = 0

    def tell(state: Any) -> None:
        nonlocal seen
        if state.files > seen:
            seen = state.files
            progress(state.files, state.of_files)

    summary = correct_files(source, out, model, columns=columns, progress=tell, **options)
    if summary.set_aside:
        done = len(summary.results) - len(summary.set_aside)
        first = next(iter(summary.set_aside.values()))
        message = f"{first} ({done} of {len(summary.results)} files are done)"
        raise DataError(message)
    return {Path(out) / place: _corrected(result) for place, result in summary.results.items()}


def refuse_ending(path: Place) -> None:
    """Raise `UsageError` for an output of an unknown kind."""
    if not path.name.lower().endswith(ENDINGS):
        message = f"cannot write {path}; endings: {', '.join(ENDINGS)}"
        raise UsageError(message)


def _corrected(result: Mapping[str, Any]) -> Corrected:
    notes = tuple(sentences([result]))
    return Corrected(pd.DataFrame(), result["rows"], result["unusable"], notes, result["marked"])
