"""A date in pieces, one column each, is one time."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal

TIMES = pd.date_range("2024-02-28T22:30:00", periods=40, freq="11min7s")


def pieces(names: dict[str, str]) -> dict[str, Any]:
    held = {
        "year": TIMES.year, "month": TIMES.month, "day": TIMES.day, "hour": TIMES.hour,
        "minute": TIMES.minute, "second": TIMES.second, "doy": TIMES.day_of_year,
    }  # fmt: skip
    table = {own: np.asarray(held[piece]) for piece, own in names.items()}
    return {
        **table,
        "reading_m": np.linspace(1.0, 2.0, len(TIMES)),
        "temperature_C": np.full(len(TIMES), 20.0),
    }


@pytest.mark.parametrize(
    "names",
    [
        {name: name for name in ("year", "month", "day", "hour", "minute", "second")},
        {"year": "YYYY", "month": "Mo", "day": "DD", "hour": "HH", "minute": "mi", "second": "SS"},
        {"year": "Year", "doy": "DOY", "hour": "Hour", "minute": "Min", "second": "Sec"},
    ],
)
@pytest.mark.parametrize("kind", ["csv", "parquet", "table"])
def test_the_pieces_are_one_time(tmp_path: Path, names: dict[str, str], kind: str) -> None:
    table: Any = pd.DataFrame(pieces(names))
    if kind != "table":
        path = tmp_path / f"log.{kind}"
        table.to_csv(path, index=False) if kind == "csv" else table.to_parquet(path)
        table = path
    read = echocal.read_observations(table, reading_speed=343)
    assert read.time is not None
    assert (read.time == TIMES.to_numpy().astype("datetime64[ns]")).all()
    assert not read.extra
    assert any("are read together as time" in note for note in read.notes)


HHMM = np.asarray(TIMES.hour * 100 + TIMES.minute)
HOURS = np.asarray(TIMES.hour + TIMES.minute / 60 + TIMES.second / 3600)
DAYS = np.asarray(TIMES.day_of_year) + HOURS / 24


@pytest.mark.parametrize(
    ("columns", "step"),
    [
        ({"Year_RTM": TIMES.year, "Day_RTM": TIMES.day_of_year, "Hour_Minute_RTM": HHMM}, "min"),
        ({"year": TIMES.year, "doy": TIMES.day_of_year, "time": HHMM}, "min"),
        ({"year": TIMES.year, "month": TIMES.month, "day": TIMES.day, "hour": HHMM}, "min"),
        ({"year": TIMES.year, "doy": TIMES.day_of_year, "hour": HHMM, "second": TIMES.second}, "s"),
        ({"year": TIMES.year, "month": TIMES.month, "day": TIMES.day, "hour": HOURS.round(6)}, "s"),
        ({"Year": TIMES.year, "Julian Day": DAYS.round(7)}, "s"),
    ],
    ids=["campbell", "time", "hour", "second", "decimal hours", "decimal days"],
)
def test_the_time_of_day_may_be_one_number(columns: dict[str, Any], step: str) -> None:
    """1345 is a quarter to two, as Campbell loggers write it, and 13.75 is, too."""
    held = {name: np.asarray(own) for name, own in columns.items()}
    read = echocal.read_observations({**held, **pieces({})}, reading_speed=343)
    assert read.time is not None
    expected = TIMES.floor(step).to_numpy().astype("datetime64[ns]")
    assert np.abs((read.time - expected) / np.timedelta64(1, "ms")).max() < 20
    assert not read.extra


def test_a_piece_that_is_missing_or_impossible_is_a_row_without_time() -> None:
    table = pd.DataFrame(pieces({name: name for name in ("year", "month", "day", "hour")}))
    table["day"] = table["day"].astype(float)
    table.loc[3, "day"] = np.nan
    table.loc[5, "month"] = 13
    with pytest.warns(echocal.DataWarning, match="2 of 40 rows cannot be used: 2 time missing"):
        read = echocal.read_observations(table, reading_speed=343)
    assert np.flatnonzero(~read.usable).tolist() == [3, 5]


def test_hours_and_minutes_that_no_clock_shows_are_a_row_without_time() -> None:
    """1375 is not 14:15, and 2561 is not the next day."""
    table = pd.DataFrame({**pieces({name: name for name in ("year", "doy")}), "HHMM": HHMM})
    table.loc[4, "HHMM"], table.loc[9, "HHMM"] = 1375, 2561
    with pytest.warns(echocal.DataWarning, match="2 of 40 rows cannot be used: 2 time missing"):
        read = echocal.read_observations(table, reading_speed=343)
    assert np.flatnonzero(~read.usable).tolist() == [4, 9]


@pytest.mark.parametrize("kind", ["csv", "table"])
def test_hours_and_minutes_are_joined_to_their_date(tmp_path: Path, kind: str) -> None:
    table: Any = pd.DataFrame({"date": TIMES.strftime("%Y-%m-%d"), "HHMM": HHMM, **pieces({})})
    table.loc[4, "HHMM"] = 1375
    table.loc[7, "date"] = None
    if kind == "csv":
        table.to_csv(tmp_path / "log.csv", index=False)
        table = tmp_path / "log.csv"
    with pytest.warns(echocal.DataWarning, match="2 of 40 rows cannot be used: 2 time missing"):
        read = echocal.read_observations(table, reading_speed=343)
    assert read.time is not None
    expected = TIMES.floor("min").to_numpy().astype("datetime64[ns]")
    assert (np.delete(read.time, [4, 7]) == np.delete(expected, [4, 7])).all()
    assert not read.extra


@pytest.mark.parametrize("form", ["%d %B %Y", "%Y-%m-%d %H:%M"])
def test_a_date_that_has_a_time_or_is_in_words_is_not_joined(form: str) -> None:
    table = {"date": TIMES.strftime(form), "HHMM": HHMM, **pieces({})}
    read = echocal.read_observations(table, reading_speed=343)
    assert "HHMM" in read.extra


def test_a_time_of_numbers_beside_a_date_tells_both_ways_out() -> None:
    table = {"date": TIMES.strftime("%Y-%m-%d"), "time": HHMM, **pieces({})}
    with pytest.raises(
        echocal.DataError, match=r"rename it to its unit: time_s, .*1345, beside a date: HHMM"
    ):
        echocal.read_observations(table, reading_speed=343)


@pytest.mark.parametrize("change", [{"month": 40}, {"year": 7}])
def test_columns_of_these_names_that_hold_something_else_stay(change: dict[str, int]) -> None:
    table = {
        **pieces({name: name for name in ("year", "month", "day")}),
        **{k: np.full(40, v) for k, v in change.items()},
    }
    read = echocal.read_observations(table, reading_speed=343)
    assert read.time is None
    assert {"year", "month", "day"} <= {*read.extra}


def test_a_column_of_times_is_not_touched() -> None:
    table = {**pieces({name: name for name in ("year", "month", "day")}), "time": TIMES[::-1]}
    read = echocal.read_observations(table, reading_speed=343)
    assert read.time is not None
    assert read.time[0] == TIMES[-1].to_datetime64()
