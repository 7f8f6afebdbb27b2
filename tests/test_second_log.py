"""A reference from another log, at its own times."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app

START = pd.Timestamp("2024-05-01T00:00:00")
DEVICE = echocal.Model("linear", {"clock_error": {"frequency_error": 0.01}})
HEIGHT = 4.0


def water(seconds: np.ndarray) -> np.ndarray:
    """A tide with a second one on it [m]."""
    return 2.0 + 0.9 * np.sin(2 * np.pi * seconds / 44700) + 0.2 * np.sin(2 * np.pi * seconds / 22000 + 1.0)


def logs(seed: int, *, every: float = 360.0, scatter: float = 2e-3) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A sensor every ten minutes, and a tide gauge at other times, not sorted."""
    rng = np.random.default_rng(seed)
    seconds = 600.0 * np.arange(220) + rng.uniform(-20, 20, 220)
    temperature = 12 + 6 * np.sin(2 * np.pi * seconds / 86400) + rng.normal(0, 0.1, 220)
    reading = DEVICE.indicate(HEIGHT - water(seconds), temperature=temperature) + rng.normal(0, 2e-3, 220)
    sensor = pd.DataFrame(
        {
            "time": START + pd.to_timedelta(seconds.round(), unit="s"),
            "reading_m": reading.round(4),
            "temperature_C": temperature.round(2),
        }
    )
    own = np.arange(-1800.0, seconds[-1] + 1800.0, every)
    level = water(own) + rng.normal(0, scatter, len(own))
    gauge = pd.DataFrame({"When": START + pd.to_timedelta(own, unit="s"), "Stage": (level).round(4)})
    return sensor, gauge.sample(frac=1.0, random_state=seed)


COLUMNS = {"Stage": "reference_level_m", "When": "time"}


@pytest.mark.parametrize("kind", ["files", "tables"])
def test_the_reference_is_interpolated_and_its_uncertainty_is_told(tmp_path: Path, kind: str) -> None:
    sensor, gauge = logs(1)
    given: list[Any] = [sensor, gauge]
    if kind == "files":
        for name, table in (("sensor.csv", sensor), ("gauge.csv", gauge)):
            table.to_csv(tmp_path / name, index=False)
        given = [tmp_path / "sensor.csv", tmp_path / "gauge.csv"]
    read = echocal.read_observations(given[0], COLUMNS, reference=given[1], mount_height=HEIGHT)
    seconds = (sensor["time"] - START) / pd.Timedelta(seconds=1)
    assert read.reference_distance is not None
    off = read.reference_distance - (HEIGHT - water(seconds.to_numpy()))
    assert np.abs(off).max() < 0.01
    assert read.joined["reference_distance"].how == "interpolated"
    assert read.reference_join_uncertainty is not None
    assert off.std() < read.reference_join_uncertainty < 3e-3
    assert any("'Stage' has other times than the rows: interpolated in time" in note for note in read.notes)


def test_the_diagnosis_names_the_cause_and_tells_the_join() -> None:
    """6 draws: the clock is found with the reference of the other log as with one in the table."""
    for seed in range(6):
        sensor, gauge = logs(seed)
        found = echocal.diagnose(sensor, columns=COLUMNS, reference=gauge, mount_height=HEIGHT)
        ids = {id_ for one in found.causes for id_ in (one.id, *one.indistinguishable_from)}
        assert "clock_error" in ids
        assert any("makes up to" in note and "of the variance of the errors" in note for note in found.notes)


def test_the_uncertainty_covers_the_join_over_draws() -> None:
    """20 draws each of a coarse and a scattering gauge: the error of the join is not larger than told."""
    for every, scatter in ((360.0, 5e-3), (3600.0, 1e-4)):
        ratios = []
        for seed in range(20):
            sensor, gauge = logs(seed, every=every, scatter=scatter)
            read = echocal.read_observations(sensor, COLUMNS, reference=gauge, mount_height=HEIGHT)
            seconds = ((sensor["time"] - START) / pd.Timedelta(seconds=1)).to_numpy()
            assert read.reference_distance is not None
            assert read.reference_join_uncertainty
            off = read.reference_distance - (HEIGHT - water(seconds))
            ratios.append(float(np.nanstd(off)) / read.reference_join_uncertainty)
        assert max(ratios) < 1.1


