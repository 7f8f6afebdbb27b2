"""From text to Parquet: once through the file for the types of its columns, once more for the rows."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from echocal.correct.corrector import Tally
from echocal.correct.job import Job
from echocal.correct.kinds import KINDS, kind_of, possible, type_of, typed
from echocal.correct.parquet.encode import columns_of, result_fields
from echocal.correct.results import STATUS, UNCERTAINTY, UNUSABLE
from echocal.correct.rows import Rows
from echocal.correct.stream import in_order
from echocal.correct.text.blocks import Block
from echocal.correct.text.file import Text, check_whole, correct_blocks
from echocal.correct.text.parse import Lines
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.arrow import Table, arrow
from echocal.observations.file import TextFile
from echocal.outputs import opened_output

__all__ = ["text_to_parquet"]

_VALUES = 1 << 20
"""Values of a row group: a number of rows that depends on the columns only, not on the memory."""

_ROWS = (1 << 12, 1 << 17)
"""Least and largest number of rows of a row group."""

_SHARE = 4
"""Times that a block takes the memory of one whose lines are only copied; measured."""


def text_to_parquet(
    source: TextFile,
    out: Path,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a text file into a Parquet file; see `correct_text`.

    The types of the columns are those that lose no digit; see `echocal.correct.kinds`.

    Raises
    ------
    DataError
        If the file cannot be read, or a model needs what it does not have; `out` is incomplete then.
    """
    if job.append_only is not None:
        raise UsageError(f"{keyword('append_only')} is for Parquet to Parquet")
    pa = arrow()
    text = Text(source, job, key)
    job = text.job
    text.size //= _SHARE
    tally = Tally(columns=list(text.head.names))
    kinds = _kinds(text)
    schema = pa.schema(
        [*(pa.field(name, type_of(kind)) for name, kind in kinds.items()), *result_fields(job.reading.first)],
        {name.encode(): own.encode() for name, own in job.metadata.items()},
    )

    def made(block: Block, lines: Lines, rows: Rows) -> Table:
        fields = text.parser.fields(block, lines)
        columns = {name: typed(fields[name], kind, text.head.decimal) for name, kind in kinds.items()}
        return pa.table({**columns, **columns_of(rows)}, schema=_loose(schema))

    numbers = (job.reading.first, UNCERTAINTY)
    options = {
        "compression": "SNAPPY",
        "use_dictionary": [name for name in schema.names if name not in numbers],
        "column_encoding": dict.fromkeys(numbers, "BYTE_STREAM_SPLIT"),
    }
    with opened_output(out) as file, pa.parquet.ParquetWriter(file, schema, **options) as writer:
        size = min(max(_VALUES // len(schema), _ROWS[0]), _ROWS[1])
        for group in _groups(correct_blocks(text, tally, log, made), size):
            writer.write_table(_as_one(group, schema), row_group_size=size)
            progress(len(group))
    if not tally.rows:
        names = ", ".join(tally.columns)
        message = f"{source.path} has a header ({names}) and no rows, so its columns have no types"
        raise DataError(message)
    check_whole(text, tally)
    pa.default_memory_pool().release_unused()
    return tally


def _kinds(text: Text) -> Mapping[str, str]:
    """Type of each column; without those that only separators at the end of lines make."""
    left = {name: frozenset(KINDS) for name in text.head.names}
    filled: dict[str, bool] = dict.fromkeys(left, False)
    decimal = text.head.decimal

    def work(block: Block) -> dict[str, frozenset[str] | None]:
        fields = text.parser.fields(block, text.checked(block))
        return {name: _of_all(fields[name], decimal, left[name]) for name in left}

    for found in in_order(text.blocks(), work, text.job.threads):
        for name, own in found.items():
            if own is not None:
                filled[name] = True
                left[name] &= own
    return {
        name: kind_of(left[name] if filled[name] else None)
        for name in left
        if filled[name] or not name.startswith("Unnamed")
    }


def _of_all(column: Any, decimal: str, among: frozenset[str]) -> frozenset[str] | None:
    """Types that the chunks of a column may have."""
    said = [own for chunk in column.chunks if (own := possible(chunk, decimal, among)) is not None]
    return frozenset.intersection(*said) if said else None


def _loose(schema: Any) -> Any:
    """The same schema with reasons as texts, not as places in a dictionary that each piece has for itself."""
    pa = arrow()
    for name in (STATUS, UNUSABLE):
        place = schema.get_field_index(name)
        if pa.types.is_dictionary(schema.field(place).type):
            schema = schema.set(place, pa.field(name, pa.string()))
    return schema


def _groups(tables: Iterator[Table], size: int) -> Iterator[Table]:
    """The same rows in tables of so many rows each; the last has fewer."""
    pa = arrow()
    held: list[Table] = []
    count = 0
    for table in tables:
        held.append(table)
        count += len(table)
        while count >= size:
            whole = pa.concat_tables(held)
            yield whole.slice(0, size)
            held, count = [whole.slice(size)], count - size
    if count:
        yield pa.concat_tables(held)


def _as_one(group: Table, schema: Any) -> Table:
    """A row group in pieces that do not depend on those that were corrected together."""
    pa = arrow()
    columns = []
    for field, column in zip(schema, group.columns, strict=True):
        one = column.combine_chunks()
        if pa.types.is_dictionary(field.type):
            one = one.dictionary_encode().cast(field.type)
        columns.append(one)
    return pa.table(columns, schema=schema)
