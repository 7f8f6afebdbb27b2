"""The columns that are needed, from the lines of a block."""

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from echocal.observations.arrow import arrow
from echocal.observations.found import NOT_READ
from echocal.observations.layout import Head
from echocal.observations.numbers import EMPTY, NO_NUMBER
from echocal.observations.scanner import Block, Scanner, strings, texts_of
from echocal.outputs import spreadsheet_safe


class Parser:
    """Parses blocks of one file.

    `kinds` is ``"number"``, ``"time"`` or ``"text"`` by column; `absent` are texts that mean "no value" in
    each column, besides the usual ones.
    """

    def __init__(self, head: Head, kinds: Mapping[str, str], absent: frozenset[str]) -> None:
        self._head, self._kinds = head, kinds
        self._empty = EMPTY | absent
        self._absent = [text.encode() for text in sorted(NO_NUMBER | absent)]
        self._place = {name: place for place, name in enumerate(head.names)}

    def table(self, block: Block, columns: Sequence[str]) -> pd.DataFrame:
        """Some columns of the rows; where rows are not read, the column `NOT_READ` has the reasons."""
        places = sorted({self._place[name] for name in columns})
        names = {place: self._head.names[place] for place in places}
        asked = [place for place in places if self._kinds.get(names[place], "number") == "number"]
        decimal = self._head.decimal
        read = block.lines.numbers(asked, ord(decimal), self._absent)
        found: dict[str, Any] = {
            names[place]: own[0] for place, own in zip(asked, read, strict=True) if own is not None
        }
        others = [place for place in places if names[place] not in found]
        for place, own in zip(others, block.lines.texts(others), strict=True):
            name = names[place]
            if place in asked:  # for others to refuse or to read
                found[name] = texts_of([own]).str.replace(decimal, ".", regex=False)
            else:
                found[name] = texts_of([own], self._empty, are_times=self._kinds[name] == "time")
        table = pd.DataFrame(
            {name: found[name] for name in columns}, index=range(len(block.lines)), copy=False
        )
        unread = block.unread
        if unread:
            table[NOT_READ] = [unread.get(row) for row in range(len(table))]
        return table

    def without_formulas(self, block: Block) -> Block:
        """The same lines, with an apostrophe before texts that a spreadsheet would take for formulas."""
        lines = block.lines
        if not self._formula.search(lines.data, 0, lines.taken):
            return block
        begin, made = 0, []
        for end, behind, _, fields, is_cut in lines.records():
            text = lines.data[begin:end].decode()
            if is_cut is False:  # it becomes one quoted field
                text = spreadsheet_safe(text)
            elif fields is not None:
                text = self.line_without_formulas(text, [field.decode() for field in fields])
            made += [text.encode(), lines.data[end:behind]]
            begin = behind
        return Scanner("", self._head).scan(b"".join(made), block.first, last=True)[0]

    def line_without_formulas(self, line: str, values: Sequence[str]) -> str:
        """The same of one line; all other fields stay letter for letter."""
        texts = self._written.findall(line)[: len(values)]
        for place, value in enumerate(values):
            if spreadsheet_safe(value) != value:
                text = texts[place]
                blanks = text[: len(text) - len(text.lstrip(" "))]
                if text.startswith('"', len(blanks)):
                    texts[place] = blanks + "\"'" + value.replace('"', '""') + '"'
                else:
                    texts[place] = "\"'" + text.replace('"', '""') + '"'
        return self._head.separator.join(texts)

    @cached_property
    def _written(self) -> re.Pattern[str]:
        """A field as it is written."""
        cut = re.escape(self._head.separator)
        return re.compile(f'(?:^|(?<={cut}))( *"(?:[^"]|"")*"[^{cut}]*|[^{cut}]*)(?={cut}|$)', re.DOTALL)

    @cached_property
    def _formula(self) -> re.Pattern[bytes]:
        """What every block has in which a field begins as a formula."""
        cut = re.escape(self._head.separator.encode())
        return re.compile(rb'(?:^|["\r\n]|%b)[\s\x00-\x1f"]*(?:[=+\-@]|\xef\xbc[\x8b\x8d\x9d\xa0])' % cut)

    def fields(self, block: Block) -> Any:
        """Every field of the rows as the text that it is, an Arrow table; null where a row has too few.

        A corrupt row has none.
        """
        pa = arrow("Parquet")
        short = block.lines.short()
        columns = []
        for place, own in enumerate(block.lines.texts(list(range(len(self._head.names))))):
            column = strings(*own)
            absent = [row for row, count in short if count <= place]
            if absent:
                mask = np.zeros(len(column), dtype=bool)
                mask[absent] = True
                column = pa.compute.if_else(pa.array(mask), None, column)
            columns.append(column)
        return pa.table(columns, names=list(self._head.names))
