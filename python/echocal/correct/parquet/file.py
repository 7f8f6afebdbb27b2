"""Correct one Parquet file: its columns are copied byte by byte, and the results are appended."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from echocal.correct.corrector import Context, Corrector, Tally
from echocal.correct.job import Job
from echocal.correct.logs import surroundings
from echocal.correct.parquet import footer as f
from echocal.correct.parquet.splice import Encoded, Splice, encode
from echocal.correct.rows import Rows
from echocal.correct.stream import corrected
from echocal.errors import DataError, UsageError, among
from echocal.keywords import keyword
from echocal.model.folder import label
from echocal.observations.arrow import arrow, to_pandas
from echocal.outputs import opened_output

__all__ = [
    "FIXED",
    "Opened",
    "arrow_file",
    "check_whole",
    "correct_parquet",
    "keys_of",
    "names_of",
    "opened_file",
    "read_pieces",
    "read_tables",
    "surroundings_of",
    "tally_of",
]

_CODECS = {"UNCOMPRESSED": "NONE", "LZ4_RAW": "LZ4"}
"""Names for writing, where files call them differently."""

FIXED = 220 << 20
"""Bytes that Python and the libraries take before the first row; measured."""

_BYTES_A_ROW = 500
"""Bytes that a row takes while it is corrected, by each thread; measured."""

_PIECE = (4096, 1 << 18)
"""Least and largest number of rows that are corrected together."""
_INDEX = "__index_level_0__"


@dataclass(frozen=True)
class Piece:
    """Rows that are corrected together: some row groups, or a part of one."""

    groups: tuple[int, ...]
    sizes: tuple[int, ...]
    """Rows of each row group; of a part of one, its rows."""
    whole: bool = True

    @property
    def rows(self) -> int:
        """Number of rows."""
        return sum(self.sizes)


def pieces_of(footer: f.Footer, most: int) -> list[Piece]:
    """Divide a file into pieces of so many rows at most."""
    pieces: list[Piece] = []
    groups: list[int] = []
    sizes: list[int] = []
    for place, group in enumerate(footer.row_groups):
        rows = group[f.GROUP_ROWS][1]
        if groups and sum(sizes) + rows > most:
            pieces.append(Piece(tuple(groups), tuple(sizes)))
            groups, sizes = [], []
        if rows > most:
            parts = [min(most, rows - begin) for begin in range(0, rows, most)]
            pieces += [Piece((place,), (part,), whole=False) for part in parts]
            continue
        groups.append(place)
        sizes.append(rows)
    if groups:
        pieces.append(Piece(tuple(groups), tuple(sizes)))
    return pieces


def names_of(file: Any) -> list[str]:
    """Names of the columns, as echocal reads them: an index of times that has no name is ``time``."""
    pa = arrow()
    schema = file.schema_arrow
    names = [name.strip() for name in schema.names]
    if _INDEX in names and "time" not in names and pa.types.is_timestamp(schema.field(_INDEX).type):
        names[names.index(_INDEX)] = "time"
    return names


def read_pieces(
    path: Path, file: Any, pieces: Sequence[Piece], columns: Sequence[str]
) -> Iterator[pd.DataFrame]:
    """Read some columns of each piece. Raises `DataError` if the file is damaged."""
    stored = dict(zip(names_of(file), file.schema_arrow.names, strict=True))
    wanted = [stored[name] for name in columns]
    for piece, table in zip(pieces, read_tables(path, file, pieces, wanted), strict=True):
        if not columns:
            yield pd.DataFrame(index=range(piece.rows))
            continue
        table = table.select(wanted).rename_columns(list(columns)).replace_schema_metadata(None)
        yield to_pandas(table)


def read_tables(
    path: Path, file: Any, pieces: Sequence[Piece], columns: Sequence[str] | None
) -> Iterator[Any]:
    """Read some columns of each piece, or all, as Arrow has them.

    Raises `DataError` if the file is damaged.
    """
    pa = arrow()
    wanted = None if columns is None else list(columns)
    parts: Iterator[Any] = iter(())
    try:
        for piece, before in zip(pieces, [None, *pieces], strict=False):
            if piece.whole:
                table = file.read_row_groups(list(piece.groups), columns=wanted)
            else:
                if before is None or before.whole or before.groups != piece.groups:
                    parts = file.iter_batches(
                        batch_size=piece.rows, row_groups=list(piece.groups), columns=wanted
                    )
                table = _next(parts, piece.rows, pa)
            yield table
    except (OSError, pa.ArrowException) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        message = f"{path} begins like Parquet and cannot be read: {reason}"
        raise DataError(message) from None


def _next(parts: Iterator[Any], rows: int, pa: Any) -> Any:
    """So many rows of batches."""
    batches: list[Any] = []
    while sum(len(batch) for batch in batches) < rows:
        batches.append(next(parts))
    if sum(len(batch) for batch in batches) != rows:
        raise pa.ArrowInvalid("batches of another size than was asked for")
    return pa.Table.from_batches(batches)


@dataclass(frozen=True)
class Opened:
    """A Parquet file that is open for reading."""

    path: Path
    file: Any
    footer: f.Footer
    pieces: list[Piece]


def correct_parquet(
    source: Path,
    out: Path,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a Parquet file into a new one.

    Raises `DataError` if the file cannot be read, or a model needs what it does not have; `out` is incomplete
    then.

    Parameters
    ----------
    key : str or None
        Key of all rows; None: each row has its own.
    log : sequence of Path
        Files of the log that the file belongs to, in the order of time.
    progress : callable
        Told the rows of each row group that is done.
    """
    pa = arrow()
    with source.open("rb") as raw:
        footer = f.read_footer(raw, str(source), job.memory - FIXED)
        opened = opened_file(source, footer, job)
        with opened.file:
            corrector = Corrector(names_of(opened.file), job, key)
            if corrector.by:
                corrector.prepare(keys_of(opened, corrector.by))
            around = surroundings_of(opened, corrector, job, log)
            tally = tally_of(opened)
            codec = _codec(footer)

            def encoded(rows: Rows, place: int) -> list[Encoded]:
                piece = opened.pieces[place]
                return encode(rows, piece.sizes, codec, whole=piece.whole)

            tables = read_pieces(source, opened.file, opened.pieces, corrector.columns)
            made = corrected(tables, corrector, tally, encoded, **around, threads=job.threads)
            with opened_output(out) as target:
                splice = Splice(raw, footer, target, _kept(footer, job, corrector), job.reading.first)
                groups = footer.row_groups
                for place, results in enumerate(_groups(made, opened.pieces, footer)):
                    splice.add(groups[place], results)
                    progress(results.rows)
                metadata = {name.encode(): text.encode() for name, text in job.metadata.items()}
                splice.finish(metadata)
            _check_written(out, footer, source)
            if tally.doubtful(job):
                check_whole(opened, corrector)
    pa.default_memory_pool().release_unused()
    return tally


