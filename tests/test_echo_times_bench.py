"""Echoes of the virtual bench, which shares no code with the estimators: other transducers, a target."""

import numpy as np
import pytest
from numpy.typing import NDArray

import echocal
from echocal.virtual_bench import Scene, Sensor, waveform
from echocal.virtual_bench.waveform.measure import received

RATE, CARRIER = 250e3, 40e3
WINDOW = {"start": 3e-3, "stop": 22e-3}  # behind the ringing of the burst, before the board's second echo
Array = NDArray[np.float64]


def timed(random: np.random.Generator, method: str, **options: object) -> tuple[Array, echocal.EchoTimes]:
    """Errors [s] less their median, and what is found, at 20 degC."""
    scene, sensor = Scene(random.uniform(0.8, 2.5, 60)), Sensor()
    _, voltage = waveform(scene, sensor, random, RATE)
    arriving = received(scene, sensor)
    # a plate of finite size returns the carrier with a phase of its own, by diffraction: below 1 us
    arrival = arriving.delays[:, 1] - np.angle(arriving.sizes[:, 1]) / (2.0 * np.pi * CARRIER)
    found = echocal.echo_times(voltage, RATE, method, **WINDOW, **options)  # type: ignore[arg-type]
    off = found.time - arrival
    return off - np.median(off), found


@pytest.mark.parametrize("method", ["matched_filter", "phase"])
def test_an_echo_of_unknown_transducers_is_timed_as_well_as_is_told(
    method: str, random: np.random.Generator
) -> None:
    off, found = timed(random, method, template="mean")
    assert found.found.all()
    same = np.abs(off) < 0.5 / CARRIER
    told = found.cycle_ambiguity.sum()
    assert (~same).sum() < told + 5.0 * np.sqrt(told) + 3.0
    assert same.mean() > 0.8
    score = (off / found.standard_uncertainty)[same]
    assert 0.6 < np.std(score) < 2.5  # path and board add 10 ns to what the noise does


def test_a_comparator_errs_by_cycles_where_the_echo_fades(random: np.random.Generator) -> None:
    level = Sensor().comparator.threshold
    off, found = timed(random, "threshold", threshold=level)
    assert found.found.all()
    assert np.ptp(off) > 1.0 / CARRIER
    weak = found.amplitude < np.median(found.amplitude)
    assert np.mean(off[weak]) > np.mean(off[~weak]) + 0.2 / CARRIER
