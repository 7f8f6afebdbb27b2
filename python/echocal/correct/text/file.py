"""Correct one text file: its lines stay letter for letter, and each is read once."""

import gzip
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import IO, Any, TypeVar

import pandas as pd

from echocal.correct.corrector import Context, Corrector, Tally
from echocal.correct.job import Job
from echocal.correct.logs import surroundings
from echocal.correct.results import RESULTS, results
from echocal.correct.rows import Rows
from echocal.correct.stream import corrected, in_order
from echocal.correct.text.parse import Parser
from echocal.errors import DataError, UsageError
from echocal.keywords import command_line, keyword
from echocal.model.folder import label
from echocal.observations.file import TextFile
from echocal.observations.found import CORRUPT, Found
from echocal.observations.heading import fields_of
from echocal.observations.hints import completed
from echocal.observations.part import Part
from echocal.observations.plan import make
from echocal.observations.scanner import Block
from echocal.observations.source import refuse_unstreamed
from echocal.observations.text import blocks_of
from echocal.outputs import opened_output

Made = TypeVar("Made")

_BLOCK = (1 << 18, 1 << 23)
"""Least and largest number of bytes that are corrected together."""

_FIXED = 230 << 20
"""Bytes that Python and the libraries take before the first row; measured."""

_TIMES = 12
"""Bytes of memory for each byte of a block, by each thread; measured."""


class Text:
    """A text file that is corrected."""

    def __init__(self, file: TextFile, job: Job, key: str | None) -> None:
        refuse_unstreamed(file)
        path, self.head = file.path, file.head
        layout = replace(file.layout, decimal=self.head.decimal)
        names = self.head.names
        requests = completed(names, job.reading.requests_of(names), Found(units=self.head.units))[0]
        pinned: dict[str, Any] = {"columns": requests, "mount_height": None}  # each level has its height
        job = replace(job, reading=replace(job.reading, **pinned, **layout.plain()))
        self.file, self.path, self.job = file, path, job
        try:
            self.corrector = Corrector(names, job, key)
        except DataError as error:
            if not str(error).startswith("no column holds an echo"):
                raise
            raise DataError(
                f"{error}. If echocal diagnose reads the log, it has another shape; a table of it: "
                + command_line("inspect", path, write="table.csv")
            ) from None
        self.parser = Parser(self.head, _kinds(names, job), _absent(job))
        least, largest = _BLOCK
        size = (job.memory - _FIXED) // (_TIMES * (job.threads + 2))
        self.size = min(max(size, least), largest)
        self._lock = threading.Lock()

    def blocks(self) -> Iterator[Block]:
        """Blocks of rows."""
        return blocks_of(self.file, self.size)

    def checked(self, block: Block) -> Block:
        """The block, if it is text."""
        if not block.is_text:
            raise self.file.no_text()
        return block

    def parsed(self, block: Block) -> pd.DataFrame:
        """The columns that the models of its rows read."""
        self.checked(block)
        corrector = self.corrector
        columns = corrector.columns
        if corrector.by:
            keys = self.parser.table(block, [corrector.by])[corrector.by]
            with self._lock:
                corrector.prepare([label(value) for value in keys.unique().tolist()])
                columns = corrector.columns
        return self.parser.table(block, columns)

    def tables(self) -> Iterator[pd.DataFrame]:
        """Needed columns of all rows, block by block."""
        return map(self.parsed, self.blocks())

    def tables_of(self, path: Path) -> Iterator[pd.DataFrame]:
        """The same of a file of the same log."""
        file = self.file if path == self.path else TextFile(path, self.job.reading.layout)
        return Text(file, self.job, self.corrector.key).tables()


def correct_text(
    source: TextFile,
    out: Path,
    job: Job,
    key: str | None,
    log: Sequence[Path],
    progress: Callable[[int], None],
    *,
    zipped: bool,
) -> Tally:
    """Correct a text file into a new one.

    Raises `DataError` if the file cannot be read, or a model needs what it does not have; `out` is
    incomplete then. `key` is that of all rows; None: each row has its own. `log` has the files of the log
    that the file belongs to, and `progress` is told the rows of each block that is done.
    """
    text = Text(source, job, key)
    job = text.job
    if job.append_only is not None:
        raise UsageError(f"{keyword('append_only')} is for Parquet; in a text file every line stays as it is")
    tally = Tally(columns=list(text.head.names))
    separator = text.head.separator
    with writing_text(out, zipped) as file:
        above, header, end, units = _around_the_names(source)
        file.write(source.mark)
        if job.spreadsheet_safe:
            header = text.parser.line_without_formulas(header, fields_of(header, separator))
        names = above + header_with_results(header, separator, job.reading.first) + end
        file.write((names + with_empty(units, separator)).encode())

        def written(block: Block, rows: Rows) -> tuple[int, memoryview]:
            own = text.parser.without_formulas(block) if job.spreadsheet_safe else block
            return len(rows.codes), with_results(own, rows, separator, text.head.decimal)

        for count, data in correct_blocks(text, tally, log, written):
            file.write(data)
            progress(count)
    check_whole(text, tally)
    return tally


