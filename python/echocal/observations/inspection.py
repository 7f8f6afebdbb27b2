"""What a log holds, before it is used: columns with their meaning, missing values, the clock, sensors."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import EchocalError
from echocal.observations.doubtful import note_of, sensors_in
from echocal.observations.fields import floats, span
from echocal.observations.found import found_in
from echocal.observations.names import EXTRA, IGNORE
from echocal.observations.options import ReadOptions
from echocal.observations.plan import refuse_absent
from echocal.observations.proposals import Proposal, codes_in, propose
from echocal.observations.reading import read_observations
from echocal.observations.source import load
from echocal.observations.table import Observations
from echocal.observations.units import split_unit

_BINS = 10
_JUMP = 5.0  # usual steps
_SHOWN = 5


@dataclass(frozen=True)
class ColumnFacts:
    """A column of a log."""

    name: str
    unit: str
    proposal: Proposal
    # filled, missing: rows with a value and without
    filled: int
    missing: int
    codes: list[float] = field(default_factory=list)
    # least, median, most: of the numbers
    """Values that look like error codes."""
    least: float | None = None
    median: float | None = None
    most: float | None = None
    histogram: list[int] = field(default_factory=list)
    """Numbers in 10 classes from `least` to `most`, error codes left out."""
    examples: list[str] = field(default_factory=list)
    """First different values of a column of text."""


@dataclass(frozen=True)
class Clock:
    """The times of a log."""

    # first, last: ISO 8601 in UTC, or seconds
    first: str
    last: str
    usual_step_s: float
    # gaps, backwards, equal: steps of more than five usual ones, steps back, and rows with the time of the
    # row before
    gaps: int
    backwards: int
    equal: int
    shown: list[str]  # the first of these, with their rows


@dataclass(frozen=True)
class Inspection:
    """What a log holds."""

    kind: str  # the format
    rows: int
    columns: list[ColumnFacts]
    clock: Clock | None
    sensors: dict[str, int]  # columns that tell sensors apart, with the number of sensors
    notes: list[str]
    usable: int | None  # rows that can be used if the proposals are accepted; None where the table is refused
    refusal: str  # why it is refused
    table: pd.DataFrame
    observations: Observations | None  # what is read if they are; None where the table is refused
    requests: dict[str, str]  # the proposals, as `echocal.read_observations` takes `columns`
    missing: dict[str, list[str]]  # error codes, as it takes `missing`

    def to_dict(self) -> dict[str, Any]:
        """The facts as JSON holds them."""
        own = {"table", "observations", "columns", "clock"}
        plain = {name: value for name, value in vars(self).items() if name not in own}
        return {
            "schema": "echocal.inspection/1",
            **plain,
            "columns": [asdict(column) for column in self.columns],
            "clock": None if self.clock is None else asdict(self.clock),
        }


def inspect_log(path: Path, options: ReadOptions | None = None) -> Inspection:
    """Look at a log, without using it. The options are what the user says already, ``missing`` by column.

    Raises `DataError` if the file cannot be read as a table of any kind.
    """
    options = options or ReadOptions()
    missing, how = dict(options.missing), options.given()
    table = load(path, options.layout, sheet=options.sheet)
    columns = options.requests_of(table.columns)  # the others are refused where the other log is read
    refuse_absent(columns, table.columns)
    found = found_in(table)
    proposals = propose(table, found, columns)
    away = {EXTRA, IGNORE}
    looked_at = [n for n in table.columns if proposals[str(n)].request not in away and str(n) not in missing]
    seen = {str(n): codes_in(table[n]) for n in looked_at}
    codes = {name: [f"{code:g}" for code in own] for name, own in seen.items() if own}
    all_codes = {**codes, **missing}
    requests = {name: p.request for name, p in proposals.items() if p.request and p.reason != "its name"}
    asked = {**options.requests, **requests} if options.reference is not None else requests
    observations, refusal = _read(table, asked, all_codes, how)
    said = {*found.notes, note_of(table, set(columns))}  # of sensors there is a line
    notes = [
        *found.notes,
        *(n for n in (() if observations is None else observations.notes) if n not in said),
    ]
    facts = [_facts(table[n], proposals[str(n)], found.units, codes.get(str(n), [])) for n in table.columns]
    return Inspection(
        found.kind or "a table",
        len(table),
        facts,
        None if observations is None else _clock(observations),
        sensors_in(table),
        list(dict.fromkeys(note for note in notes if not note.startswith("read by name and unit"))),
        None if observations is None else int(observations.usable.sum()),
        refusal,
        table,
        observations,
        {
            name: request
            for name, request in requests.items()
            if name not in found.requests or request != IGNORE
        },
        all_codes,
    )


def _read(
    table: pd.DataFrame, requests: Mapping[str, str], codes: Mapping[str, list[str]], how: Mapping[str, Any]
) -> tuple[Observations | None, str]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return read_observations(table, **{**how, "columns": requests, "missing": dict(codes)}), ""
        except EchocalError as error:
            return None, str(error)


def _facts(
    values: pd.Series[Any], proposal: Proposal, units: Mapping[str, str], codes: list[str]
) -> ColumnFacts:
    name = str(values.name)
    unit = units.get(name, "") or split_unit(name)[1].replace("percent", "%").replace("_", "/")
    numbers = floats(values)
    finite = numbers[np.isfinite(numbers)]
    empty = int(values.isna().sum() + (values.astype(object) == "").sum())
    filled = len(values) - empty
    if not len(finite) or 2 * len(finite) < filled:
        examples = list(dict.fromkeys(str(v) for v in values.dropna().head(200)))[:3]
        return ColumnFacts(name, unit, proposal, filled, empty, examples=examples)
    own = [float(code) for code in codes]
    usual = finite[~np.isin(finite, own)]
    usual = usual if len(usual) else finite
    counts = np.histogram(usual, bins=_BINS)[0] if np.ptp(usual) else np.array([len(usual)])
    low, middle, high = (float(f(usual)) for f in (np.min, np.median, np.max))
    return ColumnFacts(name, unit, proposal, filled, empty, own, low, middle, high, counts.tolist())


def _clock(observations: Observations) -> Clock | None:
    seconds = observations.conditions.get("elapsed_time")
    if seconds is None or np.isfinite(seconds).sum() < 2:
        return None
    rows = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[rows])
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    gaps, back, equal = (np.flatnonzero(m) for m in (steps > _JUMP * usual, steps < 0, steps == 0))
    shown = [f"row {rows[n] + 2}: {span(steps[n])} after the row before" for n in gaps[:_SHOWN]]
    shown += [f"row {rows[n] + 2}: {span(-steps[n])} back" for n in back[:_SHOWN]]
    first, last = (f"{v:g} s" for v in (seconds[rows].min(), seconds[rows].max()))
    if observations.time is not None:
        known = observations.time[~np.isnat(observations.time)]
        first, last = (str(v.astype("datetime64[s]")) + "Z" for v in (known.min(), known.max()))
    return Clock(first, last, usual, len(gaps), len(back), len(equal), shown)
