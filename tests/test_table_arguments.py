"""Tables as they are, in every function that takes observations; keywords that a function does not have."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest

import echocal
from echocal import Model, UsageError
from echocal.correct import correct_table

MPE = {"maximum_permissible_error": 3e-3}
KINDS: list[Callable[[dict[str, Any]], Any]] = [dict, pd.DataFrame, pl.DataFrame]


@pytest.fixture
def rows(random: np.random.Generator) -> dict[str, np.ndarray]:
    distance = np.tile([0.5, 1.0, 2.0], 20)
    celsius = random.uniform(5.0, 35.0, 60)
    device = Model("linear", {"zero_error": {"offset": 8e-3}})
    reading = device.indicate(distance, temperature=celsius) + random.normal(0.0, 1e-4, 60)
    return {"reading_m": reading, "temperature_C": celsius, "distance_m": distance}


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
    "correct_table": (lambda t: correct_table(t, Model("linear"), mising=[-1]), "missing"),
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
    for call in (lambda: echocal.verify(7, **MPE), lambda: echocal.calibrate(7, model, ["zero_error"])):
        with pytest.raises(UsageError, match="int"):
            call()
    with pytest.raises(UsageError, match="in memory"):
        correct_table("log.csv", model)