def _check_written(out: Path, footer: f.Footer, source: Path) -> None:
    """Open the output once: what a damaged footer holds may be more than this package knows."""
    pa = arrow()
    try:
        rows = pa.parquet.read_metadata(_name(out)).num_rows
    except (OSError, pa.ArrowException) as error:
        rows = next(iter(str(error).split("\n")), type(error).__name__)
    if rows != footer.rows:
        message = f"{source} is damaged: its footer cannot be written again ({rows})"
        raise DataError(message)


def opened_file(path: Path, footer: f.Footer, job: Job, width: int = 1) -> Opened:
    """Open a file; its pieces are small enough for the memory, where a row takes `width` times as much."""
    pa = arrow()
    least, largest = _PIECE
    most = (job.memory - FIXED) // (_BYTES_A_ROW * width * (job.threads + 2))
    try:
        file = arrow_file(path)
    except (OSError, pa.ArrowException) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        message = f"{path} begins like Parquet and cannot be read: {reason}"
        raise DataError(message) from None
    return Opened(path, file, footer, pieces_of(footer, min(max(most, least), largest)))


def arrow_file(path: Path) -> Any:
    """Open a file so that no whole column of a row group is held; checksums of pages are compared."""
    return arrow().parquet.ParquetFile(
        _name(path), buffer_size=1 << 20, pre_buffer=False, page_checksum_verification=True
    )


