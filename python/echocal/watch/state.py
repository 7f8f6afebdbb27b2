"""The state of a watch in a file: a restart continues as if nothing had happened."""

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.watch.rows import Row

SCHEMA = "echocal.watch/5"

_TABLES = {
    "facts": "name text primary key, value text",
    "sensors": "id text primary key, value text",
    "positions": "source text primary key, value text",
    "rows": "sensor text, number integer, time real, value text, primary key (sensor, number)",
}

_SEAL = 16  # characters before each value, which tell whether it is the one that was written


class State:
    """What is kept between rows, committed as a whole; in memory without a path.

    Parameters
    ----------
    path : Path or None
        An SQLite file.

    Raises
    ------
    UsageError
        If the file cannot be used.
    DataError
        If it is not as it was written: each value has a checksum.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path
        try:
            self._base = sqlite3.connect(
                ":memory:" if path is None else str(path), isolation_level=None, timeout=1.0
            )
        except sqlite3.DatabaseError as error:
            raise UsageError(f"{keyword('state', str(path))} cannot be used: {error}") from None
        try:
            if path is not None:
                self._base.execute("pragma locking_mode = exclusive")
            self._base.execute("begin exclusive")
            self._refuse_damage()
            for name, columns in _TABLES.items():
                self._base.execute(f"create table if not exists {name} ({columns})")
            self.commit()
        except DataError:
            self._base.close()
            raise
        except (sqlite3.DatabaseError, UnicodeError) as error:
            self._base.close()
            if "decode" in str(error):
                raise self._damaged(str(error)) from None
            busy = "another watch is using it" if "locked" in str(error) else str(error)
            raise UsageError(f"{keyword('state', str(path))} cannot be used: {busy}") from None

    def check(self, facts: Mapping[str, Any]) -> None:
        """Refuse a state of another watch: of other settings its sums would mean something else.

        Raises `DataError` with both sides.
        """
        for name, value in {"schema": SCHEMA, **facts}.items():
            kept = self.fact(name)
            if kept is None:
                self.set_fact(name, value)
            elif kept != json.loads(json.dumps(value)):
                here = keyword("state", str(self.path))
                raise DataError(
                    f"{here} was made with {name} = {kept!r}, this watch has {value!r}: "
                    f"give the same, or begin with another {keyword('state')}"
                )

    def fact(self, name: str) -> Any:
        """A fact by its name; None if there is none."""
        return self._one("facts", "name", name)

    def set_fact(self, name: str, value: Any) -> None:
        """Keep a fact."""
        self._put("facts", name, json.dumps(value))

    def sensor(self, id_: str) -> Any:
        """What was kept of a sensor; None if it is new."""
        return self._one("sensors", "id", id_)

    def keep(self, id_: str, value: Mapping[str, Any]) -> None:
        """Keep the state of a sensor."""
        self._put("sensors", id_, json.dumps(value, default=_plain))

    def position(self, source: str) -> Any:
        """How far a source was read; None if it is new."""
        return self._one("positions", "source", source)

    def set_position(self, source: str, value: Any) -> None:
        """Keep how far a source was read."""
        self._put("positions", source, json.dumps(value))

    def add_rows(self, sensor: str, rows: Iterable[tuple[int, float, Row]]) -> None:
        """Keep rows of a sensor by number and time."""
        kept = (
            ((sensor, number, None if time != time else float(time)), json.dumps(dict(row), default=_plain))
            for number, time, row in rows
        )
        sealed = [(*key, _sealed("rows", key, text)) for key, text in kept]
        self._base.executemany("insert or replace into rows values (?, ?, ?, ?)", sealed)

    def forget_rows(self, sensor: str, until: int) -> None:
        """Forget rows of a sensor up to a number."""
        self._base.execute("delete from rows where sensor = ? and number <= ?", (sensor, until))

    def rows_between(self, sensor: str, time: float, after: int, until: int) -> list[Row]:
        """Rows of a sensor from a time on, of numbers above `after` and up to `until`."""
        found = self._base.execute(
            "select value from rows where sensor = ? and time >= ? and number > ? and number <= ? "
            "order by number",
            (sensor, time, after, until),
        )
        return [json.loads(value[_SEAL:]) for (value,) in found]

    def commit(self) -> None:
        """Make all changes lasting, at once."""
        self._base.execute("commit")
        self._base.execute("begin exclusive")

    def roll_back(self) -> None:
        """Forget all changes since the last commit."""
        self._base.execute("rollback")
        self._base.execute("begin exclusive")

    def close(self) -> None:
        """Forget what was not committed."""
        self._base.close()

    def _one(self, table: str, column: str, key: str) -> Any:
        found = self._base.execute(f"select value from {table} where {column} = ?", (key,)).fetchone()
        return None if found is None else json.loads(found[0][_SEAL:])

    def _put(self, table: str, key: str, text: str) -> None:
        self._base.execute(
            f"insert or replace into {table} values (?, ?)", (key, _sealed(table, (key,), text))
        )

    def _refuse_damage(self) -> None:
        """Refuse a file that is not as it was written."""
        names = {
            name for (name,) in self._base.execute("select name from sqlite_master where type = 'table'")
        }
        if not names:
            return
        (told,) = self._base.execute("pragma integrity_check(1)").fetchone()
        if names != set(_TABLES):
            told = f"it has the tables {', '.join(sorted(names))}"
        for table in _TABLES if told == "ok" else ():
            for *key, value in self._base.execute(f"select * from {table}"):
                if value != _sealed(table, key, str(value)[_SEAL:]):
                    told = f"{key[0]!r} in {table} has another checksum"
        if told != "ok":
            raise self._damaged(told)

    def _damaged(self, told: str) -> DataError:
        message = (
            f"{keyword('state', str(self.path))} is damaged, or of another version of echocal ({told}): "
            f"take a copy of it, or begin with another {keyword('state')}"
        )
        return DataError(message)


def _sealed(table: str, key: Sequence[Any], text: str) -> str:
    """A value with its checksum before it, which also tells of its place."""
    said = json.dumps([table, *key, text]).encode()
    return hashlib.blake2b(said, digest_size=_SEAL // 2).hexdigest() + text


def _plain(value: Any) -> Any:
    """What JSON can hold of a field: a number of NumPy as a number, anything else as text."""
    return value.item() if isinstance(value, np.generic) else str(value)
