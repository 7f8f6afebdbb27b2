"""Tables as they are, in every function that takes observations; keywords that a function does not have."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import xarray as xr

import echocal
from echocal import Model, UsageError
from echocal.correct import correct_table

MPE = {"maximum_permissible_error": 3e-3}
MODEL = Model("linear", {"zero_error": {"offset": 8e-3}})
KINDS: list[Callable[[dict[str, Any]], Any]] = [dict, pd.DataFrame, pl.DataFrame]


@pytest.fixture
def rows(random: np.random.Generator) -> dict[str, np.ndarray]:
    distance = np.tile([0.5, 1.0, 2.0], 20)
    celsius = random.uniform(5.0, 35.0, 60)
    device = Model("linear", {"zero_error": {"offset": 8e-3}})
    reading = device.indicate(distance, temperature=celsius) + random.normal(0.0, 1e-4, 60)
    return {"reading_m": reading, "temperature_C": celsius, "distance_m": distance}


def expected(rows: dict[str, np.ndarray]) -> pd.DataFrame:
    found: pd.DataFrame = echocal.correct(pd.DataFrame(rows), MODEL).table
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_a_table_is_as_good_as_observations(kind: Callable[..., Any], rows: dict[str, np.ndarray]) -> None:
    table, read = kind(rows), echocal.read_observations(rows)
    given = echocal.calibrate(table, Model("linear"), ["zero_error"])
    as_read = echocal.calibrate(read, Model("linear"), ["zero_error"])
    assert given.to_dict() == as_read.to_dict()
    assert given["zero_error.offset"].value == pytest.approx(8e-3, abs=1e-4)
    assert not echocal.verify(table, **MPE).passed
    assert echocal.verify(table, model=given.model, **MPE).passed
    assert echocal.verify(table, **MPE) == echocal.verify(read, **MPE)


@pytest.mark.parametrize("kind", KINDS)
def test_a_corrected_table_is_of_the_same_kind(kind: Callable[..., Any], rows: dict[str, np.ndarray]) -> None:
    rows["reading_m"][5] = np.nan
    table = kind(rows)
    found = correct_table(table, Model("linear", {"zero_error": {"offset": 8e-3}}))
    assert isinstance(found.table, pd.DataFrame if kind is dict else type(table))
    assert found.rows == 60
    corrected = np.asarray(found.table["corrected_distance_m"])
    assert np.isnan(corrected[5])
    assert np.nanmax(np.abs(corrected - rows["distance_m"])) < 1e-3
    assert found.table["status"][5] == "reading_m missing"
    assert "corrected_distance_m" not in table


def test_a_table_of_arrow_stays_one(rows: dict[str, np.ndarray]) -> None:
    table = pa.table(rows).replace_schema_metadata({"site": "tank 7"})
    for given in (table, table.to_batches()[0]):
        found = echocal.correct(given, MODEL).table
        assert type(found) is type(given)
        assert found.select(given.column_names).equals(given)
        assert found.schema.metadata == {b"site": b"tank 7"}
        np.testing.assert_array_equal(found["corrected_distance_m"], expected(rows)["corrected_distance_m"])
        assert found["status"].to_pylist() == [""] * 60


def test_a_lazy_frame_stays_lazy_and_the_uncertainty_narrow(rows: dict[str, np.ndarray]) -> None:
    found = echocal.correct(pl.LazyFrame(rows), MODEL).table
    assert isinstance(found, pl.LazyFrame)
    done = found.collect()
    assert done["distance_standard_uncertainty_m"].dtype == pl.Float32
    np.testing.assert_array_equal(done["corrected_distance_m"], expected(rows)["corrected_distance_m"])


def test_a_dataset_keeps_dimensions_coordinates_and_attributes(rows: dict[str, np.ndarray]) -> None:
    """Some variables have one dimension of two, in another order; each value stays at its place."""
    reading, celsius = rows["reading_m"].reshape(4, 15), rows["temperature_C"][:15]
    data = xr.Dataset(
        {"temperature_C": ("b", celsius, {"units": "degC"}), "reading_m": (("a", "b"), reading)},
        coords={"a": [3, 1, 2, 0]},
        attrs={"site": "tank 7"},
    )
    found = echocal.correct(data, MODEL).table
    assert isinstance(found, xr.Dataset)
    assert found.attrs == data.attrs
    xr.testing.assert_identical(found[list(data)], data)
    own = found["corrected_distance_m"]
    assert own.attrs["units"] == "m"
    flat = {"reading_m": reading.ravel(), "temperature_C": np.tile(celsius, 4)}
    np.testing.assert_array_equal(
        own.transpose("a", "b"), expected(flat)["corrected_distance_m"].to_numpy().reshape(4, 15)
    )
    array = data["reading_m"].T.assign_coords(temperature_C=("b", celsius))
    of_array = echocal.correct(array, MODEL).table
    xr.testing.assert_equal(
        of_array["corrected_distance_m"].transpose("a", "b"),
        own.transpose("a", "b").assign_coords(temperature_C=("b", celsius)),
    )


def test_a_table_is_read_as_the_keywords_say(rows: dict[str, np.ndarray]) -> None:
    other = {"R": rows["reading_m"], "T": rows["temperature_C"], "D": rows["distance_m"]}
    columns = {"R": "reading_m", "T": "temperature_C", "D": "distance_m"}
    named = echocal.calibrate(other, Model("linear"), ["zero_error"], columns=columns)
    as_they_are = echocal.calibrate(rows, Model("linear"), ["zero_error"])
    assert named.to_dict() == as_they_are.to_dict()
    assert echocal.verify(other, columns=columns, **MPE) == echocal.verify(rows, **MPE)


def test_readings_were_made_with_the_law_of_the_model(rows: dict[str, np.ndarray]) -> None:
    slow = {**rows, "reading_m": rows["distance_m"] * 343.0 / (331.4 + 0.6 * rows["temperature_C"])}
    found = echocal.verify(slow, model=Model("343"), **MPE)
    assert found == echocal.verify(slow, model=Model("343"), reading_speed="343", **MPE)
    assert found != echocal.verify(slow, model=Model("343"), reading_speed="linear", **MPE)


CALLS: dict[str, tuple[Callable[[Any], object], str]] = {
    "diagnose": (lambda t: echocal.diagnose(t, refrence_distance=2.0), "reference_distance"),
    "diagnose_many": (lambda t: echocal.diagnose_many({"a": t, "b": t}, sede=1), "seed"),
    "calibrate": (lambda t: echocal.calibrate(t, Model("linear"), ["zero_error"], los="huber"), "loss"),
    "verify": (lambda t: echocal.verify(t, modle=Model("linear"), **MPE), "model"),
    "correct": (lambda t: echocal.correct(t, Model("linear"), mising=[-1]), "missing"),
}


@pytest.mark.parametrize("function", CALLS)
def test_an_unknown_keyword_is_refused_by_the_function_called(
    function: str, rows: dict[str, np.ndarray]
) -> None:
    call, near = CALLS[function]
    with pytest.raises(TypeError, match=rf"^{function}\(\) got .*; did you mean '{near}'\?$"):
        call(rows)


def test_what_is_no_table_is_refused(rows: dict[str, np.ndarray]) -> None:
    model = Model("linear")
    calls: list[Callable[[], object]] = [
        lambda: echocal.verify(7, **MPE),
        lambda: echocal.calibrate(7, model, ["zero_error"]),
        lambda: echocal.correct(7, model),
    ]
    for call in calls:
        with pytest.raises(UsageError, match="int"):
            call()


def test_a_log_is_corrected_as_it_is_read(tmp_path: Path) -> None:
    """The same columns by name and unit, options and reasons as `read_observations` has."""
    log = tmp_path / "log.csv"
    log.write_text("logger 7\nDistance (cm);Luft (°C)\n100,5;20\n-1;20\n99,5;20;3\n", encoding="cp1252")
    how: dict[str, Any] = {"skip_lines": 1, "columns": {"Luft (°C)": "temperature_C"}, "missing": [-1]}
    found = echocal.correct(log, Model("linear", {"zero_error": {"offset": 5e-3}}), **how)
    assert found.table["corrected_distance_m"].round(6).tolist()[0] == 1.0
    with pytest.warns(echocal.DataWarning):
        read = echocal.read_observations(log, **how)
    assert found.table["status"].tolist() == read.unusable.tolist()
    assert [note for note in found.notes if note.startswith("read by name and unit: 'Distance (cm)'")]
    bare = {"reading_m": [1.0, 1.1]}
    stated = echocal.correct(bare, Model("linear"), at={"temperature": "20+-2"})
    assert stated.table.equals(
        echocal.correct(
            {**bare, "temperature_C": [20, 20]}, Model("linear"), uncertainties={"temperature_C": 2}
        ).table.drop(columns="temperature_C")
    )


def test_a_diagnosis_corrects_a_table(rows: dict[str, np.ndarray]) -> None:
    diagnosis = echocal.diagnose(rows)
    later = pd.DataFrame({"Distance (mm)": 1e3 * rows["reading_m"], "Temp (°C)": rows["temperature_C"]})
    found = diagnosis.correct(later)
    assert found.table.equals(echocal.correct(later, diagnosis.model).table)
    assert np.abs(found.table["corrected_distance_m"] - rows["distance_m"]).max() < 1e-3
    of_numbers = diagnosis.correct(later["Distance (mm)"] / 1e3, temperature=later["Temp (°C)"])
    np.testing.assert_allclose(of_numbers.value, found.table["corrected_distance_m"], atol=1e-4)
