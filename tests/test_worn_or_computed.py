"""A sensor that fails more and more often, and a table that nobody measured."""

import numpy as np
import pytest
from planted import ROWS, accepted, clean, search

import echocal


def lost(table: dict[str, np.ndarray], rows: np.ndarray) -> list[str]:
    table["reading_m"][rows] = np.nan
    return accepted(table)


@pytest.mark.statistical
def test_failures_that_grow_are_told_with_their_part(random: np.random.Generator) -> None:
    table = clean(random)
    u = np.arange(ROWS) / ROWS
    table["reading_m"][random.random(ROWS) < 0.5 * u] = np.nan
    (finding,) = [f for f in search(table)[1].accepted if f.cause == "degrading_sensor"]
    sizes = {p.name: p.value for p in finding.parameters}
    assert sizes["at_first"] < 0.15
    assert 0.3 < sizes["at_last"] < 0.7
    assert finding.rows is not None
    assert sizes["rows"] == finding.rows.sum() == np.isnan(table["reading_m"]).sum()


@pytest.mark.statistical
@pytest.mark.parametrize("case", ["even", "one outage", "far targets", "temperature missing"])
def test_other_failures_are_no_wear(case: str, random: np.random.Generator) -> None:
    """None of 120 tables drawn."""
    table = clean(random)
    if case == "temperature missing":
        table["temperature_C"][random.random(ROWS) < 0.5 * np.arange(ROWS) / ROWS] = np.nan
        assert "degrading_sensor" not in accepted(table)
        return
    if case == "far targets":  # a tank that empties
        noise = table["reading_m"] - table["distance_m"]
        table["distance_m"] = np.linspace(0.5, 3.9, ROWS) + 0.4 * np.sin(np.arange(ROWS) / 9)
        table["reading_m"] = table["distance_m"] + noise
    rows = {
        "even": random.random(ROWS) < 0.2,
        "one outage": np.arange(ROWS) // 40 == 8,
        "far targets": random.random(ROWS) < 1 / (1 + np.exp(-6 * (table["distance_m"] - 3.2))),
    }[case]
    assert "degrading_sensor" not in lost(table, rows)


@pytest.mark.statistical
def test_computed_readings_are_told_and_decide_no_verdict(random: np.random.Generator) -> None:
    table = clean(random)
    table["distance_m"] = random.uniform(0.4, 3.9, ROWS)
    table["reading_m"] = table["distance_m"].copy()
    diagnosis = echocal.diagnose(table)
    assert "computed_table" in {cause.id for cause in diagnosis.causes}
    assert diagnosis.verdict == "nothing"


@pytest.mark.statistical
@pytest.mark.parametrize("scatter", [1e-4, 3e-4, 1e-3])
def test_measured_readings_are_not(scatter: float, random: np.random.Generator) -> None:
    table = clean(random)
    table["reading_m"] = (table["distance_m"] + random.normal(0, scatter, ROWS)).round(4)
    assert "computed_table" not in accepted(table)


@pytest.mark.statistical
def test_coarse_readings_are_not(random: np.random.Generator) -> None:
    """Steps of 1 cm hide the scatter of a sensor."""
    table = clean(random)
    table["reading_m"] = table["reading_m"].round(2)
    assert "computed_table" not in accepted(table)
