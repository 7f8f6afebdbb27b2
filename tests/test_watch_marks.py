"""A watch corrects as `echocal correct` does: the same distances, uncertainties, reasons and marks."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from planted import clean
from test_correct_marks import BY_INSTANT, LEFT_OUT

import echocal
from echocal.correct import correct_table
from echocal.correct.needed import context_of
from echocal.correct.results import DISTANCE, STATUS, UNCERTAINTY
from echocal.diagnose.faults.common.fault import Fault
from echocal.watch import Fleet, Reference, State, WatchSettings

Run = Callable[..., tuple[int, str]]

RESULTS = [DISTANCE, UNCERTAINTY, STATUS]

pytestmark = pytest.mark.filterwarnings("ignore::echocal.DataWarning", "ignore::echocal.DomainWarning")


def ghosts(random: np.random.Generator, path: Path, *, known: bool) -> tuple[pd.DataFrame, echocal.Model]:
    """New rows with 12 late echoes, and a model whose diagnosis has seen others."""

    def table() -> pd.DataFrame:
        row = np.arange(800)
        level = 2.0 + 0.1 * np.sin(row / 60.0)
        found = pd.DataFrame(clean(random)).iloc[:0]
        found["time"] = (np.datetime64("2026-01-01T00:00:00") + row * np.timedelta64(600, "s")).astype(str)
        found["temperature_C"] = 14.0 + 9.0 * np.sin(row / 40.0) + random.normal(0.0, 0.1, 800)
        found["reading_m"] = level + random.normal(0.0, 1e-3, 800)
        late = random.choice(800, 12, replace=False)
        found.loc[late, "reading_m"] *= random.uniform(0.3, 0.8, 12)
        found["late"] = np.isin(row, late)
        found["distance_m"] = level
        return found.drop(columns=["humidity_percent", "time_s", *([] if known else ["distance_m"])])

    first = table().drop(columns="late")
    diagnosis = echocal.diagnose(first, constant_distance=not known)
    diagnosis.model.save(path / "model.json")
    return table(), echocal.Model.load(path / "model.json")


def read(path: Path) -> pd.DataFrame:
    return pd.read_csv(
        path, dtype={STATUS: str}, keep_default_na=False, na_values={DISTANCE: "", UNCERTAINTY: ""}
    )


@pytest.mark.statistical
@pytest.mark.parametrize("known", [True, False])
def test_ghosts_are_marked_as_by_correct(
    known: bool, run: Run, random: np.random.Generator, tmp_path: Path
) -> None:
    """In one file, in pieces with a stop after each, and from row to row."""
    table, model = ghosts(random, tmp_path, known=known)
    late = table.pop("late").to_numpy()
    table.to_csv(tmp_path / "log.csv", index=False)
    assert run("correct", "log.csv", "--model", "model.json", "-o", "corrected.csv", "--quiet")[0] == 0
    corrected = read(tmp_path / "corrected.csv")[RESULTS]
    assert (corrected[STATUS][late] == "crosstalk").sum() >= 10
    words = ["--model", "model.json", "--correct-only", "--once"]
    assert run("watch", "log.csv", *words, "-o", "whole.csv")[0] == 0
    whole = read(tmp_path / "whole.csv")
    assert whole.columns.tolist() == [*table.columns, *RESULTS]
    pd.testing.assert_frame_equal(whole[RESULTS], corrected)
    lines = (tmp_path / "log.csv").read_text().splitlines(keepends=True)
    cuts = sorted({1, len(lines), *random.integers(2, len(lines), 4).tolist()})
    for cut in cuts:
        (tmp_path / "growing.csv").write_text("".join(lines[:cut]))
        assert run("watch", "growing.csv", *words, "-o", "pieces.csv", "--state", "s.db")[0] == 0
        if cut > 1:  # at each stop the rows so far are as `correct` has them
            so_far = correct_table(table.iloc[: cut - 1], model).table[RESULTS]
            pieces = read(tmp_path / "pieces.csv")
            assert pieces[STATUS].tolist() == so_far[STATUS].tolist()
            assert np.allclose(pieces[DISTANCE], so_far[DISTANCE], rtol=0.0, atol=1e-9, equal_nan=True)
    pd.testing.assert_frame_equal(read(tmp_path / "pieces.csv"), whole)
    assert known or context_of(model) > 0  # without a reference, marks look at the rows around


def by_fleet(
    table: pd.DataFrame, model: echocal.Model, size: Callable[[], int], state: Path | None, **more: Any
) -> tuple[pd.DataFrame, list[dict[str, Any]]]:
    """Corrected rows and events; with a file for the state each piece begins anew."""

    def fleet() -> Fleet:
        settings = WatchSettings(learn=100, fewest=10**6)
        reference = more.get("reference", Reference(correct_only=True))
        return Fleet(lambda _: model, None, reference, settings, State(state))

    rows = table.to_dict("records")
    watch, done, events = fleet(), [], []
    first = 0
    while first < len(rows):
        last = first + size()
        own, news = watch.take(rows[first:last])
        watch.state.commit()
        done, events, first = done + own, events + news, last
        if state is not None:
            watch.state.close()
            watch = fleet()
    own, news = watch.finish()
    return pd.DataFrame([*done, *own]), [event.to_dict() for event in (*events, *news)]


@pytest.mark.parametrize("fault", LEFT_OUT, ids=lambda fault: fault.facts.id)
def test_every_rule_marks_the_rows_that_correct_marks(
    fault: Fault, random: np.random.Generator, tmp_path: Path
) -> None:
    plain = clean(random)
    fault.spoil(plain, random)
    if fault.facts.id in BY_INSTANT:
        elapsed = plain.pop("time_s").astype("timedelta64[s]")
        plain = {**plain, "time": (np.datetime64("2024-03-20T06:00:00") + elapsed).astype(str)}
    model = echocal.diagnose(plain).model.transferable()
    table = pd.DataFrame(plain)
    corrected = correct_table(table, model).table[RESULTS]
    assert (corrected[STATUS] == fault.facts.id).any()
    for size, state in (
        (lambda: len(table), None),
        (lambda: int(random.integers(1, 90)), tmp_path / "s.db"),
        (lambda: 1, None),
    ):
        found, _ = by_fleet(table, model, size, state)
        assert found[STATUS].tolist() == corrected[STATUS].tolist()
        for name in (DISTANCE, UNCERTAINTY):
            own = found[name].astype(float)
            assert np.allclose(own, corrected[name].astype(float), rtol=1e-6, atol=1e-9, equal_nan=True)


@pytest.mark.statistical
def test_marked_rows_are_not_tested(random: np.random.Generator, tmp_path: Path) -> None:
    """What is learned is the noise of the other rows, and late echoes are no change."""
    table, model = ghosts(random, tmp_path, known=True)
    late = table.pop("late").to_numpy()
    _, events = by_fleet(table, model, lambda: 50, None, reference=Reference())
    (learned,) = [event for event in events if event["event"] == "learned"]
    marked = late[: learned["row"]].sum()
    assert learned["row"] == 100 + marked
    assert learned["standard_deviation_m"] == pytest.approx(1e-3, rel=0.3)
    assert "change" not in {event["event"] for event in events}


def test_a_rule_that_needs_a_column_is_told(run: Run, random: np.random.Generator, tmp_path: Path) -> None:
    """The diagnosis found late echoes by the reference distance, and the new rows have none."""
    table, _ = ghosts(random, tmp_path, known=True)
    table.drop(columns=["late", "distance_m"]).to_csv(tmp_path / "log.csv", index=False)
    words = ["log.csv", "--model", "model.json", "--correct-only", "--once", "--json", "events.jsonl"]
    assert run("watch", *words)[0] == 0
    assert "not checked: crosstalk" in (tmp_path / "events.jsonl").read_text()


def test_a_row_that_waits_is_told_and_can_come_at_once(
    run: Run, random: np.random.Generator, tmp_path: Path
) -> None:
    table, _ = ghosts(random, tmp_path, known=False)
    table.drop(columns="late").to_csv(tmp_path / "log.csv", index=False)
    words = ["log.csv", "--model", "model.json", "--correct-only", "--once", "--json", "events.jsonl"]
    words += ["-o", "out.csv"]
    assert run("watch", *words)[0] == 0
    assert "look at 6 rows before and after" in (tmp_path / "events.jsonl").read_text()
    assert run("watch", *words, "--no-mark-rows")[0] == 0
    assert "look at" not in (tmp_path / "events.jsonl").read_text()
    assert set(read(tmp_path / "out.csv")[STATUS]) == {""}


def test_the_reasons_are_those_of_correct(run: Run, random: np.random.Generator, tmp_path: Path) -> None:
    """Every kind of damage, a column that the model does not read, and stated uncertainties."""
    table = pd.DataFrame(clean(random)).astype(object)
    damage = [
        ("reading_m", ""),
        ("reading_m", "n/a"),
        ("reading_m", "far"),
        ("reading_m", -1.0),
        ("reading_m", 1e6),
        ("temperature_C", "warm"),
        ("temperature_C", ""),
        ("temperature_C", 900.0),
        ("humidity_percent", ""),
        ("humidity_percent", "?"),
        ("time_s", ""),
        ("distance_m", ""),
    ]
    places = random.choice(len(table), len(damage), replace=False)
    for place, (name, value) in zip(places.tolist(), damage, strict=True):
        table.loc[place, name] = value
    table.loc[places[0], "temperature_C"] = "cold"  # two faults
    table.to_csv(tmp_path / "log.csv", index=False)
    shared = ["--law", "linear", "--uncertainty", "temperature_C=0.5", "--uncertainty", "reading_mm=2"]
    assert run("correct", "log.csv", *shared, "-o", "corrected.csv", "--quiet") == (0, "")
    assert run("watch", "log.csv", *shared, "--correct-only", "--once", "-o", "watched.csv")[0] == 0
    corrected, watched = read(tmp_path / "corrected.csv"), read(tmp_path / "watched.csv")
    assert watched[STATUS].tolist() == corrected[STATUS].tolist()
    assert len(set(watched[STATUS])) == 7, set(watched[STATUS])
    pd.testing.assert_frame_equal(watched[RESULTS], corrected[RESULTS])
    assert watched[UNCERTAINTY].notna().sum() > 380
