"""One file as a polars table: Parquet lazily, text as echocal reads it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from echocal._interrupt import stop_if_told
from echocal.correct.parquet.checksums import compare_checksums
from echocal.errors import DataError, EchocalError, unexpected
from echocal.fleet.polar import Frame, polars
from echocal.observations.file import TextFile
from echocal.observations.layout import Layout
from echocal.observations.source import load

__all__ = ["Opened", "opened"]


class Opened:
    """A file whose columns are known, and can be read.

    Attributes
    ----------
    path : Path
    schema : mapping of str to polars.DataType
    """

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

        Parameters
        ----------
        columns : sequence of polars.Expr
        where : polars.Expr, optional
        rows : (int, int or None)
            First of the rows that are looked at, and their number.

        Raises
        ------
        DataError
            If the file cannot be read.
        """
        lazy = self._lazy if rows == (0, None) else self._lazy.slice(*rows)
        lazy = lazy if where is None else lazy.filter(where)
        return _tried(self.path, lambda: lazy.select(columns).collect())


def opened(path: Path, layout: Layout, *, compare: bool = True) -> Opened:
    """Open a file.

    Parameters
    ----------
    compare : bool
        Whether the checksums of its pages are compared, where it has them: polars does not.

    Raises
    ------
    DataError
        If it cannot be read.
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
        message = f"{path} cannot be read: {reason}"
        raise DataError(message) from None
    except BaseException as error:  # of one file: the others go on
        stop_if_told()
        message = f"{path}: {unexpected(error)}"
        raise DataError(message) from None
