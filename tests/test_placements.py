"""Placements without a column for them: runs of a ruler value, and the plateaus of a raw log."""

import warnings
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.diagnose.preprocess.plateaus import BETWEEN, placed

DELAY = 85e-6
LATE = echocal.Model("linear", {"fixed_delay": {"delay": DELAY}})
PLACES = (0.3, 0.6, 1.0, 1.5, 2.0, 2.5)
SAME = {"fixed_delay", "zero_error"}  # at room temperature, the two differ by a few tenths of a millimeter


def row_values(true: float, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Echo times [us] of a placement, and temperatures."""
    temperature = 21 + rng.normal(0, 0.3) + rng.normal(0, 0.1, count)
    reading = LATE.indicate(np.full(count, true), temperature=temperature) + rng.normal(0, 1e-3, count)
    echo = echocal.Model("linear").time_of_flight(reading, temperature=temperature)
    return np.round(1e6 * echo), temperature.round(1)


def ruler_table(visits: list[float], each: int, seed: int) -> dict[str, Any]:
    """Rows at a tape; each placement is 1 mm off by chance."""
    rng = np.random.default_rng(seed)
    table: dict[str, list[float]] = {"echo_us": [], "temperature_C": [], "distance_m": []}
    for place in visits:
        echo, temperature = row_values(place + rng.normal(0, 1e-3), each, rng)
        table["echo_us"] += echo.tolist()
        table["temperature_C"] += temperature.tolist()
        table["distance_m"] += [place] * each
    return table


@pytest.mark.parametrize(
    ("visits", "each"),
    [
        (list(PLACES), 20),
        ([*PLACES, *PLACES], 3),
        ([2.5, 0.3, 2.0, 0.6, 1.5, 1.0, 2.5, 0.3, 2.0, 0.6, 1.5, 1.0], 10),
    ],
    ids=["once", "twice, three rows each", "far and near in turn"],
)
def test_a_delay_is_found_and_corrected_without_a_column_of_placements(
    visits: list[float], each: int
) -> None:
    """15 of 15 draws: a run of equal distance is a placement."""
    found = corrected = 0
    at, warm = np.array([0.4, 1.2, 2.4]), np.full(3, 21.0)
    for seed in range(15):
        with warnings.catch_warnings(action="ignore"):
            diagnosis = echocal.diagnose(ruler_table(visits, each, seed))
        first = diagnosis.causes[0]
        found += diagnosis.verdict == "named" and bool(SAME & {first.id, *first.indistinguishable_from})
        error = diagnosis.model.correct(LATE.indicate(at, temperature=warm), temperature=warm) - at
        corrected += bool(np.abs(error).max() < 2e-3)  # of 14.6 mm
    assert (found, corrected) == (15, 15)


def raw_log(seed: int, places: tuple[float, ...] = (0.5, 1.2, 2.5, 0.9), each: int = 60) -> dict[str, Any]:
    """A log that runs on while the target is carried from one place to the next."""
    rng = np.random.default_rng(seed)
    echo, temperature = [], []
    for number, place in enumerate(places):
        if number:
            way = np.linspace(places[number - 1], place, int(rng.integers(4, 12)))[1:-1]
            for one in way:
                own = row_values(float(one) + rng.normal(0, 0.02), 1, rng)
                echo += own[0].tolist()
                temperature += own[1].tolist()
        own = row_values(place + rng.normal(0, 0.5e-3), each + int(rng.integers(-15, 15)), rng)
        echo += own[0].tolist()
        temperature += own[1].tolist()
    return {"time_s": 0.2 * np.arange(len(echo)), "echo_us": echo, "temperature_C": temperature}


def test_the_plateaus_of_a_raw_log_take_the_values_of_the_ruler() -> None:
    """15 draws: all plateaus are found, and the delay is corrected."""
    good = 0
    at, warm = np.array([0.6, 1.2, 2.2]), np.full(3, 21.0)
    for seed in range(15):
        log = raw_log(seed)
        with warnings.catch_warnings(action="ignore"):
            diagnosis = echocal.diagnose(log, placements=[0.5, 1.2, 2.5, 0.9])
        assert any("placements by the plateaus of the log: 0.5 m, rows 1 to" in n for n in diagnosis.notes)
        error = diagnosis.model.correct(LATE.indicate(at, temperature=warm), temperature=warm) - at
        good += bool(np.abs(error).max() < 2e-3)
    assert good == 15


@pytest.mark.parametrize(
    ("count", "each", "carried"), [(5, 15, (2, 6)), (8, 25, (3, 15)), (8, 200, (20, 60))]
)
def test_plateaus_are_found_beside_hands_and_wild_rows(
    count: int, each: int, carried: tuple[int, int]
) -> None:
    """40 draws: while the target is carried, the hand is nearer; 1 % of the rows are wild."""
    good = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        places = [float(rng.uniform(0.2, 3.0))]
        while len(places) < count:
            place = float(rng.uniform(0.2, 3.0))
            places += [place] if abs(place - places[-1]) > 0.05 else []
        rows: list[float] = []
        for number, place in enumerate(places):
            if number:
                way = np.linspace(places[number - 1], place, int(rng.integers(*carried)))
                way = way + rng.normal(0, 0.02, len(way))
                rows += np.where(rng.random(len(way)) < 0.3, rng.uniform(0.1, 0.4, len(way)), way).tolist()
            stay = place + rng.normal(0, 2e-3, int(each * rng.uniform(0.7, 1.3)))
            rows += (stay + np.where(rng.random(len(stay)) < 0.01, rng.normal(0, 0.5, len(stay)), 0)).tolist()
        log = {"reading_m": 0.05 + np.abs(rows), "temperature_C": np.full(len(rows), 20.0)}
        read = placed(echocal.read_observations(log, reading_speed=343), places)
        assert read.reference_distance is not None
        assert read.reading is not None
        off, stand = read.reading - 0.05 - read.reference_distance, read.labels["stand"]
        good += all(abs(np.median(off[stand == number])) < 3e-3 for number in range(count))
    assert good == 40


@pytest.mark.parametrize(
    ("placements", "how", "says"),
    [
        ([0.5, 1.2, 2.5], {}, r"lists 3 distances, and the log has 4 plateaus .*rows 1 to \d+ at 0\.51"),
        (
            [0.5, 2.5, 1.2, 0.9],
            {},
            "says 0.9 m for plateau 4 and 1.2 m for plateau 3, .* the first is farther|order",
        ),
        ([0.5, 1.2, -2.5, 0.9], {}, "reference distance is -2.5 m"),
        ([0.5, 1.2, 2.5, 0.9], {"constant_distance": True}, "only one of them"),
    ],
)
def test_what_does_not_fit_the_log_is_refused(
    placements: list[float], how: dict[str, Any], says: str
) -> None:
    with pytest.raises((echocal.DataError, echocal.UsageError), match=says):
        echocal.diagnose(raw_log(3), placements=placements, **how)


def test_a_table_with_distances_takes_no_placements() -> None:
    table = ruler_table(list(PLACES), 20, 1)
    with pytest.raises(echocal.UsageError, match="column 'distance_m' has some"):
        echocal.diagnose(table, placements=[1.0])


def test_the_command_takes_placements(tmp_path: Any) -> None:
    import pandas as pd

    pd.DataFrame(raw_log(4)).to_csv(tmp_path / "log.csv", index=False)
    arguments = ["diagnose", str(tmp_path / "log.csv"), "--placements"]
    done = CliRunner().invoke(app, [*arguments, "0.5,1.2,2.5,0.9", "--rows", str(tmp_path / "rows.csv")])
    assert done.exit_code == 0, done.output
    assert BETWEEN in (tmp_path / "rows.csv").read_text()
    wrong = CliRunner().invoke(app, [*arguments, "0.5;1.2"])
    assert "with commas between them" in str(wrong.exception)


def test_placements_may_be_a_text() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        text, listed = (
            echocal.diagnose(raw_log(2), placements=given).to_dict()
            for given in ("0.5,1.2, 2.5,0.9", [0.5, 1.2, 2.5, 0.9])
        )
    assert (text["verdict"], text["causes"]) == (listed["verdict"], listed["causes"])


@pytest.mark.parametrize(
    ("given", "says"), [("0.5;1.2", "with commas between them"), ("50,120,250,90", "(120 cm is 1.2 m)")]
)
def test_a_text_that_lists_no_meters_is_refused(given: str, says: str) -> None:
    with pytest.raises(echocal.UsageError) as refused:
        echocal.diagnose(raw_log(2), placements=given)
    assert says in str(refused.value)
