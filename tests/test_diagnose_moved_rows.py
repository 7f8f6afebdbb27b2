"""Readings that belong to a row some lines away."""

import numpy as np
import pandas as pd
import pytest

import echocal

ROWS = 120


def table(random: np.random.Generator, shift: int) -> pd.DataFrame:
    """Targets in random order; from the middle on, each reading stands so many rows too low."""
    distance = random.uniform(0.4, 3.5, ROWS)
    reading = distance + random.normal(0.0, 1e-3, ROWS)
    middle = ROWS // 2
    reading[middle + shift :] = reading[middle : ROWS - shift].copy()
    celsius = 20.0 + random.normal(0.0, 0.2, ROWS)
    return pd.DataFrame({"temperature_C": celsius, "distance_m": distance, "reading_m": reading})


@pytest.mark.statistical
@pytest.mark.parametrize("shift", [1, 5, 11])
def test_a_shift_of_up_to_eleven_rows_is_found(random: np.random.Generator, shift: int) -> None:
    found = {cause.id: cause for cause in echocal.diagnose(table(random, shift)).causes}
    sizes = {p.name: p.value for p in found["shifted_rows"].parameters}
    assert sizes["shift"] == shift
    assert sizes["first_row"] == pytest.approx(ROWS // 2 + shift + 1, abs=2)


@pytest.mark.statistical
def test_a_series_that_lags_by_more_is_not_moved_by_less(random: np.random.Generator) -> None:
    """A stage that changes slowly and a clock that is late: every shift fits better than none."""
    stage = 2.0 + 0.8 * np.sin(np.linspace(0.0, 12.0, 400))
    reading = np.concatenate([np.full(25, stage[0]), stage[:-25]]) + random.normal(0.0, 1e-3, 400)
    celsius = 20.0 + random.normal(0.0, 0.2, 400)
    late = pd.DataFrame({"temperature_C": celsius, "distance_m": stage, "reading_m": reading})
    assert "shifted_rows" not in {cause.id for cause in echocal.diagnose(late).causes}
