"""Targets that differ by the levels of a column."""

import numpy as np
import pytest
from planted import clean

import echocal
from echocal.diagnose.findings.facts import Columns
from echocal.diagnose.findings.parts import Cause

ID = "target_geometry"


def targets(random: np.random.Generator, levels: int, sd: float, rho: float = 0.0) -> Columns:
    """Targets in turn, at any distance; the offset of each is drawn with a standard deviation [m]."""
    table = clean(random)
    rows = len(table["reading_m"])
    error = np.zeros(rows)
    for at in range(1, rows):
        error[at] = rho * error[at - 1] + random.normal(0.0, 1e-3 * rho)
    target = random.integers(0, levels, rows)
    table["target"] = target.astype(np.float64)
    table["reading_m"] += error + random.normal(0.0, sd, levels)[target]
    return table


def named(diagnosis: echocal.Diagnosis) -> dict[str, Cause]:
    return {cause.id: cause for cause in diagnosis.causes}


def as_text(table: Columns, column: str) -> dict[str, np.ndarray]:
    """The same, the targets by name."""
    names = np.array(["pole", "wall", "crate", "door", "plate", "board", "car", "tank"])
    found: dict[str, np.ndarray] = {name: values for name, values in table.items() if name != "target"}
    return {**found, column: names[table["target"].astype(np.int64)]}


@pytest.mark.statistical
@pytest.mark.parametrize("column", ["target", "stand", "surface"])
def test_it_is_found_by_numbers_by_stand_and_by_text(random: np.random.Generator, column: str) -> None:
    """Found in 60 of 60 tables drawn."""
    table = targets(random, 8, 1e-2)
    given = table if column == "target" else as_text(table, column)
    found = named(echocal.diagnose(given))
    cause = found[ID]
    assert f"'{column}'" in cause.because
    values = {p.name: p.value for p in cause.parameters}
    means = [
        float(np.mean((table["reading_m"] - table["distance_m"])[table["target"] == k])) for k in range(8)
    ]
    assert values["levels"] == 8
    if "cycle_offset" not in found:  # by chance, 8 offsets may be near a lattice
        assert values["standard_deviation"] == pytest.approx(np.std(means, ddof=1), rel=0.05)


@pytest.mark.statistical
@pytest.mark.parametrize("levels", [2, 5, 20])
@pytest.mark.parametrize("rho", [0.0, 0.6, 0.95])
def test_levels_without_a_meaning_have_none(random: np.random.Generator, levels: int, rho: float) -> None:
    """None of 224 tables drawn."""
    assert ID not in named(echocal.diagnose(targets(random, levels, 0.0, rho)))


@pytest.mark.statistical
def test_where_each_has_one_distance_it_is_an_error_of_the_reference(random: np.random.Generator) -> None:
    table = targets(random, 8, 5e-3)
    distance = (0.5 + 0.4 * table["target"]).round(3)
    table["reading_m"] += distance - table["distance_m"]
    table["distance_m"] = distance
    found = named(echocal.diagnose(table))
    assert ID not in found
    assert "reference_error" in found


@pytest.mark.statistical
def test_no_other_cause_is_made_of_the_offsets_and_none_is_lost(random: np.random.Generator) -> None:
    table = targets(random, 8, 1e-2)
    table["reading_m"] *= 1.01
    diagnosis = echocal.diagnose(table)
    found = named(diagnosis)
    assert ID in found
    assert "reference_error" not in found
    scale = diagnosis.model.correct(np.array([1.0, 3.0]), temperature=14.0, relative_humidity=0.55)
    assert np.diff(scale)[0] == pytest.approx(2.0 / 1.01, abs=5e-3)


@pytest.mark.statistical
def test_a_model_is_no_worse_on_targets_that_nobody_saw(random: np.random.Generator) -> None:
    """The model has no offset: neither of the targets seen nor of those that are not."""
    table = targets(random, 8, 1e-2)
    table["reading_m"] *= 1.01
    seen = table["target"] < 6
    diagnosis = echocal.diagnose({name: column[seen] for name, column in table.items()})
    assert diagnosis.gain.scheme.startswith("nested, blocked by target")
    others = {name: column[~seen] for name, column in table.items()}
    conditions = {
        "temperature": others["temperature_C"],
        "relative_humidity": others["humidity_percent"] / 100.0,
    }
    reads = {name: column for name, column in conditions.items() if name in diagnosis.model.reads}
    corrected = diagnosis.model.correct(others["reading_m"], **reads)
    before = np.std(others["reading_m"] - others["distance_m"])
    assert np.std(corrected - others["distance_m"]) < before


@pytest.mark.statistical
def test_a_target_that_never_returns_may_be_a_step(random: np.random.Generator) -> None:
    table = targets(random, 5, 0.0)
    target = np.arange(400) * 5 // 400
    table["target"] = target.astype(np.float64)
    table["reading_m"] += 1e-2 * np.array([0.0, 1.0, -1.0, 2.0, -0.5])[target]
    assert named(echocal.diagnose(table))[ID].indistinguishable_from == ("step_change",)


def test_text_of_many_kinds_is_no_column_of_levels() -> None:
    table = {"echo_us": [11660.0] * 60, "remark": [f"row {n}" for n in range(60)], "who": ["a", "b"] * 30}
    assert set(echocal.read_observations(table).labels) == {"who"}
