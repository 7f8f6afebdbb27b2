"""Rows as they come, read like a table: what cannot be read has a reason and stops nothing."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError, UsageError
from echocal.observations import Observations, read_observations
from echocal.observations.hints import completed
from echocal.observations.names import IGNORE
from echocal.observations.numbers import Missing, is_damaged, to_numbers
from echocal.observations.plan import EVERYTHING, Plan, make, read_columns

__all__ = ["Block", "Reader", "Row", "taken"]

Row = Mapping[str, Any]
Column = NDArray[np.float64]

_REFERENCES = ("reference_distance", "stand", "group", "order")
_WORDS = ("elapsed_time", "stand", "group")
_NEEDED = ("echo_time", "reading")


@dataclass(frozen=True)
class Block:
    """Rows with the same columns.

    Attributes
    ----------
    index : ndarray of int, shape (n,)
        Their places among the rows that were given.
    observations : Observations
    reference : ndarray, shape (n,)
        Reference distance [m]; NaN where a row has none.
    time : ndarray, shape (n,)
        Seconds, since 1970 where the rows have times of day; NaN where a row has none.
    """

    index: NDArray[np.intp]
    observations: Observations
    reference: Column
    time: Column


class Reader:
    """Read rows by the names of their columns.

    Parameters
    ----------
    columns : mapping of str to str, optional
        Meaning of columns, as in `echocal.read_observations`.
    ignored : collection of str
        Columns that hold no quantity, such as the sensor's id.
    **options
        Further arguments of `echocal.read_observations`.
    """

    def __init__(
        self, columns: Mapping[str, str] | None = None, *, ignored: Sequence[str] = (), **options: Any
    ) -> None:
        self.requests = read_columns(columns)
        self.ignored = tuple(ignored)
        self.options = options
        self.trust = tuple(options.pop("trust", ()))

    def read(self, rows: Sequence[Row]) -> tuple[list[Block], list[str]]:
        """Blocks of the rows that can be read, and for each row why it cannot be, else empty."""
        status = [""] * len(rows)
        groups: dict[frozenset[str], list[int]] = {}
        for place, row in enumerate(rows):
            groups.setdefault(frozenset(row), []).append(place)
        blocks = [
            block
            for names, places in groups.items()
            for block in self._group([n for n in rows[places[0]] if n in names], places, rows, status)
        ]
        return blocks, status

    def _group(
        self, names: list[str], places: list[int], rows: Sequence[Row], status: list[str]
    ) -> list[Block]:
        requests = {name: said for name, said in self.requests.items() if name in names}
        requests |= {name: IGNORE for name in self.ignored if name in names}
        requests, _ = completed(names, requests)
        plan = make(names, requests)
        echo = [plan.assignments[name].column for name in _NEEDED if name in plan.assignments]
        if not echo:
            reading = read_observations({name: [1.0] for name in names}, requests, trust=[EVERYTHING])
            raise DataError(f"rows without an echo: {reading.notes}")  # the reader has said it better
        full = []
        for place in places:
            absent = [name for name in echo if _is_empty(rows[place][name])]
            if len(absent) == len(echo):
                status[place] = f"{echo[0]} missing"
            else:
                full.append(place)
        try:
            return [self._block(names, requests, plan, full, rows)] if full else []
        except UsageError:
            raise
        except DataError as error:
            if len(full) == 1:
                status[full[0]] = self._damage(plan, rows[full[0]]) or str(error)
                return []
        found = []
        for place in full:  # one of them cannot be read
            found += self._group(names, [place], rows, status)
        return found

    def _block(
        self,
        names: list[str],
        requests: dict[str, str],
        plan: Plan,
        places: list[int],
        rows: Sequence[Row],
    ) -> Block:
        frame = pd.DataFrame({name: [rows[place][name] for place in places] for name in names})
        away = {plan.assignments[role].column for role in _REFERENCES if role in plan.assignments}
        hollow = {name for name in names if name not in away and all(map(_is_empty, frame[name]))}
        away |= hollow & {a.column for a in plan.assignments.values() if a.form.quantity in _NEEDED}
        ignored = requests | dict.fromkeys(away, IGNORE)
        with warnings.catch_warnings(action="ignore"):  # each row has its reason
            observations = read_observations(
                frame, ignored, trust=(*self._trusted(names), EVERYTHING), **self._options(names)
            )
        return Block(
            np.array(places, dtype=np.intp),
            observations,
            self._reference(frame, plan),
            _time(observations, len(places)),
        )

    def _damage(self, plan: Plan, row: Row) -> str:
        """Why a row alone cannot be read, in the words of a table that has it among others."""
        missing = Missing(self._options(list(row)).get("missing", ()))
        for role, source in plan.assignments.items():
            if role not in _WORDS and is_damaged(row[source.column], source.column, missing):
                return f"{source.column} is no number"
        clock = plan.assignments.get("elapsed_time")
        if clock is None or not isinstance(row[clock.column], str):
            return ""
        instant = pd.to_datetime(row[clock.column], format="ISO8601", errors="coerce")
        return f"{clock.column} missing" if pd.isna(instant) else ""

    def _trusted(self, names: list[str]) -> list[str]:
        return [name for name in self.trust if name in names]

    def _options(self, names: list[str]) -> dict[str, Any]:
        missing = self.options.get("missing", ())
        if isinstance(missing, Mapping):
            missing = {name: codes for name, codes in missing.items() if name in (*names, "")}
        return {**self.options, "missing": missing}

    def _reference(self, frame: pd.DataFrame, plan: Plan) -> Column:
        source = plan.assignments.get("reference_distance")
        if source is None or all(map(_is_empty, frame[source.column])):
            return np.full(len(frame), np.nan)
        missing = self._options(list(frame.columns)).get("missing", ())
        values = source.unit.to_si(to_numbers(frame[source.column], source.column, Missing(missing)))
        return np.where(np.asarray(values) > 0.0, values, np.nan)


def taken(observations: Observations, rows: NDArray[np.intp]) -> Observations:
    """Some rows of a table, with what their correction needs."""
    reading = observations.reading
    return replace(
        observations,
        echo_time=observations.echo_time[rows],
        conditions={name: values[rows] for name, values in observations.conditions.items()},
        unusable=observations.unusable[rows],
        reading=None if reading is None else reading[rows],
        time=None if observations.time is None else observations.time[rows],
        labels={},
        extra={name: values[rows] for name, values in observations.extra.items()},
        thermometers={name: values[rows] for name, values in observations.thermometers.items()},
    )


def _time(observations: Observations, rows: int) -> Column:
    times = observations.time
    if times is not None:
        seconds = (times - np.datetime64(0, "ns")) / np.timedelta64(1, "s")
        return np.asarray(np.where(np.isnat(times), np.nan, seconds), dtype=np.float64)
    return np.asarray(observations.conditions.get("elapsed_time", np.full(rows, np.nan)))


def _is_empty(value: Any) -> bool:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return True
    return isinstance(value, str) and value.strip().lower() in {"", "nan", "na", "null", "none"}
