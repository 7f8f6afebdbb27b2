"""A wild row is left out by name, and begins nothing."""

import numpy as np
import pytest

import echocal
from echocal.diagnose.rows import isolated_rows
from echocal.diagnose.scene import FAR

ROWS = 400


def bench(random: np.random.Generator) -> dict[str, np.ndarray]:
    distance = np.repeat(np.sort(random.uniform(0.5, 3.8, 5)), ROWS // 5)
    celsius = np.tile(np.linspace(4.0, 42.0, ROWS // 5), 5) + random.normal(0.0, 0.1, ROWS)
    reading = distance + random.normal(0.0, 1.5e-3, ROWS)
    return {
        "reading_m": reading,
        "distance_m": distance,
        "temperature_C": celsius,
        "time_s": 20.0 * np.arange(ROWS),
    }


@pytest.mark.parametrize("row", [0, 200, ROWS - 1])
def test_one_wild_row_is_no_step(row: int) -> None:
    said = []
    for _ in range(3):
        table = bench(np.random.default_rng())
        table["reading_m"][row] += 0.06
        diagnosis = echocal.diagnose(table)
        assert diagnosis.rows["unusable"] == {FAR: 1}
        assert "step_change" not in {cause.id for cause in diagnosis.causes}
        said.append(diagnosis.verdict)
    assert said.count("nothing") >= 2  # of a hundred tables one or two give a false alarm


def test_rows_alike_vouch_for_each_other() -> None:
    random = np.random.default_rng()
    table = bench(random)
    deviation = table["reading_m"] - table["distance_m"]
    orders = [np.arange(ROWS, dtype=float), table["distance_m"], table["temperature_C"]]
    warmest = np.argsort(table["temperature_C"])[-5:]
    deviation[warmest] += 0.06  # five rows, one in each stand, but the five warmest
    assert not isolated_rows(deviation, orders).any()
    deviation[warmest] -= 0.06
    deviation[warmest[0]] += 0.06
    assert np.flatnonzero(isolated_rows(deviation, orders)).tolist() == [warmest[0]]
