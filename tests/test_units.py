"""Rows of one visit to a placement are one unit: docs/method/rows-and-candidates.md, Eq. 1a."""

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.diagnose.preprocess.row_mixture import row_mixture

DISTANCES = (0.3, 0.6, 0.9, 1.2, 1.6, 2.0, 2.5, 3.0)


def visits(random: np.random.Generator, rows: int, delay: float = 0.0) -> pd.DataFrame:
    """Eight distances, cold and warm: every visit has an error of its own, and the rows scatter little."""
    parts = []
    for visit, (celsius, distance) in enumerate((t, d) for t in (12.0, 28.0) for d in DISTANCES):
        speed = 331.4 + 0.6 * celsius
        shared = random.normal(0.0, 1e-3)
        echo = 2.0 * (distance + shared + random.normal(0.0, 2e-4, rows)) / speed + delay
        parts.append(
            pd.DataFrame(
                {
                    "time_s": 300.0 * visit + 0.2 * np.arange(rows),
                    "echo_us": 1e6 * echo,
                    "temperature_C": celsius + random.normal(0.0, 0.02, rows),
                    "distance_m": distance,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


@pytest.mark.statistical
def test_errors_of_visits_are_no_effect(random: np.random.Generator) -> None:
    """Each row by itself: 24 of 30 such tables are unknown, or have a named effect."""
    found = [echocal.diagnose(visits(random, 25)) for _ in range(10)]
    alarms = [d.verdict for d in found if any(c.kind == "effect" for c in d.causes) or d.unexplained]
    assert len(alarms) <= 2, alarms


@pytest.mark.statistical
@pytest.mark.parametrize("rows", [3, 25])
def test_a_delay_is_named_whatever_the_number_of_rows(random: np.random.Generator, rows: int) -> None:
    diagnosis = echocal.diagnose(visits(random, rows, delay=60e-6))
    cause = diagnosis.causes[0]
    assert diagnosis.verdict == "named"
    assert "fixed_delay" in (cause.id, *cause.indistinguishable_from)
    assert diagnosis.gain.held_out_rows == 16 * rows
    assert diagnosis.gain.rms_after_m < 2e-3


def test_the_mean_of_a_visit_is_that_of_its_core(random: np.random.Generator) -> None:
    visit, period = np.repeat(np.arange(12), 20), np.full(240, 4.3e-3)
    level = random.uniform(0.5, 3.0, 12)
    reading = level[visit] + random.normal(0.0, 3e-4, 240)
    kind = random.permuted(np.tile(np.repeat([0, 1, 2], [16, 3, 1]), (12, 1)), axis=1).ravel()
    reading[kind == 1] += 4.3e-3
    reading[kind == 2] += random.uniform(0.03, 0.8, int((kind == 2).sum()))
    found = row_mixture(reading, visit, period)
    np.testing.assert_allclose(found.mean, level, atol=6 * 3e-4 / np.sqrt(12))
    assert found.scatter == pytest.approx(3e-4, rel=0.3)
    assert np.abs(np.bincount(visit, reading) / 20 - level).max() > 1e-3  # the plain mean is off
