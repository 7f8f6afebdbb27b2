"""Clocks of watched sensors: every form of time, in one file, in pieces and row by row; clocks that leap."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from watched import noise

import echocal
from echocal.observations.hints import hint
from echocal.observations.units import FORMS, NAMES
from echocal.observations.vocabulary import CLOCK_UNITS, COUNTERS, SINCE, TIMES
from echocal.quantities import QUANTITIES
from echocal.watch import Fleet, Reference, State, WatchSettings

Field = Callable[[pd.Timestamp], Any]
Run = Callable[..., tuple[int, str]]

DEVICE = echocal.Model("343")
ROWS, CHANGE, LEARN, WAIT = 200, 160, 100, 3600
BEGIN = pd.Timestamp("2026-03-01T00:00:00Z")
BOOT = BEGIN - pd.Timedelta("7s")


def number(name: str, since: pd.Timestamp) -> Field:
    """A field that counts, in the unit that the name of its column says."""
    form, symbol = NAMES[name]
    return lambda time: round(form.units[symbol].from_si((time - since).total_seconds()), 9)


def forms() -> dict[str, tuple[str, Field, dict[str, Any]]]:
    """Every way in which a column may hold the time: its name, its fields and the options that it needs."""
    epoch = pd.Timestamp(0, tz="UTC")
    found: dict[str, tuple[str, Field, dict[str, Any]]] = {}
    clocks = [form for form in FORMS if form.quantity == "elapsed_time"]
    assert clocks == list(QUANTITIES["elapsed_time"].forms)
    counted = [name for form in clocks for name, unit in zip(form.names, form.units, strict=True) if unit]
    for name in counted:
        found[f"{name} since the start"] = name, number(name, BOOT), {}
        found[f"{name} since 1970"] = name, number(name, epoch), {}
    for written, options in (
        ("%Y-%m-%d %H:%M:%S", {}),
        ("%Y-%m-%dT%H:%M:%SZ", {}),
        ("%Y-%m-%dT%H:%M:%S.%f+00:00", {}),
        ("%Y-%m-%d %H:%M", {}),
        ("%Y/%m/%d %H:%M:%S", {}),
        ("%d.%m.%Y %H:%M:%S", {}),
        ("%d.%m.%y %H:%M", {}),
        ("%d/%m/%Y %H:%M:%S", {}),
        ("%m/%d/%Y %H:%M", {}),
        ("%m/%d/%Y %I:%M:%S %p", {}),
        ("%d-%m-%Y %H:%M", {}),
        ("%d %b %Y %H:%M:%S", {}),
        ("%B %d, %Y %H:%M", {}),
        ("%Hh%M %d|%m|%Y", {"time_format": "%Hh%M %d|%m|%Y"}),
        ("%Y-%m-%dT%H:%M:%S", {"time_zone": "+05:30"}),
    ):
        found[f"{written} {options or ''}"] = "time", lambda time, w=written: time.strftime(w), options  # type: ignore[misc]
    return found


def names() -> dict[str, Field]:
    """Every other name of a column of times that is understood, with its fields."""
    texts = [name for name in sorted(TIMES) if not name.startswith("time_")]  # refused: time has no such unit
    found: dict[str, Field] = dict.fromkeys(texts, lambda time: time.strftime("%Y-%m-%dT%H:%M:%S"))
    for name in (*COUNTERS, *(f"{word}_{unit}" for word in sorted(SINCE) for unit in CLOCK_UNITS)):
        said = hint(name)
        if said is not None and NAMES[said.name][0].quantity == "elapsed_time":
            found[name] = number(said.name, BOOT)
    return found


ALL = forms()


def log(
    random: np.random.Generator, name: str, field: Field, begin: pd.Timestamp = BEGIN, wait: float = WAIT
) -> list[dict[str, Any]]:
    """Rows of a sensor that reads 50 mm too far from one row on, which a sound clock tells soon, and once.

    It does so in 6 of 7 draws. The others are left out: here the clock is tested. It must be told without
    the rows of the first day, too: a watch leaves them out where day and month cannot be told apart.
    """
    while True:
        distance = random.uniform(0.5, 3.0, ROWS)
        error = noise(random, ROWS) + np.where(np.arange(ROWS) < CHANGE, 0.0, 0.05)
        echo = 2e6 * (distance + error) / 343.0
        rows = [
            {"time_s": WAIT * i, "echo_us": e, "distance_m": d}
            for i, (e, d) in enumerate(zip(echo.tolist(), distance.tolist(), strict=True))
        ]
        if all(tells_the_change(rows, first) for first in (0, 24)):
            break
    times = [field(begin + pd.Timedelta(wait * i, "s")) for i in range(ROWS)]
    return [{name: time, **own} for time, own in zip(times, rows, strict=True) if own.pop("time_s") >= 0]


def tells_the_change(rows: list[dict[str, Any]], first: int) -> bool:
    changes = [own for own in told(rows[first:], lambda: ROWS)[1] if own["event"] == "change"]
    if len(changes) != 1 or first + changes[0]["row"] > CHANGE + 6:
        return False
    low, high = changes[0]["since_interval"]
    return low <= WAIT * CHANGE <= high  # type: ignore[no-any-return]


def fleet(state: Path | None = None, **more: Any) -> Fleet:
    settings = WatchSettings(learn=LEARN, fewest=10**6)  # the diagnosis is another test's
    return Fleet(lambda _: DEVICE, more.pop("by", None), Reference(), settings, State(state), **more)


def told(
    rows: list[dict[str, Any]], sizes: Callable[[], int], state: Path | None = None, **more: Any
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows and events of a watch that gets rows in pieces; with a file for its state each is a restart."""
    watch, done, events = fleet(state, **more), [], []
    first = 0
    while first < len(rows):
        last = first + sizes()
        own, news = watch.take(rows[first:last])
        watch.state.commit()
        done, events, first = done + own, events + [event.to_dict() for event in news], last
        if state is not None and first < len(rows):
            watch.state.close()
            watch = fleet(state, **more)
    return done, events