def _name(path: Path) -> Any:
    """The name of a file as Arrow takes it; the open file where the name is no text."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return path.open("rb")
    return str(path)


def tally_of(opened: Opened) -> Tally:
    """A tally of no rows yet, with the columns of a file."""
    types = [str(own.type) for own in opened.file.schema_arrow]
    return Tally(columns=names_of(opened.file), types=types)


def keys_of(opened: Opened, by: str) -> list[str]:
    """All keys of a file."""
    keys: dict[str, None] = {}
    for table in read_pieces(opened.path, opened.file, opened.pieces, [by]):
        keys |= dict.fromkeys(label(value) for value in table[by].unique().tolist())
    return list(keys)


def surroundings_of(opened: Opened, corrector: Corrector, job: Job, log: Sequence[Path]) -> dict[str, Any]:
    """What the rows depend on, besides themselves."""
    if not corrector.remembers and (len(log) < 2 or not corrector.rows_around):
        return {"context": Context()}
    files = list(log) or [opened.path]

    def read(path: Path) -> pd.DataFrame:
        with path.open("rb") as raw:
            footer = f.read_footer(raw, str(path), job.memory - FIXED)
        other = opened_file(path, footer, job)
        with other.file:
            tables = list(read_pieces(path, other.file, other.pieces, corrector.columns))
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=corrector.columns)

    found = surroundings(files, files.index(opened.path), corrector, read, job.memory)
    return {"context": found.context, "before": found.before, "after": found.after}


def check_whole(opened: Opened, corrector: Corrector) -> None:
    """Refuse a file whose columns, taken as a whole, have no value or are in another unit."""
    tables = list(read_pieces(opened.path, opened.file, opened.pieces, corrector.columns))
    whole = pd.concat(tables, ignore_index=True)
    corrector.correct(whole, Context(), (0, len(whole)), whole=True)


def _codec(footer: f.Footer) -> str:
    """Compression of the first column, as pyarrow names it for writing."""
    names = ("UNCOMPRESSED", "SNAPPY", "GZIP", "LZO", "BROTLI", "LZ4", "ZSTD", "LZ4_RAW")
    for group in footer.row_groups[:1]:
        for chunk in group[f.COLUMNS][1][1][:1]:
            name = names[chunk[f.META][1][f.CODEC][1]]
            return "SNAPPY" if name == "LZO" else _CODECS.get(name, name)
    return "SNAPPY"


def _kept(footer: f.Footer, job: Job, corrector: Corrector) -> list[f.Field]:
    """Columns to copy."""
    fields = f.fields_of(footer)
    if job.append_only is None:
        return fields
    names = [field.name.strip() for field in fields]
    absent = [name for name in job.append_only if name not in names]
    if absent:
        message = f"{keyword('append_only')}: there is no column '{absent[0]}'{among(absent[0], names)}"
        raise UsageError(message)
    return [field for field, name in zip(fields, names, strict=True) if name in job.append_only]


def _groups(made: Iterator[list[Encoded]], pieces: Sequence[Piece], footer: f.Footer) -> Iterator[Encoded]:
    """Results of each row group, joined where it came in several pieces."""
    part: Encoded | None = None
    for piece, results in zip(pieces, made, strict=True):
        if piece.whole:
            yield from results
            continue
        (one,) = results
        part = one if part is None else part + one
        if part.rows == footer.row_groups[piece.groups[0]][f.GROUP_ROWS][1]:
            yield part
            part = None
