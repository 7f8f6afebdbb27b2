"""Checksums of pages (CRC-32), for readers that do not compare them."""

from functools import lru_cache
from pathlib import Path

from echocal.correct.parquet import footer as f
from echocal.correct.parquet import thrift
from echocal.errors import DataError
from echocal.observations.arrow import arrow
from echocal.places import stamp

__all__ = ["compare_checksums"]

_HEADER = 1 << 20  # bytes that hold the header of a page
_CRC = 4  # of PageHeader
_ROWS = 1 << 16


def compare_checksums(path: Path) -> None:
    """Compare all checksums of a Parquet file; once for the file as it is now.

    Raises
    ------
    DataError
        If a page is damaged.
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
        message = f"{path} is damaged: {reason}"
        raise DataError(message) from None


def _has_checksums(path: Path) -> bool:
    """Whether its first page has one: a writer gives one to each page, or to none."""
    with path.open("rb") as raw:
        footer = f.read_footer(raw, str(path))
        for group in footer.row_groups:
            for chunk in group[f.COLUMNS][1][1]:
                first, count = f.chunk_range(chunk)
                raw.seek(first)
                try:
                    return _CRC in thrift.read(raw.read(min(count, _HEADER)))[0]
                except ValueError:  # the reader tells
                    return False
    return False
