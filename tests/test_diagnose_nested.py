"""The gain is of rows that neither the choice nor the fit of the causes has seen."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal import Diagnosis

Table = dict[str, np.ndarray]


def logged(random: np.random.Generator, rows: int = 600) -> Table:
    """A target at 1.5 m whose device ignores the temperature, a row a minute."""
    seconds = 60.0 * np.arange(rows)
    celsius = 15.0 + 8.0 * np.sin(seconds / 8e3) + random.normal(0.0, 0.1, rows)
    reading = 1.5 * 343.0 / (331.4 + 0.6 * celsius) + random.normal(0.0, 5e-4, rows)
    distance = np.full(rows, 1.5)
    return {"time_s": seconds, "reading_m": reading, "temperature_C": celsius, "distance_m": distance}


def chosen(diagnosis: Diagnosis) -> tuple[object, ...]:
    """Everything that rows may choose."""
    told = [c for c in diagnosis.causes if c.kind == "effect"]
    kept = [cause.id for cause in told if cause.in_model or cause.doubt]  # or withheld, as later rows say
    claimed = sorted({*kept, *(refuted.id for refuted in diagnosis.refuted)})
    noises = [(c.id, c.probability) for c in diagnosis.causes if c.kind == "noise"]
    return diagnosis.posterior, diagnosis.credible_set, diagnosis.noise, claimed, noises


@pytest.mark.statistical
@pytest.mark.parametrize("known", [True, False])
def test_nothing_sees_the_rows_that_a_user_holds_out(known: bool, random: np.random.Generator) -> None:
    table = logged(random)
    if not known:
        del table["distance_m"]
    later = table["time_s"] >= 24_000.0
    first = echocal.diagnose(table, constant_distance=not known, hold_out_after=24_000.0)
    corrupted = {name: column.copy() for name, column in table.items()}
    corrupted["reading_m"][later] *= 1.0 + random.normal(0.0, 0.05, later.sum())
    corrupted["temperature_C"][later] += random.normal(2.0, 3.0, later.sum())
    if known:
        corrupted["distance_m"][later] += random.normal(0.0, 0.1, later.sum())
    corrupted["temperature_C"][-1] = np.nan
    with pytest.warns(echocal.DataWarning):
        second = echocal.diagnose(corrupted, constant_distance=not known, hold_out_after=24_000.0)
    assert chosen(first) == chosen(second)
    assert first.verdict == "named"
    assert first.gain.held_out_rows == 200
    assert first.gain.rms_after_m < 0.1 * first.gain.rms_before_m
    assert second.gain.rms_before_m > 0.01 + first.gain.rms_before_m  # they do judge


def test_held_out_rows_that_cannot_judge_are_told_apart(random: np.random.Generator) -> None:
    table = logged(random)
    table["reading_m"][405:] = np.nan
    with (
        pytest.warns(echocal.DataWarning),
        pytest.raises(echocal.DataError, match="rows held out from 24000"),
    ):
        echocal.diagnose(table, hold_out_after=24_000.0)


def test_counts_of_rows_add_up_where_some_are_held_out(random: np.random.Generator) -> None:
    table = logged(random)
    table["reading_m"][[10, 550]] = np.nan
    with pytest.warns(echocal.DataWarning):
        diagnosis = echocal.diagnose(table, hold_out_after=24_000.0)
    rows = diagnosis.rows
    assert rows["used"] + sum(rows["unusable"].values()) == rows["total"] == 600
    assert rows["unusable"] == {"reading_m missing": 2}
    assert diagnosis.traces.held_out.sum() == 199
    assert (np.diff(diagnosis.traces.row) > 0).all()


def test_a_rate_of_change_ends_before_the_held_out_rows(random: np.random.Generator) -> None:
    from echocal.diagnose.preprocess.hold_out import split

    table = logged(random)
    observations = echocal.read_observations(table)
    seen, held = split(observations, 24_000.0, 8)
    alone = echocal.read_observations({name: column[:400] for name, column in table.items()})
    assert held is not None
    for name, column in alone.conditions.items():
        np.testing.assert_array_equal(seen.conditions[name][:400], column)
        assert np.isnan(seen.conditions[name][400:]).all()
        assert np.isnan(held.conditions[name][:400]).all()


@pytest.mark.statistical
@pytest.mark.slow
def test_where_nothing_is_planted_no_gain_is_told(random: np.random.Generator) -> None:
    """A choice that each fold makes by itself has no gain of chance; each table here is without an effect."""
    gains = []
    for _ in range(30):
        rows = 60
        celsius = random.uniform(5.0, 30.0, rows)
        distance = np.repeat([0.5, 1.0, 2.0], 20)
        reading = distance + random.normal(0.0, 1e-3, rows)
        table = {"reading_m": reading, "temperature_C": celsius, "distance_m": distance}
        gain = echocal.diagnose(table, base="linear").gain
        gains.append(gain.variance_removed)
        assert gain.rms_after_m <= gain.rms_before_m
        assert gain.scheme.startswith("nested")
    assert np.mean(gains) < 0.01


@pytest.mark.statistical
def test_a_size_beyond_reason_is_not_named(random: np.random.Generator) -> None:
    """A clock that is 9 % off: no clock is, so something else may act."""
    distance = np.tile([0.5, 1.0, 1.5, 2.0, 2.5, 3.0], 20)
    reading = 1.0 * distance + random.normal(0.0, 5e-4, len(distance))
    reading = reading * 1.09
    table = {"reading_m": reading, "distance_m": distance, "temperature_C": np.full(len(distance), 20.0)}
    diagnosis = echocal.diagnose(table, base="linear")
    large = [cause for cause in diagnosis.causes if cause.doubt]
    assert large, diagnosis.explain()
    assert "times the usual one" in large[0].doubt
    assert diagnosis.verdict == "ambiguous"


@pytest.mark.statistical
def test_columns_that_cross_are_not_exchanged(random: np.random.Generator) -> None:
    """A day on which temperature and humidity have the same number twice, and change their roughness."""
    table = logged(random)
    phase = np.linspace(0.0, 2.0 * np.pi, 600)
    rough = np.where(np.arange(600) < 300, 0.05, 0.6)
    table["temperature_C"] = 30.0 + 6.0 * np.sin(phase) + random.normal(0.0, 1.0, 600) * rough
    table["humidity_percent"] = 30.0 - 6.0 * np.sin(phase) + random.normal(0.0, 1.0, 600) * rough[::-1]
    diagnosis = echocal.diagnose(table)
    assert "swapped_columns" not in {cause.id for cause in diagnosis.causes}


def test_the_terminal_says_what_the_share_is_of(random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(logged(random))
    gain = diagnosis.gain
    low, high = gain.variance_removed_interval_95
    assert low <= gain.variance_removed <= high
    of_folds = "If each fold also chooses the causes without these rows"
    assert of_folds in diagnosis.explain() or "The choice of the folds is no worse" in diagnosis.explain()
    assert diagnosis.to_dict()["gain"]["variance_removed"] == pytest.approx(gain.variance_removed)


def test_every_row_has_a_fate(
    random: np.random.Generator, tmp_path: Path, run: Callable[..., tuple[int, str]]
) -> None:
    table = logged(random)
    table["reading_m"][10] = np.nan
    table["reading_m"][20] = 4.0
    table["temperature_C"][30] = 85.0
    data, out = tmp_path / "data.csv", tmp_path / "rows.csv"
    pd.DataFrame(table).to_csv(data, index=False)
    with pytest.warns(echocal.DataWarning):
        diagnosis = echocal.diagnose(data, hold_out_after=24_000.0)
    rows = diagnosis.row_table()
    assert rows["row"].tolist() == list(range(1, 601))
    assert rows["fate"].iloc[[10, 30]].tolist() == ["reading_m missing", "reset_temperature"]
    assert rows["fate"].iloc[20] not in ("used", "held out")
    assert (rows["fate"] == "used").sum() == 397
    assert (rows["fate"].iloc[400:] == "held out").all()
    assert rows["error_before_mm"].notna().sum() == diagnosis.rows["used"] == 597
    assert run("diagnose", str(data), "--rows", str(out), "-q") == (0, "")
    written = pd.read_csv(out)
    assert written.columns.tolist() == ["row", "fate", "error_before_mm", "error_after_mm"]
    assert (written["fate"].iloc[400:] == "used").all()


@pytest.mark.statistical
def test_a_fault_that_begins_before_the_held_out_rows_is_repaired_there(random: np.random.Generator) -> None:
    table = logged(random)
    table["humidity_percent"] = 60.0 + 5.0 * np.cos(table["time_s"] / 5e3) + random.normal(0.0, 1.0, 600)
    warm, humid = table["temperature_C"].copy(), table["humidity_percent"].copy()
    table["temperature_C"][200:], table["humidity_percent"][200:] = humid[200:], warm[200:]
    diagnosis = echocal.diagnose(table, hold_out_after=24_000.0)
    assert "swapped_columns" in {cause.id for cause in diagnosis.causes}
    assert diagnosis.gain.rms_after_m < 0.1 * diagnosis.gain.rms_before_m


@pytest.mark.statistical
def test_a_unit_that_a_fault_explains_is_no_reason_to_refuse(random: np.random.Generator) -> None:
    table = logged(random)
    table["reading_m"] *= 1e3
    diagnosis = echocal.diagnose(table, hold_out_after=24_000.0)
    assert {"unit_mixup", "fixed_speed"} <= {cause.id for cause in diagnosis.causes}


@pytest.mark.statistical
def test_the_newest_row_may_come_first(random: np.random.Generator) -> None:
    table = logged(random)
    del table["distance_m"]
    table["reading_m"][200:] += 0.3
    gains = [
        echocal.diagnose(one, constant_distance=True, hold_out_after=24_000.0).gain
        for one in (table, {name: column[::-1].copy() for name, column in table.items()})
    ]
    assert gains[1].rms_before_m == pytest.approx(gains[0].rms_before_m)
    kept = [gain.rms_after_m for gain in gains if gain.rms_after_m != gain.rms_before_m]
    # Of 300 draws 3 differ by more, up to 4.5 mm: another set of effects is selected. Two more differ by
    # 2 um. Why was not looked for in these draws. What is asked is less than these rows can show: the
    # standard error of an RMS.
    standard_error = 5e-4 / np.sqrt(2 * 200)
    assert kept == pytest.approx(kept[:1] * len(kept), abs=standard_error), "one may keep the base"


@pytest.mark.statistical
def test_a_target_that_is_placed_anew_has_a_new_level(random: np.random.Generator) -> None:
    """Five placements whose distances nobody measured: each level is free, and rows of each judge."""
    table = logged(random)
    del table["distance_m"]
    table["stand"] = np.repeat([3, 1, 4, 5, 9], 120)
    table["reading_m"] *= np.repeat([1.0, 1.3, 0.8, 1.6, 1.1], 120)
    diagnosis = echocal.diagnose(table, constant_distance=True)
    assert "fixed_speed" in {cause.id for cause in diagnosis.causes}
    assert diagnosis.gain.held_out_rows == 600
    assert diagnosis.gain.rms_after_m < 0.3 * diagnosis.gain.rms_before_m < 0.02


def test_held_out_rows_of_a_new_placement_do_not_have_the_level_of_the_last_one(
    random: np.random.Generator,
) -> None:
    table = logged(random)
    del table["distance_m"]
    anew = table["time_s"] >= 24_000.0
    table["reading_m"] = table["reading_m"] * np.where(anew, 1.2, 1.0)
    table["stand"] = np.where(anew, 2, 1)
    told, untold = (
        echocal.diagnose(one, constant_distance=True, hold_out_after=24_000.0).gain.rms_before_m
        for one in (table, {name: column for name, column in table.items() if name != "stand"})
    )
    assert told < 0.05 < untold


def test_errors_are_compared_on_the_rows_that_both_models_know() -> None:
    from echocal.diagnose.validation.gain import HeldOut, on_common_rows

    one, other = HeldOut(np.array([9.0, 1.0, 1.0, np.nan])), HeldOut(np.array([np.nan, 2.0, 2.0, 5.0]))
    assert [held.rms for held in on_common_rows(one, other)] == [1.0, 2.0]
    assert np.isnan(HeldOut(np.array([np.nan])).rms)
