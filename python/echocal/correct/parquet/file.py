"""Correct one Parquet file: its columns are copied byte by byte, and the results are appended."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import pandas as pd

from echocal.correct.columns import with_time
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

_CODECS = {"UNCOMPRESSED": "NONE", "LZ4_RAW": "LZ4"}
"""Names for writing, where files call them differently."""

Made = TypeVar("Made")

FIXED = 220 << 20
"""Bytes that Python and the libraries take before the first row; measured."""

_BYTES_A_ROW = 500
"""Bytes that a row takes while it is corrected, by each thread; measured."""

_PIECE = (4096, 1 << 18)
"""Least and largest number of rows that are corrected together."""


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


class Parquet:
    """A Parquet file that is corrected, in pieces that are small enough for the memory.

    Raises `DataError` if it is damaged. With `whole`, all columns of a piece are held at a time.
    """

    def __init__(self, path: Path, job: Job, *, whole: bool = False) -> None:
        self.path, self.job = path, job
        arrow()  # a missing library is told before a damaged file
        with path.open("rb") as raw:
            self.footer = f.read_footer(raw, str(path), job.memory - FIXED)
        with _readable(path):
            self.file = arrow_file(path)
        width = 1 + len(f.fields_of(self.footer)) // 4 if whole else 1
        least, largest = _PIECE
        most = (job.memory - FIXED) // (_BYTES_A_ROW * width * (job.threads + 2))
        self.pieces = pieces_of(self.footer, min(max(most, least), largest))
        schema = self.file.schema_arrow
        self.names = with_time([name.strip() for name in schema.names], schema)

    def read(self, columns: Sequence[str]) -> Iterator[pd.DataFrame]:
        """Some columns of each piece."""
        stored = dict(zip(self.names, self.file.schema_arrow.names, strict=True))
        wanted = [stored[name] for name in columns]
        for piece, table in zip(self.pieces, self.tables(self.file, wanted), strict=True):
            if not columns:
                yield pd.DataFrame(index=range(piece.rows))
                continue
            table = table.select(wanted).rename_columns(list(columns)).replace_schema_metadata(None)
            yield to_pandas(table)

    def tables(self, file: Any, columns: list[str] | None) -> Iterator[Any]:
        """Some columns of each piece, or all, as Arrow has them; `file` is this one, open for reading."""
        parts: Iterator[Any] = iter(())
        with _readable(self.path):
            for piece, before in zip(self.pieces, [None, *self.pieces], strict=False):
                groups = list(piece.groups)
                if piece.whole:
                    table = file.read_row_groups(groups, columns=columns)
                else:
                    if before is None or before.whole or before.groups != piece.groups:
                        parts = file.iter_batches(piece.rows, row_groups=groups, columns=columns)
                    table = _next(parts, piece.rows)
                yield table

    @contextmanager
    def corrected(
        self, key: str | None, log: Sequence[Path], then: Callable[[Rows, int], Made]
    ) -> Iterator[tuple[Tally, Iterator[Made]]]:
        """Give the counts, and what is made of each piece; the file is closed at the end.

        Raises `DataError` at the end if a column, taken as a whole, has no value or is in another unit.
        """
        with self.file as file:
            corrector = Corrector(self.names, self.job, key)
            if corrector.by:
                keys: dict[str, None] = {}
                for table in self.read([corrector.by]):
                    keys |= dict.fromkeys(label(value) for value in table[corrector.by].unique().tolist())
                corrector.prepare(keys)

            def read(path: Path) -> Iterator[pd.DataFrame]:
                other = Parquet(path, self.job)
                with other.file:
                    yield from other.read(corrector.columns)

            around = surroundings(self.path, log, corrector, read, self.job.memory)
            tally = Tally(columns=self.names, types=[str(own.type) for own in file.schema_arrow])
            tables = self.read(corrector.columns)
            yield tally, corrected(tables, corrector, tally, then, **around, threads=self.job.threads)
            if tally.doubtful(self.job):
                whole = pd.concat(list(self.read(corrector.columns)), ignore_index=True)
                corrector.correct(whole, Context(), (0, len(whole)), whole=True)
        arrow().default_memory_pool().release_unused()


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, arrow().ArrowException) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise DataError(f"{path} begins like Parquet and cannot be read: {reason}") from None


def _next(parts: Iterator[Any], rows: int) -> Any:
    """So many rows of batches."""
    pa = arrow()
    batches: list[Any] = []
    while sum(len(batch) for batch in batches) < rows:
        batches.append(next(parts))
    if sum(len(batch) for batch in batches) != rows:
        raise pa.ArrowInvalid("batches of another size than was asked for")
    return pa.Table.from_batches(batches)


def correct_parquet(
    source: Path,
    out: Path,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a Parquet file into a new one.

    Raises `DataError` if the file cannot be read, or a model needs what it does not have; `out` is
    incomplete then. `key` is that of all rows; None: each row has its own. `log` has the files of the log
    that the file belongs to, and `progress` is told the rows of each row group that is done.
    """
    read = Parquet(source, job)
    footer, codec = read.footer, _codec(read.footer)

    def encoded(rows: Rows, place: int) -> list[Encoded]:
        piece = read.pieces[place]
        return encode(rows, piece.sizes, codec, whole=piece.whole)

    with source.open("rb") as raw, read.corrected(key, log, encoded) as (tally, made):
        with opened_output(out) as target:
            splice = Splice(raw, footer, target, _kept(footer, job), job.reading.first)
            groups = footer.row_groups
            for place, results in enumerate(_groups(made, read.pieces, footer)):
                splice.add(groups[place], results)
                progress(results.rows)
            splice.finish({name.encode(): text.encode() for name, text in job.metadata.items()})
        _check_written(out, footer, source)
    return tally


def _check_written(out: Path, footer: f.Footer, source: Path) -> None:
    """Open the output once: what a damaged footer holds may be more than this package knows."""
    pa = arrow()
    try:
        rows = pa.parquet.read_metadata(_name(out)).num_rows
    except (OSError, pa.ArrowException) as error:
        rows = next(iter(str(error).split("\n")), type(error).__name__)
    if rows != footer.rows:
        raise DataError(f"{source} is damaged: its footer cannot be written again ({rows})")


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


def _codec(footer: f.Footer) -> str:
    """Compression of the first column, as pyarrow names it for writing."""
    names = ("UNCOMPRESSED", "SNAPPY", "GZIP", "LZO", "BROTLI", "LZ4", "ZSTD", "LZ4_RAW")
    for group in footer.row_groups[:1]:
        for chunk in group[f.COLUMNS][1][1][:1]:
            name = names[chunk[f.META][1][f.CODEC][1]]
            return "SNAPPY" if name == "LZO" else _CODECS.get(name, name)
    return "SNAPPY"


def _kept(footer: f.Footer, job: Job) -> list[f.Field]:
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
