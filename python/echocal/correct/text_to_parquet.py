"""From text to Parquet: once through the file for the types of its columns, once more for the rows.

A type must hold for the whole column. So it is found piece by piece first: the types that are possible in
every piece are possible in the column.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from echocal.correct.corrector import Tally
from echocal.correct.job import Job
from echocal.correct.parquet.splice import columns_of, result_fields
from echocal.correct.results import STATUS, UNCERTAINTY, UNUSABLE
from echocal.correct.rows import Rows
from echocal.correct.stream import in_order
from echocal.correct.text.file import Text, check_whole, correct_blocks
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.arrow import Table, arrow
from echocal.observations.file import TextFile
from echocal.observations.numbers import EMPTY, EXACT
from echocal.observations.scanner import Block
from echocal.outputs import opened_output

_VALUES = 1 << 20
"""Values of a row group: a number of rows that depends on the columns only, not on the memory."""

_ROWS = (1 << 12, 1 << 17)
"""Least and largest number of rows of a row group."""

_SHARE = 4
"""Times that a block takes the memory of one whose lines are only copied; measured."""
KINDS = ("truth", "integer", "positive", "float")
"""Types that a column of text may have; the first that is possible is taken."""

_WHOLE = r"^(0|-?[1-9][0-9]*)$"  # "007" is a name, and stays one
_INTEGER = r"^[-+]?[0-9]+$"
_PADDED = r"^[-+]?0[0-9]+$"
_NUMBER = r"^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$"
_TRUTHS = ("True", "False", "TRUE", "FALSE", "true", "false")


def text_to_parquet(
    source: TextFile,
    out: Path,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a text file into a Parquet file; see `correct_text`.

    The types of the columns are those that lose no digit; see `echocal.correct.text_to_parquet`. Raises
    `DataError` if the file cannot be read, or a model needs what it does not have; `out` is incomplete then.
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

    def made(block: Block, rows: Rows) -> Table:
        fields = text.parser.fields(block)
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
        raise DataError(f"{source.path} has a header ({names}) and no rows, so its columns have no types")
    check_whole(text, tally)
    pa.default_memory_pool().release_unused()
    return tally


def _kinds(text: Text) -> Mapping[str, str]:
    """Type of each column; without those that only separators at the end of lines make."""
    left = {name: frozenset(KINDS) for name in text.head.names}
    filled: dict[str, bool] = dict.fromkeys(left, False)
    decimal = text.head.decimal

    def work(block: Block) -> dict[str, frozenset[str] | None]:
        fields = text.parser.fields(text.checked(block))
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


def possible(column: Any, decimal: str, among: Collection[str]) -> frozenset[str] | None:
    """Types that a piece of a column may have; None where it is empty, and says nothing.

    `among` are the types that are possible in other pieces.
    """
    texts = _filled(column)
    if texts.null_count == len(texts):
        return None
    tests = {"truth": _are_truths, "integer": _are_whole, "positive": _are_positive}
    found = {kind for kind, holds in tests.items() if kind in among and holds(texts)}
    if "float" in among and _floats(texts, decimal) is not None:
        found.add("float")
    return frozenset(found)


def kind_of(found: Collection[str] | None) -> str:
    """The type of a column, of those that are possible; ``"text"`` where it is empty or none is."""
    return next((kind for kind in KINDS if found is not None and kind in found), "text")


def typed(column: Any, kind: str, decimal: str) -> Any:
    """A piece of a column in its type."""
    pa = arrow()
    pc = pa.compute
    if kind == "text":
        return pc.if_else(pc.equal(column, ""), pa.scalar(None, column.type), column).cast(type_of(kind))
    texts = _filled(column)
    if kind == "truth":
        return pc.equal(pc.utf8_lower(texts), "true")
    if kind == "float":
        texts = pc.replace_substring(texts, decimal, ".")
    return texts.cast(type_of(kind))


def type_of(kind: str) -> Any:
    """Type in Arrow."""
    pa = arrow()
    return {
        "truth": pa.bool_(),
        "integer": pa.int64(),
        "positive": pa.uint64(),
        "float": pa.float64(),
        "text": pa.large_string(),
    }[kind]


def _filled(column: Any) -> Any:
    """Null where a text says that there is no value."""
    pa = arrow()
    absent = pa.compute.is_in(column, pa.array(sorted(EMPTY), column.type))
    return pa.compute.if_else(absent, pa.scalar(None, column.type), column)


def _are_truths(texts: Any) -> bool:
    pa = arrow()
    return bool(pa.compute.all(pa.compute.is_in(texts.drop_null(), pa.array(_TRUTHS, texts.type))).as_py())


def _are_whole(texts: Any) -> bool:
    return _fit(texts, arrow().int64())


def _are_positive(texts: Any) -> bool:
    return _fit(texts, arrow().uint64())


def _fit(texts: Any, kind: Any) -> bool:
    pa = arrow()
    if not pa.compute.all(pa.compute.match_substring_regex(texts, _WHOLE)).as_py():
        return False
    try:
        texts.cast(kind)
    except pa.ArrowInvalid:  # wider than that
        return False
    return True


def _floats(texts: Any, decimal: str) -> Any | None:
    """Floats of texts that are all numbers of a float's range, and whose integers lose no digit."""
    pa = arrow()
    pc = pa.compute
    filled = texts.drop_null()
    if decimal != "." and pc.any(pc.match_substring(filled, ".")).as_py():
        return None  # a separator of thousands, a date
    plain = pc.replace_substring(texts, decimal, ".")
    if not pc.all(pc.match_substring_regex(plain, _NUMBER)).as_py():
        return None
    if pc.any(pc.match_substring_regex(filled, _PADDED)).as_py():
        return None
    numbers = plain.cast(pa.float64())
    long = pc.and_(pc.match_substring_regex(texts, _INTEGER), pc.greater_equal(pc.abs(numbers), EXACT))
    integers = pc.filter(texts, long, null_selection_behavior="drop").to_pylist()
    exact = pc.all(pc.is_finite(numbers)).as_py() and all(int(text) == float(text) for text in integers)
    return numbers if exact else None