def three_ways(
    rows: list[dict[str, Any]], random: np.random.Generator, path: Path, **more: Any
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows and events, which are the same in one file, in pieces with restarts, and row by row."""
    whole = told(rows, lambda: len(rows), **more)
    assert told(rows, lambda: int(random.integers(1, 90)), path / "s.db", **more) == whole
    assert told(rows, lambda: 1, **more) == whole
    return whole


def only(events: list[dict[str, Any]], kind: str) -> dict[str, Any]:
    (found,) = [event for event in events if event["event"] == kind]
    return found


@pytest.mark.parametrize("form", ALL, ids=str)
def test_every_form_of_time(form: str, random: np.random.Generator, tmp_path: Path) -> None:
    name, field, options = ALL[form]
    rows = log(random, name, field)
    done, events = three_ways(rows, random, tmp_path, options=options)
    assert all(row["corrected_distance_m"] is not None for row in done)
    learned, change = only(events, "learned"), only(events, "change")
    assert learned["interval_s"] == pytest.approx(WAIT, rel=1e-6)
    assert CHANGE < change["row"] < CHANGE + 20
    ignored = [event for event in events if event["event"] == "ignored"]
    if ignored:  # day and month cannot be told apart on the first day
        assert all("day and month cannot be told apart" in event["reason"] for event in ignored)
        assert "/" in form or "-%m-%Y" in form
        assert max(event["rows"] for event in ignored) <= 24
    low, high = change["since_interval"]
    if "since 1970" in form or isinstance(rows[0][name], str):
        at = BEGIN + pd.Timedelta(WAIT * CHANGE, "s")
        at -= pd.Timedelta("5h30min") if "time_zone" in options else pd.Timedelta(0)
        assert pd.Timestamp(low) <= at <= pd.Timestamp(high)
    else:
        at = (BEGIN - BOOT).total_seconds() + WAIT * CHANGE  # by the log's own clock, whatever its unit
        assert low - 1e-3 <= at <= high + 1e-3


@pytest.mark.parametrize("zone", ["America/New_York", "Europe/Berlin", "Australia/Lord_Howe"])
@pytest.mark.parametrize("which", [0, 1])
def test_local_times_over_a_clock_change(
    zone: str, which: int, random: np.random.Generator, tmp_path: Path
) -> None:
    """No row is lost where an hour is skipped, or comes twice."""
    days = pd.date_range("2026-01-01", "2026-12-31", freq="D", tz=zone)
    at = [a for a, b in pairwise(days) if b - a != pd.Timedelta("1D")][which]
    begin = at.tz_convert("UTC") - pd.Timedelta("20h") + pd.Timedelta(random.integers(600), "s")
    field = lambda time: time.tz_convert(zone).strftime("%Y-%m-%d %H:%M:%S")  # noqa: E731
    rows = log(random, "time", field, begin, 900.0)
    _, events = three_ways(rows, random, tmp_path, options={"time_zone": zone})
    assert [event["event"] for event in events] == ["learned", "change"]
    assert events[0]["interval_s"] == pytest.approx(900.0)
    low, high = map(pd.Timestamp, events[1]["since_interval"])
    assert low <= begin + pd.Timedelta(900 * CHANGE, "s") <= high


def test_every_name_of_a_clock(random: np.random.Generator) -> None:
    for name, field in names().items():
        _, events = told(log(random, name, field), lambda: ROWS)
        assert kinds(events) == ["learned", "change"], name
        assert only(events, "learned")["interval_s"] == pytest.approx(WAIT, rel=1e-6), name


def kinds(events: list[dict[str, Any]]) -> list[str]:
    return [event["event"] for event in events]


LEAPS = {
    "a year ahead": pd.Timestamp("2027-03-02T00:00:00Z"),
    "a day ahead": BEGIN + pd.Timedelta(WAIT * ROWS + 86400, "s"),
    "the far future": pd.Timestamp("2200-01-01T00:00:00Z"),
    "an unset clock": pd.Timestamp("1970-01-01T00:00:05Z"),
    "1980": pd.Timestamp("1980-01-06T00:00:00Z"),
    "a day ago": BEGIN - pd.Timedelta("1D"),
}


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("leap", LEAPS)
def test_a_wrong_time_costs_one_row(
    leap: str, late: bool, random: np.random.Generator, tmp_path: Path
) -> None:
    """One row, or two in a row, of another date: the sensor learns and tells as without, and says so."""
    place = int(random.integers(3, CHANGE + 4) if late else random.integers(3))
    rows = log(random, "time", lambda time: time.isoformat())
    count = int(random.integers(1, 3))
    for row in range(place, place + count):
        rows[row]["time"] = (LEAPS[leap] + pd.Timedelta(WAIT * row, "s")).isoformat()
    done, events = three_ways(rows, random, tmp_path)
    assert all(row["corrected_distance_m"] is not None for row in done)
    learned, change = only(events, "learned"), only(events, "change")
    assert learned["interval_s"] == WAIT
    assert CHANGE < change["row"] < CHANGE + 20
    low, high = map(pd.Timestamp, change["since_interval"])
    assert low <= BEGIN + pd.Timedelta(WAIT * CHANGE, "s") <= high
    ignored = [event["rows"] for event in events if event["event"] == "ignored"]
    if late:
        assert ignored[-1] == count
        assert "clock" not in kinds(events)
    elif not (place == 0 and LEAPS[leap] < BEGIN):  # an early row before all others is one before a pause
        assert ignored or "clock" in kinds(events)
        assert not ignored or ignored[-1] <= count + place


@pytest.mark.parametrize("name", ["time_s", "time_ms", "time_us", "time_min", "time_h", "time"])
def test_a_clock_that_begins_again_is_told(name: str, random: np.random.Generator, tmp_path: Path) -> None:
    """A device restarts; its clock, too. A change after it is told by the new clock."""
    reboot = int(random.integers(20, CHANGE - 10))
    boots = (pd.Timestamp(0, tz="UTC"),) * 2 if name == "time" else (BEGIN, BEGIN)
    field = number(name, boots[0]) if name != "time" else (lambda time: time.isoformat())
    rows = log(random, name, field)
    late = pd.Timedelta(WAIT * reboot - int(random.integers(1, WAIT)), "s")
    for row in range(reboot, ROWS):
        time = BEGIN + pd.Timedelta(WAIT * row, "s") - late
        rows[row][name] = field(time) if name != "time" else pd.Timestamp((time - BEGIN).value).isoformat()
    _, events = three_ways(rows, random, tmp_path)
    clock, change = only(events, "clock"), only(events, "change")
    assert "it was set, or began again" in clock["sentence"]
    assert clock["row"] == reboot + 3
    assert CHANGE < change["row"] < CHANGE + 20
    seconds = (WAIT * CHANGE - late.total_seconds()) if name != "time" else None
    low, high = change["since_interval"]
    if seconds is None:
        at = pd.Timestamp(0, tz="UTC") + pd.Timedelta(WAIT * CHANGE, "s") - late
        assert pd.Timestamp(low) <= at <= pd.Timestamp(high)
    else:
        assert low - 1.0 <= seconds <= high + 1.0
    assert "ignored" not in kinds(events)


def test_a_clock_that_is_unset_for_a_while(random: np.random.Generator, tmp_path: Path) -> None:
    """After each of several restarts a device has no date for some rows, until it is told the time."""
    rows = log(random, "time", lambda time: time.isoformat())
    for begin in (20, 60, CHANGE - 4):
        for row in range(begin, begin + int(random.integers(4, 9))):
            rows[row]["time"] = pd.Timestamp(1_000_000_000 * WAIT * (row - begin + 1)).isoformat() + "+00:00"
    _, events = three_ways(rows, random, tmp_path)
    assert kinds(events).count("clock") == 6
    change = only(events, "change")
    assert CHANGE < change["row"] < CHANGE + 30
    assert "ignored" not in kinds(events)


def test_sensors_with_different_clocks_in_one_stream(random: np.random.Generator, tmp_path: Path) -> None:
    """One counts milliseconds, one has dates; with --by each is watched by its own clock."""
    one = log(random, "time_ms", number("time_ms", BOOT))
    other = log(random, "time", lambda time: time.isoformat())
    rows = [
        {"id": name, **row}
        for pair in zip(one, other, strict=True)
        for name, row in zip("ab", pair, strict=True)
    ]
    _, events = three_ways(rows, random, tmp_path, by="id")
    for sensor in "ab":
        own = [event for event in events if event["sensor"] == sensor]
        assert kinds(own) == ["learned", "change"]


def test_two_devices_taken_for_one_are_told(random: np.random.Generator, tmp_path: Path) -> None:
    rows = log(random, "time", lambda time: time.isoformat())
    for row in rows[1::2]:
        row["time"] = (pd.Timestamp(row["time"]) - pd.Timedelta("900D")).isoformat()
    _, events = three_ways(rows, random, tmp_path)
    ignored = [event for event in events if event["event"] == "ignored"]
    assert ignored[-1]["rows"] >= 64
    assert "by='COLUMN'" in ignored[-1]["sentence"]


def test_a_clock_that_stands_still_is_told(random: np.random.Generator, tmp_path: Path) -> None:
    rows = log(random, "time", lambda time: time.isoformat())
    for row in rows[CHANGE:]:
        row["time"] = rows[CHANGE]["time"]
    _, events = three_ways(rows, random, tmp_path)
    ignored = [event for event in events if event["event"] == "ignored"]
    assert ignored[-1]["rows"] == 32
    assert "stands still" in ignored[-1]["sentence"]


def test_a_pause_is_no_event(random: np.random.Generator, tmp_path: Path) -> None:
    rows = log(random, "time", lambda time: time.isoformat())
    for row in rows[int(random.integers(5, CHANGE)) :]:
        row["time"] = (pd.Timestamp(row["time"]) + pd.Timedelta("40D")).isoformat()
    _, events = three_ways(rows, random, tmp_path)
    assert kinds(events) == ["learned", "change"]


def test_rows_that_become_rare_are_tested(random: np.random.Generator, tmp_path: Path) -> None:
    """A logger saves its battery: a row a day in place of one an hour."""
    rows = log(random, "time", lambda time: time.isoformat())
    for place, row in enumerate(rows[60:]):
        row["time"] = (BEGIN + pd.Timedelta(WAIT * 60, "s") + pd.Timedelta(place, "D")).isoformat()
    _, events = three_ways(rows, random, tmp_path)
    assert kinds(events) == ["learned", "change"]
    assert only(events, "change")["row"] < CHANGE + 20
