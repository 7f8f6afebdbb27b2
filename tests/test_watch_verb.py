"""`echocal.watch` in Python: rows, lines and files give what the command gives."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.watch import Reference, WatchSettings

MODEL = echocal.Model("linear")
SETTINGS = WatchSettings(learn=100)
CONSTANT = Reference(constant=True)


@pytest.fixture
def rows(random: np.random.Generator) -> list[dict[str, Any]]:
    """A sensor whose readings jump by 8 mm."""
    reading = 1.0 + random.normal(0.0, 1e-3, 300) + 8e-3 * (np.arange(300) >= 200)
    celsius = 20.0 + 5.0 * np.sin(np.arange(300.0) / 7.0)
    return [
        {"time_s": 600.0 * place, "reading_m": float(one), "temperature_C": float(at)}
        for place, (one, at) in enumerate(zip(reading, celsius, strict=True))
    ]


def text(rows: list[dict[str, Any]]) -> str:
    return pd.DataFrame(rows).to_csv(index=False)


def all_of(found: Any) -> tuple[list[Any], list[dict[str, Any]]]:
    parts = list(found)
    return [row for own, _ in parts for row in own], [event.to_dict() for _, own in parts for event in own]


def test_rows_lines_and_a_file_give_the_same(rows: list[dict[str, Any]], tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(text(rows))
    how: dict[str, Any] = {"reference": Reference(distance=1.0), "settings": SETTINGS}
    corrected, events = all_of(echocal.watch(rows, MODEL, **how))
    assert "change" in {event["event"] for event in events}
    expected = echocal.correct(pd.DataFrame(rows), MODEL).table
    distances = [row["corrected_distance_m"] for row in corrected]
    assert distances == pytest.approx(expected["corrected_distance_m"].tolist(), abs=1e-9)
    for source in (tmp_path / "log.csv", str(tmp_path / "log.csv"), text(rows).splitlines()):
        again, told = all_of(echocal.watch(source, MODEL, **how))
        assert [row["corrected_distance_m"] for row in again] == pytest.approx(
            [row["corrected_distance_m"] for row in corrected], abs=1e-12
        )
        assert [(one["event"], one["row"]) for one in told] == [(one["event"], one["row"]) for one in events]


def test_each_row_comes_out_before_the_next_is_asked_for(rows: list[dict[str, Any]]) -> None:
    asked = []

    def coming() -> Iterator[dict[str, Any]]:
        for place, row in enumerate(rows[:5]):
            asked.append(place)
            yield row

    for place, (corrected, _) in enumerate(echocal.watch(coming(), MODEL, reference=CONSTANT)):
        assert len(corrected) == 1
        assert asked[-1] == place


def test_a_state_continues_a_file(rows: list[dict[str, Any]], tmp_path: Path) -> None:
    log, lines = tmp_path / "log.csv", text(rows).splitlines(keepends=True)
    how: dict[str, Any] = {
        "reference": Reference(distance=1.0),
        "settings": SETTINGS,
        "state": tmp_path / "watch.db",
    }
    log.write_text("".join(lines[:151]))
    first, events = all_of(echocal.watch(log, MODEL, **how))
    with log.open("a") as file:
        file.write("".join(lines[151:]))
    second, more = all_of(echocal.watch(log, MODEL, **how))
    assert (len(first), len(second)) == (150, 150)
    whole = all_of(echocal.watch(log, MODEL, **how | {"state": None}))[1]
    assert json.dumps([*events, *more]) == json.dumps(whole)


def test_a_line_that_is_no_row_is_told(rows: list[dict[str, Any]]) -> None:
    lines = text(rows[:9]).splitlines()
    lines.insert(4, lines[4] + ",more,than,the,header")
    corrected, events = all_of(echocal.watch(lines, MODEL, reference=CONSTANT))
    assert len(corrected) + sum(event["event"] == "note" for event in events) == 10


def test_what_is_refused(rows: list[dict[str, Any]]) -> None:
    for call, said in (
        (lambda: echocal.watch(pd.DataFrame(rows), MODEL), "to_dict"),
        (lambda: echocal.watch({"reading_m": [1.0]}, MODEL), "takes rows"),
        (lambda: echocal.watch(rows), "give one model"),
        (lambda: echocal.watch(rows, models="models"), "with `by`"),
        (lambda: echocal.watch(rows, "cramer"), "got 'cramer'"),
        (lambda: list(echocal.watch([1.0], MODEL)), "a row is a mapping"),
        (lambda: list(echocal.watch([], MODEL)), "no row has come"),
        (lambda: list(echocal.watch(rows, MODEL)), "no row has a reference distance"),
    ):
        with pytest.raises(echocal.EchocalError, match=said):
            call()
    with pytest.raises(TypeError, match="did you mean 'missing'"):
        echocal.watch(rows, MODEL, mising=[-1])
