"""Further thermometers of a table: how they are read, and the causes that read one of them."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_table

ROWS = 800
BOX = "temperature_box_C"


@pytest.fixture(scope="module")
def log(request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]) -> pd.DataFrame:
    """Five days at 2 m, every ten minutes: air, a box that the sun warms, and a thermometer of no use."""
    random = seeded(request)
    time = 600.0 * np.arange(ROWS)
    air = 15.0 + 6.0 * np.sin(2 * np.pi * time / 86400.0) + np.cumsum(random.normal(0.0, 0.05, ROWS))
    sun = np.clip(np.sin(2 * np.pi * (time - 9000.0) / 86400.0), 0.0, None)
    box = air + 2.0 + 3.0 * sun + np.cumsum(random.normal(0.0, 0.03, ROWS))
    return pd.DataFrame(
        {
            "time_s": time,
            "distance_m": 2.0,
            "temperature_C": air,
            BOX: box,
            "temperature_other_C": air + random.normal(0.0, 1.0, ROWS),
            "reading_m": 2.0 + random.normal(0.0, 1e-3, ROWS),
        }
    )


def speed(celsius: pd.Series) -> pd.Series:
    """The linear law."""
    return 331.4 + 0.6 * celsius


def mixed(log: pd.DataFrame) -> pd.DataFrame:
    """The path is 40 % of the way to the box."""
    air = log["temperature_C"]
    return log.assign(reading_m=log["reading_m"] * speed(air) / speed(air + 0.4 * (log[BOX] - air)))


def compensated(log: pd.DataFrame) -> pd.DataFrame:
    """The ranger compensates with a thermometer that is 40 % of the way to the box, by the root of kelvin.

    By the linear law the share would be larger by 0.6 / 340.4 to 0.5 / 288, which is 1.6 % or two standard
    uncertainties.
    """
    kelvin = log["temperature_C"] + 273.15
    inside = kelvin + 0.4 * (log[BOX] - log["temperature_C"])
    return log.assign(reading_m=log["reading_m"] * np.sqrt(inside / kelvin))


@pytest.fixture(scope="module")
def found(log: pd.DataFrame) -> echocal.Diagnosis:
    return echocal.diagnose(mixed(log))


def size(diagnosis: echocal.Diagnosis, id_: str) -> tuple[float, float]:
    """A size and its standard uncertainty from the rows; what all rows share is not in it."""
    (cause,) = (c for c in diagnosis.causes if c.id == id_)
    size = cause.parameters[0]
    uncertainty = diagnosis.model.standard_uncertainties[f"{id_}.{size.name}"]
    assert uncertainty is not None
    return size.value, uncertainty


def test_a_name_a_request_and_a_phrase_are_thermometers() -> None:
    table = {
        "echo_us": [11660.0] * 3,
        "temperature_C": [20.0] * 3,
        "temperature_box_C": [21.0, np.nan, 23.0],
        "temperature_hut_F": [68.0, 69.8, 71.6],
        "panel": [294.15, 295.15, 296.15],
        "water": [4.0, 999.0, 6.0],
        "thermometer_7": [1.0, 2.0, 3.0],
    }
    data = echocal.read_observations(
        table, {"panel": "thermometer_K", "water": "further thermometer in degC"}
    )
    assert data.usable.all()  # no row is lost for want of a thermometer that nothing needs yet
    read = {name: np.round(column, 9).tolist() for name, column in data.thermometers.items()}
    assert read["temperature_hut_F"] == [20.0, 21.0, 22.0]
    assert read["panel"] == [21.0, 22.0, 23.0]
    np.testing.assert_array_equal(read["temperature_box_C"], [21.0, np.nan, 23.0])
    np.testing.assert_array_equal(read["water"], [4.0, np.nan, 6.0])
    assert (
        "water is outside -95 to 150 degC in 1 row, first at row 2; it counts as missing there" in data.notes
    )
    assert "thermometer_7" not in data.thermometers
    assert set(data.extra) == {*data.thermometers, "thermometer_7"}  # each as it was written
    assert data.extra["panel"].tolist() == table["panel"]


@pytest.mark.parametrize("known", [{}, {"constant_distance": True}], ids=["known", "constant"])
def test_the_path_between_two_thermometers(log: pd.DataFrame, known: dict[str, bool]) -> None:
    diagnosis = echocal.diagnose(mixed(log), **known)  # type: ignore[arg-type]
    assert diagnosis.verdict == "named"
    value, uncertainty = size(diagnosis, "thermometer_mix")
    assert abs(value - 0.4) < 4 * uncertainty < 0.1
    assert diagnosis.model.columns == {"second_temperature": BOX}
    assert diagnosis.causes[0].because.endswith(f"the further thermometer is the column {BOX}")


def test_a_ranger_that_is_as_warm_as_its_box(log: pd.DataFrame) -> None:
    diagnosis = echocal.diagnose(compensated(log))
    value, uncertainty = size(diagnosis, "internal_thermometer")
    assert abs(value - 0.4) < 4 * uncertainty < 0.1
    assert diagnosis.model.columns == {"device_temperature": BOX}


def test_recorded_echo_times_know_no_internal_thermometer(log: pd.DataFrame) -> None:
    table = compensated(log)
    table = table.assign(echo_us=2e6 * table["reading_m"] / speed(table["temperature_C"]))
    diagnosis = echocal.diagnose(table.drop(columns="reading_m"))
    assert not [ids for ids, _ in diagnosis.posterior if "internal_thermometer" in ids]


def test_a_model_reads_its_own_column(found: echocal.Diagnosis, log: pd.DataFrame, tmp_path: Path) -> None:
    found.model.save(tmp_path / "model.json")
    assert json.loads((tmp_path / "model.json").read_text())["columns"] == {"second_temperature": BOX}
    model = echocal.Model.load(tmp_path / "model.json")
    assert (model.columns, model.hash) == (found.model.columns, found.model.hash)
    table = mixed(log)
    corrected = correct_table(table, model).table["corrected_distance_m"]
    assert (corrected - 2.0).std() < 1.1e-3 < (table["reading_m"] - 2.0).std()
    other = table.assign(**{"temperature_other_C": 99.0})
    assert (correct_table(other, model).table["corrected_distance_m"] == corrected).all()
    gap = table.assign(**{BOX: table[BOX].where(table.index != 5)})
    assert correct_table(gap, model).unusable == {f"{BOX} missing": 1}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"columns": BOX}, "has other thermometers (temperature_other_C): rename the one that is meant"),
        (
            {"columns": [BOX, "temperature_other_C"]},
            f"has no further thermometer: record it in a column '{BOX}'",
        ),
        ({"requests": {BOX: "extra"}}, f"columns={{'{BOX}': 'thermometer_C'}}"),
    ],
)
def test_a_table_without_the_column_is_refused(
    found: echocal.Diagnosis, log: pd.DataFrame, change: dict[str, object], says: str
) -> None:
    with pytest.raises(echocal.DataError) as refused:
        correct_table(
            log.drop(columns=change.get("columns", [])),
            found.model,
            change.get("requests"),  # type: ignore[arg-type]
        )
    assert f"reads second_temperature from the column '{BOX}'" in str(refused.value)
    assert says in str(refused.value)


def test_a_column_with_a_gap_is_left_out_with_its_reason(log: pd.DataFrame) -> None:
    table = mixed(log)
    diagnosis = echocal.diagnose(table.assign(**{BOX: table[BOX].where(table.index != 5)}))
    note = f"no cause was tried with these further thermometers: {BOX} (no value in 1 of {ROWS} rows)"
    assert note in diagnosis.notes
    assert diagnosis.model.columns.get("second_temperature") != BOX


@pytest.mark.statistical
def test_of_many_thermometers_the_right_one_is_among_those_tried(
    log: pd.DataFrame, random: np.random.Generator
) -> None:
    table = mixed(log)
    more = {f"temperature_{n}_C": log["temperature_C"] + random.normal(0.0, 1.0, ROWS) for n in range(20)}
    diagnosis = echocal.diagnose(table.assign(**more))
    assert diagnosis.model.columns == {"second_temperature": BOX}
    (note,) = (n for n in diagnosis.notes if n.startswith("no cause was tried with these further"))
    assert note.endswith("and 6 more")  # 22, 8 of them tried, 8 listed


@pytest.mark.statistical
def test_thermometers_of_noise_make_no_model_worse(random: np.random.Generator) -> None:
    rows = 400
    time, distance = 60.0 * np.arange(rows), np.repeat(random.permutation([0.5, 1.0, 1.5, 2.0, 3.0]), 80)
    air = 20.0 + 8.0 * np.sin(time / 6000.0)
    table = {
        "time_s": time,
        "distance_m": distance,
        "temperature_C": air,
        "reading_m": distance + 0.6 * 172e-6 * 30.0 + random.normal(0.0, 1.5e-3, rows),
    }
    noise = {
        "temperature_a_C": air + random.normal(0.0, 1.0, rows),
        "temperature_b_C": air + 3.0 * np.sin(time / 3000.0),
        "temperature_c_C": 20.0 + np.cumsum(random.normal(0.0, 0.2, rows)),
    }
    alone, beside = echocal.diagnose(table), echocal.diagnose({**table, **noise})
    assert not beside.model.columns
    assert beside.gain is not None
    assert alone.gain is not None
    assert beside.gain.rms_after_m <= alone.gain.rms_after_m * 1.02
    assert {c.id for c in beside.causes} == {c.id for c in alone.causes}


def test_a_calibration_reads_the_only_thermometer(log: pd.DataFrame) -> None:
    data = echocal.read_observations(mixed(log).drop(columns="temperature_other_C"))
    fitted = echocal.calibrate(data, echocal.Model("linear"), fit=["thermometer_mix"])
    assert isinstance(fitted.model, echocal.Model)
    assert fitted.model.columns == {"second_temperature": BOX}
    assert fitted["thermometer_mix.weight"].value == pytest.approx(0.4, abs=0.05)


def test_a_calibration_asks_which_of_several(log: pd.DataFrame) -> None:
    data = echocal.read_observations(mixed(log))
    with pytest.raises(echocal.DataError, match=r"Model\(columns=\{'second_temperature'"):
        echocal.calibrate(data, echocal.Model("linear"), fit=["thermometer_mix"])
    named = echocal.Model("linear", columns={"second_temperature": BOX})
    fitted = echocal.calibrate(data, named, fit=["thermometer_mix"])
    assert fitted["thermometer_mix.weight"].value == pytest.approx(0.4, abs=0.05)


def test_a_model_without_such_an_effect_says_nothing_of_columns() -> None:
    plain = echocal.Model("linear", {"zero_error": {"offset": 1e-3}})
    named = echocal.Model("linear", plain.effects, columns={"second_temperature": BOX})
    assert named.columns == {}
    assert named.hash == plain.hash
    with pytest.raises(echocal.ModelError, match="second_temperature or device_temperature"):
        echocal.Model("linear", columns={"temperature": BOX})


def test_a_base_with_a_further_thermometer_is_refused(found: echocal.Diagnosis, log: pd.DataFrame) -> None:
    with pytest.raises(echocal.UsageError, match="which no base does"):
        echocal.diagnose(log, base=found.model)
