"""The gain under other conditions than those of the fit, against a fit of one's own."""

import numpy as np
import pytest

import echocal

ROWS = 400


def table(random: np.random.Generator, *, near_and_far: float = 0.0) -> dict[str, np.ndarray]:
    """An offset of 8 mm, and what is added where the distance is not of the middle."""
    distance = random.uniform(0.5, 3.5, ROWS)
    low, high = np.quantile(distance, [0.2, 0.8])
    outside = (distance < low) | (distance > high)
    reading = distance + 8e-3 + near_and_far * outside + random.normal(0.0, 1e-3, ROWS)
    celsius = random.uniform(19.9, 20.1, ROWS)
    return {"reading_m": reading, "distance_m": distance, "temperature_C": celsius}


def diagnosed(given: dict[str, np.ndarray]) -> echocal.Diagnosis:
    return echocal.diagnose(given, base="linear")


def test_the_fit_sees_the_middle_only(random: np.random.Generator) -> None:
    given = table(random, near_and_far=5e-4)
    diagnosis = diagnosed(given)
    assert diagnosis.gain is not None
    (one,) = [s for s in diagnosis.gain.shifted if s.against == "distance"]
    off = given["reading_m"] - given["distance_m"]
    inside = (given["distance_m"] >= one.low) & (given["distance_m"] <= one.high)
    assert one.rows == (~inside).sum()
    assert one.rms_before_m == pytest.approx(np.sqrt(np.mean(off[~inside] ** 2)), rel=1e-6)
    if {c.id for c in diagnosis.causes} <= {"zero_error", "fixed_delay"}:  # else it is not one mean
        left = off[~inside] - off[inside].mean()
        assert one.rms_after_m == pytest.approx(np.sqrt(np.mean(left**2)), rel=2e-3)


@pytest.mark.statistical
def test_a_right_cause_holds_outside(random: np.random.Generator) -> None:
    diagnosis = diagnosed(table(random))
    assert diagnosis.gain is not None
    for one in diagnosis.gain.shifted:
        assert one.rms_after_m < 1.4e-3 < one.rms_before_m
    assert "Under other conditions: the model is fitted to rows with distance from" in diagnosis.explain()
    assert diagnosis.to_dict()["gain"]["shifted"][0]["against"] == "distance"


def test_what_does_not_vary_is_not_told(random: np.random.Generator) -> None:
    given = table(random)
    given["distance_m"] = np.round(given["distance_m"])  # 0, 1, 2, 3, 4 less those without a reading
    given["reading_m"] = given["distance_m"] + 8e-3
    given = {name: column[given["distance_m"] > 1] for name, column in given.items()}
    gain = diagnosed(given).gain
    assert gain is not None
    assert "distance" not in {one.against for one in gain.shifted}
