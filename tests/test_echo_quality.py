"""The quality number of an echo, and daylight in lux: columns that give a quantity a scale of their own."""

import numpy as np
import pytest

import echocal

ROWS = 600


def log(random: np.random.Generator, unit: float) -> dict[str, np.ndarray]:
    """A log at 1.8 m whose readings are 0.08 mm shorter for each unit of a number like that of an SR50."""
    quality = np.round(170.0 + 15.0 * np.abs(random.standard_t(4, ROWS)))
    air = 12.0 + 6.0 * np.sin(np.arange(ROWS) / 23.0) + random.normal(0.0, 0.2, ROWS)
    reading = 1.8 - 8e-5 * (quality - np.median(quality)) + random.normal(0.0, 1e-3, ROWS)
    return {
        "time_s": 3600.0 * np.arange(ROWS),
        "distance_m": np.full(ROWS, 1.8),
        "temperature_C": air,
        "reading_m": reading,
        "echo_quality": unit * quality,
    }


@pytest.mark.statistical
@pytest.mark.parametrize("unit", [1.0, 1e-3], ids=["as a logger writes it", "a thousandth of it"])
@pytest.mark.parametrize("known", [{}, {"constant_distance": True}], ids=["known", "constant"])
def test_a_reading_that_follows_the_quality(
    random: np.random.Generator, unit: float, known: dict[str, bool]
) -> None:
    table = log(random, unit)
    diagnosis = echocal.diagnose(table, **known)  # type: ignore[arg-type]
    assert diagnosis.verdict == "named"
    (cause,) = (one for one in diagnosis.causes if one.kind == "effect")
    gain, reference = cause.parameters
    assert cause.id == "echo_quality"
    of_rows = diagnosis.model.standard_uncertainties["echo_quality.gain"]
    assert abs(gain.value * unit + 8e-5) < 4 * of_rows * unit < 4e-5  # type: ignore[operator]
    assert reference.value == pytest.approx(np.median(table["echo_quality"]), rel=0.02)
    assert diagnosis.model.reads >= {"echo_quality"}


@pytest.mark.statistical
def test_what_is_no_straight_line_stays_unexplained(random: np.random.Generator) -> None:
    table = log(random, 1.0)
    quality = table["echo_quality"]
    table["reading_m"] = 1.8 + 4e-3 * np.cos((quality - 170.0) / 8.0) + random.normal(0.0, 5e-4, ROWS)
    diagnosis = echocal.diagnose(table)
    assert diagnosis.unexplained is not None
    assert diagnosis.unexplained.against == "echo_quality"


def test_daylight_stands_in_for_the_irradiance() -> None:
    table = {"echo_us": [11660.0] * 3, "temperature_C": [20.0] * 3}
    lux, watts = {"illuminance_lux": [0.0, 11e3, 55e3]}, {"radiation_W_m2": [0.0, 90.0, 510.0]}
    assert echocal.read_observations({**table, **lux}).conditions["radiation"].tolist() == [0.0, 100.0, 500.0]
    for both in ({**lux, **watts}, {**watts, **lux}):
        data = echocal.read_observations({**table, **both})
        assert data.conditions["radiation"].tolist() == watts["radiation_W_m2"]
        assert data.extra["illuminance_lux"].tolist() == lux["illuminance_lux"]
    bare = echocal.read_observations({**table, "illuminance": [1.0, 2.0, 3.0]})
    assert list(bare.extra) == ["illuminance"]  # without a unit it says nothing


@pytest.mark.statistical
def test_logs_share_the_size_whatever_their_usual_quality_is(random: np.random.Generator) -> None:
    """Each log alone is at its own reference, so that only the name was shared.

    The standard uncertainty was 2.7e-6 to 6.6e-6 in 60 draws, and the size within 1.0 of it.
    """
    logs = {}
    for name, usual in (("a", 0.0), ("b", 15.0), ("c", 40.0)):
        table = log(random, 1.0)
        logs[name] = {**table, "echo_quality": table["echo_quality"] + usual}
    found = echocal.diagnose_many(logs, constant_distance=True)
    (cause,) = (one for one in found.causes if one.id == "echo_quality")
    assert (cause.shares, cause.recurs_in, cause.doubt) == ("sizes", ("a", "b", "c"), "")
    gain = cause.parameters[0]
    assert abs(gain.value + 8e-5) < 4 * gain.standard_uncertainty < 4e-5
    assert found.gain.earned