def check_whole(text: Text, tally: Tally) -> None:
    """Refuse a file whose rows do not fit its header, or whose columns have no value or another unit."""
    corrupt, width = tally.unusable.get(CORRUPT, 0), len(text.head.names)
    if 2 * corrupt >= max(tally.rows, 1):
        raise DataError(
            f"{text.path} cannot be read as rows of {width} fields like its header: {corrupt} of "
            f"{tally.rows} rows have more, first row {tally.first[CORRUPT]}"
        )
    if tally.doubtful(text.job):
        whole = pd.concat(list(text.tables()), ignore_index=True)
        text.corrector.correct(whole, Context(), (0, len(whole)), whole=True)


def correct_blocks(
    text: Text, tally: Tally, log: Sequence[Path], made: Callable[[Block, Rows], Made]
) -> Iterator[Made]:
    """What is made of each block and its results, in the order of the rows."""
    job, corrector = text.job, text.corrector
    if not corrector.remembers and not corrector.rows_around:

        def work(block: Block) -> tuple[Rows, list[Part], Made]:
            table = text.parsed(block)
            rows, parts = corrector.correct(table, Context(), (0, len(table)))
            return rows, parts, made(block, rows)

        for rows, parts, one in in_order(text.blocks(), work, job.threads):
            tally.add(rows, parts)
            yield one
        return
    held: dict[int, Block] = {}

    def tables() -> Iterator[pd.DataFrame]:
        for place, block in enumerate(text.blocks()):
            held[place] = block
            yield text.parsed(block)

    around = surroundings(text.path, log, corrector, text.tables_of, job.memory)
    then = lambda rows, place: made(held.pop(place), rows)  # noqa: E731
    yield from corrected(tables(), corrector, tally, then, **around, threads=job.threads)


def _around_the_names(file: TextFile) -> tuple[str, str, str, list[str]]:
    """The lines above the header, the header, what ends it, and the lines between it and the rows."""
    *above, ended = file.prelude[: file.head.above]
    header = ended.rstrip("\r\n")
    return "".join(above), header, ended[len(header) :] or "\n", file.prelude[file.head.above :]


def _kinds(names: Sequence[str], job: Job) -> dict[str, str]:
    """How to parse the columns that are no numbers."""
    requests = {name: own for name, own in job.reading.requests.items() if name in names}
    kinds = {job.models.by: "text"}
    for source in make(list(names), requests).assignments.values():
        if source.form.label:
            kinds[source.column] = "text"
        elif source.name == "time":
            kinds[source.column] = "time"
    return kinds


def _absent(job: Job) -> frozenset[str]:
    """Error codes that are texts, where these are the same for every column."""
    missing = job.reading.missing
    codes = missing.get("", ()) if isinstance(missing, dict) else missing
    return frozenset(code for code in codes if not _is_number(code))


def _is_number(code: str) -> bool:
    try:
        float(code)
    except ValueError:
        return False
    return True


@contextmanager
def writing_text(out: Path, zipped: bool) -> Iterator[IO[bytes]]:
    """Open a text file for writing; the same bytes each time, gzipped too."""
    with opened_output(out) as raw:
        if not zipped:
            yield raw
            return
        # no name, no date
        with gzip.GzipFile(filename="", mode="wb", fileobj=raw, compresslevel=6, mtime=0) as file:
            yield file  # type: ignore[misc]


def header_with_results(header: str, separator: str, first: str) -> str:
    """The header with the names of the results."""
    return separator.join((header, *results(first)))


def with_empty(lines: Sequence[str], separator: str) -> str:
    """Lines between the header and the rows, with an empty field for each result."""
    more = separator * len(RESULTS)
    bare = (line.rstrip("\r\n") for line in lines)
    return "".join(text + more + line[len(text) :] for text, line in zip(bare, lines, strict=True))


def with_results(block: Block, rows: Rows, separator: str, decimal: str) -> memoryview:
    """The lines of a block, each row with its results."""
    reasons = [_quoted(reason, separator) for reason in rows.reasons]
    status = [f"{reason}{separator}{reason}".encode() for reason in reasons]
    written = block.lines.with_results(rows.distance, rows.uncertainty, rows.codes, status, ord(decimal))
    return written.data


def _quoted(reason: str, separator: str) -> str:
    if separator in reason or '"' in reason:
        return '"' + reason.replace('"', '""') + '"'
    return reason
