"""A watch that runs: each batch is corrected, written, committed and acknowledged, or set aside."""

import json
import sqlite3
from base64 import b64encode
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime

from echocal.correct.results import STATUS
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.watch.events import Event
from echocal.watch.fleet import Fleet
from echocal.watch.output import Growing, Stream, Table
from echocal.watch.parser import Arrival, Batch, Unread
from echocal.watch.rows import Row, refused_names
from echocal.watch.source import Source

SCHEMA = "echocal.unread/1"


@dataclass
class Run:
    """Rows from a source, and where their results go."""

    fleet: Fleet
    source: Source
    table: Table | Stream | None  # takes the corrected rows
    events: Growing | None  # takes the events, as JSON lines
    letters: Growing | None  # takes what is set aside with its reason, as JSON lines
    tell: Callable[[Sequence[Event]], None]  # shows events
    say: Callable[[str], None]  # shows a note
    pass_on: Callable[[Sequence[Row], Sequence[Event]], None] | None = None  # takes what is committed
    changes: int = 0
    aside: int = 0
    _counts: tuple[int, int, int] = (0, 0, 0)
    _lost: Counter[str] = field(default_factory=Counter)
    _first: dict[str, str] = field(default_factory=dict)

    def take(self, batch: Batch) -> None:
        """Deal with a batch. What one row breaks concerns that row only.

        Raises `EchocalError` if the watch cannot go on, whatever the row.
        """
        for text in batch.notes:
            self.say(text)
        rows, aside = self._screened(batch)
        try:
            self._done(rows, batch, aside)
        except (UsageError, OSError, sqlite3.OperationalError):
            raise
        except Exception as error:
            if isinstance(error, DataError) and not self.fleet.mixed:
                raise
            self._back()
            self._one_by_one(rows, batch, aside)

    def _screened(self, batch: Batch) -> tuple[list[Arrival], list[Unread]]:
        """Rows with what they were made of, and what is none."""
        rows, aside = [], list(batch.unread)
        for arrival in batch.rows:
            row = arrival.row
            if self.fleet.mixed:
                why = self.fleet.refusal(row)
                if not why and isinstance(self.table, Table):  # not later, when it has waited among others
                    why = self.table.refusal([*row, *self.fleet.results(row)])
            else:  # the first rows of a table are refused as a whole
                why = refused_names(row, self.fleet.results(row)) if self.fleet.state.fact("begun") else ""
            if why:
                aside.append(Unread(arrival.source, why, arrival.text))
            else:
                rows.append(arrival)
        return rows, aside

    def _one_by_one(self, rows: list[Arrival], batch: Batch, aside: list[Unread]) -> None:
        """Try each row by itself, and set aside what fails."""
        self._done([], batch, aside)
        for arrival in rows:
            self.fleet.meet([arrival.row])  # what fails here is no fault of the row
            self.fleet.forget()
            try:
                self._done([arrival], batch, [])
            except (UsageError, OSError, sqlite3.OperationalError):
                raise
            except Exception as error:
                self._back()
                why = str(error) if isinstance(error, DataError) else f"{type(error).__name__}: {error}"
                self._done([], batch, [Unread(arrival.source, why, arrival.text)])

    def _done(self, rows: list[Arrival], batch: Batch, aside: list[Unread]) -> None:
        """Correct rows, write everything, and commit it."""
        own, whys = [arrival.row for arrival in rows], [arrival.why for arrival in rows]
        corrected, news = self.fleet.take(own, batch.decimal, batch.units, whys)
        self._write(corrected, news, aside)
        self.source.done(self.fleet.state)
        self.fleet.state.commit()
        self._counts = self.fleet.rows, self.fleet.corrected, self.fleet.ignored
        self._show(news, aside)
        if self.pass_on is not None:
            self.pass_on(corrected, news)

    def _write(self, corrected: list[Row], news: list[Event], aside: list[Unread]) -> None:
        state = self.fleet.state
        if not state.fact("corrected"):
            if any(row[self.fleet.results(row)[0]] is not None for row in corrected):
                state.set_fact("corrected", True)
            for row in corrected:
                self._lost[row[STATUS]] += 1
                self._first.setdefault(
                    row[STATUS], str(row.get(row[STATUS].removesuffix(" is no number"), ""))
                )
        if self.table is not None:
            self.table.write(corrected)
        if self.events is not None:
            self.events.write("".join(event.line_of_json() for event in news))
            self.events.done(state)
        if self.letters is not None:
            self.letters.write("".join(map(_letter, aside)))
            self.letters.done(state)
        if self.table is not None:
            self.table.done(state)

    def _show(self, news: list[Event], aside: list[Unread]) -> None:
        self.changes += sum(event.kind == "change" for event in news)
        before, self.aside = self.aside, self.aside + len(aside)
        said = list(dict.fromkeys(f"{one.source}: {one.reason}" for one in aside))
        if self.letters is None:
            for text in said:
                self.say(text)
        elif said and before.bit_length() < self.aside.bit_length():  # and whenever they have doubled
            self.say(f"{said[-1]} ({self.aside} set aside so far, in {self.letters.path})")
        self.tell(news)

    def _back(self) -> None:
        """Undo what is not committed."""
        self.fleet.state.roll_back()
        self.fleet.forget()
        self.fleet.rows, self.fleet.corrected, self.fleet.ignored = self._counts
        for output in (self.table, self.events, self.letters):
            if output is not None:
                output.back()

    def end(self) -> None:
        """Deal with the rows that still wait for later ones.

        Without a file for the state nothing comes after this. With one, they are written as they are now, and
        the next start takes them back: the rows after them may say something else of them.
        """
        if self.fleet.state.path is None:
            corrected, news = self.fleet.finish()
            self._write(corrected, news, [])
            self._show(news, [])
            if self.pass_on is not None:
                self.pass_on(corrected, news)
        elif isinstance(self.table, Table):
            self.table.write(self.fleet.so_far())
            self.table.flush()

    def summary(self) -> str:
        """What was done."""
        fleet = self.fleet
        said = [f"{fleet.rows} rows, {fleet.corrected} corrected", f"{self.changes} changes told"]
        if fleet.ignored:
            said.append(f"{fleet.ignored} rows not tested")
        if self.aside:
            where = "" if self.letters is None else f" in {self.letters.path}"
            said.append(f"{self.aside} set aside{where}")
        return "; ".join(said)

    def refuse_nothing(self, empty: str) -> None:
        """Refuse to call rows done if none was corrected, nor by an earlier watch with this state.

        `empty` is what to say where no row has come at all; nothing where more is expected. Raises
        `DataError` with the reasons.
        """
        if self.fleet.state.fact("corrected"):
            return
        if not (self._lost or self.aside):
            if empty and not self.fleet.state.fact("begun"):
                raise DataError(empty)
            return
        most = [(why, rows, self._first[why]) for why, rows in self._lost.most_common(3)]
        said = [f"{rows} x {why}" + (f", first {field!r:.80}" if field else "") for why, rows, field in most]
        said += [f"{self.aside} lines are no rows"] if self.aside else []
        comma = any("," in own for _, _, own in most)
        way = f"; a decimal comma? pass {keyword('decimal', ',')}" if comma else ""
        raise DataError(f"no row could be corrected: {'; '.join(said)}{way}")


def _letter(one: Unread) -> str:
    now = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    told = {"schema": SCHEMA, "time": now, "source": one.source, "reason": one.reason}
    try:
        held = {"text": one.text.decode()}
    except UnicodeDecodeError:
        held = {"base64": b64encode(one.text).decode()}
    return json.dumps(told | held) + "\n"
