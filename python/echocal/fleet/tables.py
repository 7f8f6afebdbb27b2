"""One file as a polars table: Parquet lazily, text as echocal reads it; its keys of sensors as text."""

from collections.abc import Sequence
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

from echocal._interrupt import stop_if_told
from echocal.correct.parquet import footer as f
from echocal.correct.parquet import thrift
from echocal.errors import DataError, EchocalError, UsageError, unexpected
from echocal.model.folder import WHOLE
from echocal.observations.arrow import arrow
from echocal.observations.file import TextFile
from echocal.observations.layout import Layout
from echocal.observations.source import load
from echocal.places import stamp

_HEADER = 1 << 20  # bytes that hold the header of a page
_CRC = 4  # of PageHeader
_ROWS = 1 << 16

Frame: TypeAlias = Any
"""A ``polars.DataFrame``; the library may be absent."""


def polars() -> Any:
    """The library. Raises `UsageError` if it is not installed."""
    try:
        return import_module("polars")
    except ImportError:
        raise UsageError("a fleet is read with polars: pip install 'echocal[batch]'") from None


class Opened:
    """A file whose columns are known, with their types in polars, and can be read."""

    def __init__(self, path: Path, lazy: Any, schema: Any) -> None:
        self.path, self._lazy, self.schema = path, lazy, schema

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self.read([polars().len()]).item())

    def read(
        self, columns: Sequence[Any], where: Any = None, rows: tuple[int, int | None] = (0, None)
    ) -> Frame:
        """Read expressions of columns, of the rows for which an expression holds.

        Raises `DataError` if the file cannot be read. `rows` is the first of the rows that are looked at,
        and their number.
        """
        lazy = self._lazy if rows == (0, None) else self._lazy.slice(*rows)
        lazy = lazy if where is None else lazy.filter(where)
        return _tried(self.path, lambda: lazy.select(columns).collect())


def opened(path: Path, layout: Layout, *, compare: bool = True) -> Opened:
    """Open a file.

    Raises `DataError` if it cannot be read. `compare`: the checksums of its pages are compared, where it has
    them; polars does not.
    """
    pl = polars()
    file = TextFile(path, layout)
    if file.is_parquet:
        # hive levels are read from the path by the caller; here a column is a column of the file
        lazy = _tried(path, lambda: pl.scan_parquet(str(path), hive_partitioning=False, glob=False))
        schema = _tried(path, lazy.collect_schema)
        if compare:
            _tried(path, lambda: compare_checksums(path))
        return Opened(path, lazy, schema)
    whole = _tried(path, lambda: load(file))
    frame = _tried(path, lambda: pl.from_pandas(whole))
    return Opened(path, frame.lazy(), frame.schema)


def _tried(path: Path, work: Any) -> Any:
    pl = polars()
    try:
        return work()
    except EchocalError:
        raise
    except (OSError, OverflowError, TypeError, ValueError, pl.exceptions.PolarsError) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise DataError(f"{path} cannot be read: {reason}") from None
    except BaseException as error:  # of one file: the others go on
        stop_if_told()
        raise DataError(f"{path}: {unexpected(error)}") from None


def label(name: str, kind: Any) -> Any:
    """Expression of a column's values as text: whole numbers have no fraction, empty texts are null."""
    pl = polars()
    column = pl.col(name)
    if kind.is_float():
        whole = (column == column.floor()) & (column.abs() < 2.0**53)
        number = pl.when(whole).then(column.cast(pl.Int64, strict=False).cast(pl.String))
        text = number.otherwise(column.cast(pl.String))
        return pl.when(column.is_nan()).then(None).otherwise(text)
    text = column.cast(pl.String).str.strip_chars().str.replace(WHOLE, "$1")
    return pl.when(text == "").then(None).otherwise(text)


def compare_checksums(path: Path) -> None:
    """Compare all checksums of a Parquet file; once for the file as it is now.

    Raises `DataError` if a page is damaged.
    """
    _compare(path, tuple(stamp(path).items()))


@lru_cache(maxsize=1024)
def _compare(path: Path, _: tuple[tuple[str, object], ...]) -> None:
    if not _has_checksums(path):
        return
    pa = arrow()
    try:
        with path.open("rb") as raw, pa.parquet.ParquetFile(raw, page_checksum_verification=True) as file:
            for _batch in file.iter_batches(_ROWS):
                pass
    except (OSError, pa.ArrowException) as error:
        reason = next(iter(str(error).split("\n")), type(error).__name__)
        raise DataError(f"{path} is damaged: {reason}") from None


def _has_checksums(path: Path) -> bool:
    """Whether its first page has one: a writer gives one to each page, or to none."""
    with path.open("rb") as raw:
        footer = f.read_footer(raw, str(path))
        for group in footer.row_groups:
            for chunk in group[f.COLUMNS][1][1]:
                first, count = f.chunk_range(chunk)
                raw.seek(first)
                try:
                    return _CRC in thrift.read(raw.read(min(count, _HEADER)))
                except ValueError:  # the reader tells
                    return False
    return False
