"""Gains that rows show, and that a rule of the diagnosis must not hide."""

import numpy as np
import pytest
from scipy.signal import lfilter

import echocal

pytestmark = pytest.mark.filterwarnings("ignore::echocal.DomainWarning", "ignore::echocal.DataWarning")

Table = dict[str, np.ndarray]


def slow(random: np.random.Generator, rows: int, keep: float) -> np.ndarray:
    """Autoregression of first order with unit variance."""
    shocks = random.normal(size=rows)
    shocks[1:] *= np.sqrt(1 - keep**2)
    return lfilter([1.0], [1.0, -keep], shocks)


def tank(random: np.random.Generator, volts: float) -> Table:
    """Five days above a resting level: a late thermometer in the sun, and a supply that acts too strongly."""
    rows, step = 1440, 300.0
    hours = np.arange(rows) * step / 3600.0 % 24
    celsius = 14 + 7 * np.sin(2 * np.pi * (hours - 9) / 24) + 2.5 * slow(random, rows, 0.998)
    share = 1 - np.exp(-step / 400.0)
    late = lfilter([share], [1.0, share - 1.0], celsius - celsius[0]) + celsius[0]
    sun = 900 * np.maximum(0.0, np.sin(2 * np.pi * (hours - 6) / 24)) * random.uniform(0.4, 1.0, rows)
    recorded, supply = late + 3e-3 * sun, 5 + 0.012 * slow(random, rows, 0.97)
    echo = 4.0 / (331.4 + 0.6 * celsius) + volts * (5 - supply)
    return {
        "reading_m": (331.4 + 0.6 * recorded) * echo / 2 + random.normal(0.0, 5e-4, rows),
        "temperature_C": recorded,
        "supply_V": supply,
        "radiation_W_m2": sun,
        "time": np.datetime64("2025-05-01T00:00:00") + (np.arange(rows) * step).astype("timedelta64[s]"),
    }


@pytest.mark.slow
@pytest.mark.statistical
def test_a_cause_of_unusual_size_and_those_beside_it_are_kept(random: np.random.Generator) -> None:
    """250 us/V is four times the usual size. Before, the base was kept: 2.7 mm."""
    diagnosis = echocal.diagnose(tank(random, 250e-6), constant_distance=True)
    gain = diagnosis.gain
    assert gain is not None
    assert gain.rms_after_m < 0.5 * gain.rms_before_m
    assert "temperature_lag" in diagnosis.model.effects
    assert diagnosis.verdict == "named"
    assert "supply_voltage" in diagnosis.model.effects


def offset_under_slow_noise(random: np.random.Generator) -> Table:
    """One known distance, a constant error of -47 mm, and slow noise of 10 mm."""
    rows = 143
    hours = np.arange(rows) / 6.0
    celsius = 15 + 5 * np.sin(2 * np.pi * hours / 24 - 2) + 2 * slow(random, rows, 0.99)
    reading = 2.0 - 0.047 + 0.010 * slow(random, rows, 0.95) + random.normal(0.0, 1e-3, rows)
    return {
        "reading_m": reading,
        "temperature_C": celsius,
        "time_s": 3600.0 * hours,
        "distance_m": np.full(rows, 2.0),
    }


@pytest.mark.statistical
def test_an_offset_under_slow_noise_is_not_lost_with_the_first_rows(random: np.random.Generator) -> None:
    """Without its first block, a table had no start of a series, and slow noise took the offset: 23 mm."""
    left = []
    for _ in range(6):
        diagnosis = echocal.diagnose(offset_under_slow_noise(random))
        assert diagnosis.gain is not None
        left.append(1e3 * diagnosis.gain.rms_after_m)
    assert np.median(left) < 14.0
    assert sum(rms > 30.0 for rms in left) <= 1
