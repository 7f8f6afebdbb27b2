"""`echocal watch` of levels: the same corrections as `echocal correct`, and changes as of the distances."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from watched import START, WAIT, temperatures

import echocal
from echocal.errors import UsageError
from echocal.watch import Reference
from echocal.watch.home_assistant import discovery

Run = Callable[..., tuple[int, str]]
HEIGHT = 2.6
LATE = echocal.Model("linear", {"fixed_delay": {"delay": 85e-6}})
TO_A_LEVEL = ["--column", "Lvl=level_m", "--mount-height", "2.60"]
GAUGE = ["--column", "gauge=reference_level_m"]


def tank(random: np.random.Generator, rows: int, error: Any = 0.0) -> pd.DataFrame:
    """A tank with a late device, whose readings have an error [m], and a gauge."""
    temperature = temperatures(random, rows)
    level = 0.9 + 0.7 * np.sin(np.arange(rows) / 17 + random.uniform(0, 6)) + random.normal(0, 0.05, rows)
    reading = LATE.indicate(HEIGHT - level, temperature=temperature) + error + random.normal(0, 1e-3, rows)
    times = START + np.arange(rows) * np.timedelta64(int(WAIT), "s")
    return pd.DataFrame(
        {
            "time": [f"{one}Z" for one in times],
            "Lvl": (HEIGHT - reading).round(5),
            "gauge": level.round(5),
            "temperature_C": temperature.round(2),
        }
    )


@pytest.mark.parametrize("height", ["stated", "of the model", "fitted"])
def test_a_level_is_corrected_as_by_correct(
    height: str, run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    table = tank(random, 60)
    table.loc[7, "Lvl"] = HEIGHT + 0.1  # above the sensor
    table.to_csv(tmp_path / "log.csv", index=False)
    words = TO_A_LEVEL
    model = LATE
    if height != "stated":
        other = tank(random, 60)
        given = {"mount_height": HEIGHT} if height == "of the model" else {}
        if not given:
            other["distance_m"] = HEIGHT - 0.012 - other["gauge"]
        named = {"Lvl": "level_m", "gauge": "reference_level_m" if given else "ignore"}
        model = echocal.diagnose(other, columns=named, **given).model
        words = TO_A_LEVEL[:2]
    model.save(tmp_path / "model.json")
    asked = ["log.csv", "--model", "model.json", *words]
    code, said = run("correct", *asked, "-o", "corrected.csv", "--column", "gauge=ignore")
    assert code == 0, said
    code, said = run("watch", *asked, "--correct-only", "--once", "-o", "w.csv", "--column", "gauge=ignore")
    assert code == 0, said
    corrected, watched = (pd.read_csv(tmp_path / name) for name in ("corrected.csv", "w.csv"))
    names = ["corrected_level_m", "distance_standard_uncertainty_m", "status"]
    pd.testing.assert_frame_equal(watched[names], corrected[names])
    assert "corrected_distance_m" not in watched
    assert watched["corrected_level_m"].notna().sum() == 59


def test_a_change_of_a_level_is_that_of_its_distance(random: np.random.Generator) -> None:
    """A step of 30 mm after 700 rows: the events are those of the same log in distances."""
    table = tank(random, 760, np.where(np.arange(760) < 700, 0.0, 0.03))
    distances = table.assign(reading_m=HEIGHT - table["Lvl"], distance_m=HEIGHT - table["gauge"])
    distances = distances.drop(columns=["Lvl", "gauge"])
    meant = {"Lvl": "level_m", "gauge": "reference_level_m"}
    told = []
    for log, given in ((table, {"columns": meant, "mount_height": HEIGHT}), (distances, {})):
        batches = echocal.watch(iter(log.to_dict("records")), LATE, reference=Reference(), **given)
        told.append([(e.kind, e.row, e.details.get("since")) for _, events in batches for e in events])
    assert any(kind == "change" for kind, *_ in told[0])
    assert told[0] == told[1]


def test_a_column_that_is_called_a_level_needs_the_height_alone(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    table = tank(random, 20).rename(columns={"Lvl": "level_m"}).drop(columns="gauge")
    table.to_csv(tmp_path / "log.csv", index=False)
    LATE.save(tmp_path / "model.json")
    asked = ["log.csv", "--model", "model.json", "--mount-height", "2.60"]
    assert run("correct", *asked, "-o", "corrected.csv")[0] == 0
    assert run("watch", *asked, "--correct-only", "--once", "-o", "watched.csv")[0] == 0
    corrected, watched = (pd.read_csv(tmp_path / f"{name}.csv") for name in ("corrected", "watched"))
    first = corrected.columns[-4]
    assert first in watched
    pd.testing.assert_series_equal(watched[first], corrected[first])


def test_a_height_without_a_level_is_refused() -> None:
    rows = iter([{"time_s": 0, "reading_m": 1.0, "temperature_C": 20.0}])
    with pytest.raises(UsageError, match="is for a column that holds a level"):
        list(echocal.watch(rows, LATE, reference=Reference(correct_only=True), mount_height=HEIGHT))


def test_home_assistant_gets_a_level() -> None:
    _, payload = discovery("tank", "tank", first="corrected_level_m")
    level = payload["components"]["level"]
    assert level["value_template"] == "{{ value_json.corrected_level_m }}"
    assert level["name"] == "Level"
    assert "distance" not in payload["components"]
