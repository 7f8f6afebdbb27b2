"""The rows of a Parquet file, piece by piece: only the columns that are needed, in constant memory."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from echocal.correct.parquet import footer as f
from echocal.errors import DataError
from echocal.observations.arrow import arrow, to_pandas

__all__ = ["Piece", "names_of", "pieces_of", "read_pieces", "read_tables"]

_INDEX = "__index_level_0__"
_BUFFER = 1 << 20  # bytes of a column that are read at a time


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
    """Read some columns of each piece.

    Raises
    ------
    DataError
        If the file is damaged.
    """
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

    Raises
    ------
    DataError
        If the file is damaged.
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
