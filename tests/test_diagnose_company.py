"""Causes beside a larger one: found where they are, not where they would be alone."""

import numpy as np

import echocal

ROWS = 600


def test_a_step_is_placed_beside_a_wrong_speed() -> None:
    random = np.random.default_rng()
    distance, celsius = random.uniform(0.5, 3.5, ROWS), random.uniform(5.0, 35.0, ROWS)
    first = int(random.integers(150, 450))
    reading = distance * 343.0 / (331.4 + 0.6 * celsius) + random.normal(0.0, 1e-3, ROWS)
    reading[first:] += 6e-3
    table = {
        "reading_m": reading,
        "distance_m": distance,
        "temperature_C": celsius,
        "time_s": 60.0 * np.arange(ROWS),
    }
    found = {cause.id: cause for cause in echocal.diagnose(table, base="linear").causes}
    assert {"fixed_speed", "step_change"} <= set(found)
    begins = {p.name: p.value for p in found["step_change"].parameters}["time"]
    assert abs(begins / 60.0 - first) <= 3


def test_a_stand_that_is_far_as_a_whole_is_kept() -> None:
    random = np.random.default_rng()
    distance = np.repeat([0.5, 0.8, 1.1, 1.4, 1.7, 3.0], 40)
    reading = distance + random.normal(0.0, 1e-3, len(distance))
    reading[-40:] -= 0.12  # something at the edge of the beam answers first
    reading[7] += 0.5  # and one wild row
    celsius = random.uniform(15.0, 25.0, len(distance))
    table = {"reading_m": reading, "distance_m": distance, "temperature_C": celsius}
    diagnosis = echocal.diagnose(table)
    assert diagnosis.rows["used"] == len(distance) - 1
    weighed = {id_ for ids, p in diagnosis.posterior for id_ in ids if p > 0.5}
    assert weighed >= {"beam_edge"}  # one stand alone cannot vouch for it: held out, it may be refuted