def test_nearest_takes_values_as_they_are() -> None:
    sensor, gauge = logs(2)
    how = {"reference": gauge, "reference_join": "nearest", "mount_height": HEIGHT}
    read = echocal.read_observations(sensor, COLUMNS, **how)
    assert read.reference_distance is not None
    assert set(np.round(HEIGHT - read.reference_distance, 6)) <= set(gauge["Stage"].round(6))


def test_rows_without_a_near_value_are_counted() -> None:
    sensor, gauge = logs(3)
    gauge = gauge[gauge["When"] < sensor["time"].iloc[150]]
    with pytest.warns(echocal.DataWarning, match="Stage missing"):
        read = echocal.read_observations(sensor, COLUMNS, reference=gauge, mount_height=HEIGHT)
    assert read.usable[:149].all()
    assert not read.usable[155:].any()


@pytest.mark.parametrize(
    ("change", "how", "says"),
    [
        ({"sensor": ["time"]}, {}, "the table has no time, by which a reference is joined"),
        (
            {"gauge": ["Stage"]},
            {"columns": {"When": "time"}, "mount_height": None},
            "has no column of reference distances",
        ),
        ({"shift": "3000D"}, {}, "no row of the table has a value of 'Stage' near in time"),
        ({"count": True}, {"columns": {"When": "time_s", "Stage": "reference_level_m"}}, "no common zero"),
        ({"both": True}, {}, "the table has a reference distance, 'distance_m', and so has the reference"),
        ({}, {"reference_join": "linear"}, "interpolated or nearest"),
        ({}, {"columns": {**COLUMNS, "Tide": "ignore"}}, "no column 'Tide'"),
    ],
)
def test_what_cannot_be_joined_is_refused(change: dict[str, Any], how: dict[str, Any], says: str) -> None:
    sensor, gauge = logs(4)
    sensor, gauge = sensor.drop(columns=change.get("sensor", [])), gauge.drop(columns=change.get("gauge", []))
    if "shift" in change:
        gauge["When"] += pd.Timedelta(change["shift"])
    if "count" in change:
        gauge["When"] = np.arange(len(gauge)) * 60.0
    if "both" in change:
        sensor["distance_m"] = 2.0
    with pytest.raises((echocal.DataError, echocal.UsageError), match=says):
        echocal.read_observations(
            sensor, **{"columns": COLUMNS, "reference": gauge, "mount_height": HEIGHT, **how}
        )


def test_the_command_reads_the_other_log(tmp_path: Path) -> None:
    sensor, gauge = logs(5)
    sensor.to_csv(tmp_path / "sensor.csv", index=False)
    gauge.to_csv(tmp_path / "gauge.csv", index=False)
    arguments = ["diagnose", str(tmp_path / "sensor.csv"), "--reference", str(tmp_path / "gauge.csv")]
    arguments += ["--column", "Stage=reference_level_m", "--column", "When=time", "--mount-height", "4"]
    done = CliRunner().invoke(app, [*arguments, "--json", str(tmp_path / "d.json")])
    assert done.exit_code == 0, done.output
    assert "clock_error" in (tmp_path / "d.json").read_text()


def test_a_correction_leaves_out_what_is_said_of_the_other_log(tmp_path: Path) -> None:
    """The file of options of a diagnosis serves the correction, too."""
    sensor, _ = logs(6)
    sensor.to_csv(tmp_path / "sensor.csv", index=False)
    plain = echocal.correct(sensor, DEVICE).table["corrected_distance_m"]
    how = {"columns": COLUMNS, "reference": tmp_path / "gauge.csv", "mount_height": HEIGHT}
    assert echocal.correct(sensor, DEVICE, **how).table["corrected_distance_m"].equals(plain)
    echocal.correct_files(tmp_path / "sensor.csv", tmp_path / "out.csv", DEVICE, **how)
    written = pd.read_csv(tmp_path / "out.csv")["corrected_distance_m"]
    np.testing.assert_allclose(written, plain, rtol=0, atol=1e-8)
    with pytest.raises(echocal.UsageError, match="no column 'Stage'"):
        echocal.correct(sensor, DEVICE, columns=COLUMNS)
