"""Thermometers of the virtual bench: laws of the body and of the record, and figures of the data sheets."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from echocal.errors import UsageError
from echocal.virtual_bench.echo_time import echo_time
from echocal.virtual_bench.instruments import (
    DHT22,
    DS18B20,
    HIH4030,
    LM35,
    PARTS,
    POTENTIOMETER,
    TMP36,
    AnalogThermometer,
    Thermometer,
)

# voltages that the data sheets state [degC, V]
STATED = [
    (TMP36, -40.0, 0.1),
    (TMP36, 25.0, 0.75),
    (TMP36, 125.0, 1.75),
    (LM35, 25.0, 0.25),
    (LM35, 100.0, 1.0),
]


@pytest.mark.parametrize(("part", "temperature", "volts"), STATED)
def test_voltages_are_those_of_the_data_sheet(
    part: AnalogThermometer, temperature: float, volts: float
) -> None:
    assert part.voltage(part.ideal().record(temperature)) == pytest.approx([volts])


def test_a_potentiometer_divides_the_supply() -> None:
    for supply in (4.7, 5.0):
        assert POTENTIOMETER.voltage([0.0, 20.0, 50.0], supply) == pytest.approx([0.0, 0.4 * supply, supply])


def test_a_body_follows_as_the_differential_equation_says(random: np.random.Generator) -> None:
    """dB/dt = (A - B) / tau, against an integrator of SciPy, the air linear between rows at uneven times."""
    seconds = np.cumsum(random.uniform(1.0, 200.0, 30))
    air = 20.0 + np.cumsum(random.normal(0.0, 2.0, 30))
    part = Thermometer("any", time_constant=float(random.uniform(20.0, 300.0)))

    def slope(t: float, body: np.ndarray) -> np.ndarray:
        return (np.interp(t, seconds, air) - body) / part.time_constant

    exact = solve_ivp(slope, seconds[[0, -1]], air[:1], t_eval=seconds, rtol=1e-9, atol=1e-9, max_step=5.0).y[
        0
    ]
    assert part.body(air, seconds) == pytest.approx(exact, abs=1e-4)


def test_two_thirds_of_a_step_are_there_after_one_time_constant() -> None:
    seconds, air = np.array([0.0, 1e-6, 60.0]), np.array([20.0, 30.0, 30.0])
    body = replace(TMP36.ideal(), time_constant=60.0).body(air, seconds)
    assert body[-1] == pytest.approx(30.0 - 10.0 * np.exp(-1.0), abs=1e-4)


def test_readings_at_one_time_have_one_body() -> None:
    body = DS18B20.body([20.0, 25.0, 25.0], [0.0, 0.0, 1e6])
    assert body[1] == body[0]
    assert body[2] == pytest.approx(25.0 + DS18B20.self_heating)


def test_the_sun_and_the_current_warm() -> None:
    shade = TMP36.record(20.0)
    assert shade == pytest.approx([20.04])
    assert TMP36.record(20.0, radiation=1000.0) - shade == pytest.approx([TMP36.sun])


def test_steps_noise_and_late_readings(random: np.random.Generator) -> None:
    air = random.uniform(0.0, 40.0, 500)
    recorded = DHT22.record(air, random=random)
    assert np.abs(recorded / 0.1 - np.round(recorded / 0.1)).max() < 1e-9
    scatter = np.std(recorded[1:] - air[:-1])  # each reading is that of the row before
    assert 0.07 < scatter < 0.15
    assert DHT22.record(air, random=np.random.default_rng(1))[0] == pytest.approx(recorded[1], abs=0.6)
    steps = DS18B20.ideal().record(air) - air
    assert np.abs(steps).max() <= 0.0625 / 2
    assert np.std(steps) == pytest.approx(0.0625 / np.sqrt(12), rel=0.15)


@pytest.mark.parametrize("name", PARTS)
def test_parts_differ_within_their_tolerance(name: str, random: np.random.Generator) -> None:
    part = PARTS[name]
    offsets = np.array([part.drawn(random).offset for _ in range(400)])
    assert offsets.std() == pytest.approx(part.tolerance, rel=0.2)
    assert type(part.drawn(random)) is type(part)
    assert part.ideal().record([part.low, 20.0, part.high]) == pytest.approx([part.low, 20.0, part.high])
    beyond = part.drawn(random).record([-500.0, 2000.0])
    assert part.low <= beyond.min()
    assert beyond.max() <= part.high


def test_a_hygrometer_gives_the_data_sheets_voltage_and_its_temperature_error() -> None:
    """HIH-4030: V = 5 (0.0062 RH + 0.16) at 25 degC; true RH = RH / (1.0546 - 0.00216 T)."""
    assert HIH4030.voltage(0.0, 25.0) == pytest.approx(0.8)
    shown = (HIH4030.voltage([0.9, 0.9], [0.0, 50.0]) / 5.0 - 0.16) / 0.62
    assert shown == pytest.approx([0.9 * 1.0546, 0.9 * 0.9466])


@pytest.mark.parametrize(
    ("time", "message"),
    [([0.0, 1.0, 2.0], r"time has shape \(3,\)"), ([1.0, 0.0], r"falls from 1 s to 0 s \(row 2\)")],
)
def test_impossible_times(time: list[float], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        TMP36.record([20.0, 21.0], time)


def test_the_echo_time_is_the_way_out_and_back() -> None:
    assert echo_time(4.0, 20.0) == pytest.approx(2.0 * echo_time(2.0, 20.0))
    slow = 343.37  # m/s, at low frequencies: Cramer 1993, doi:10.1121/1.405827, dry air of 20 degC
    fast = 0.13  # m/s more at 40 kHz: oxygen and nitrogen have relaxed (Morfey & Howell 1980)
    assert 2 * 2.0 / echo_time(2.0, 20.0) == pytest.approx(slow + fast, abs=0.03)
    assert echo_time(2.0, 40.0, 0.9) < echo_time(2.0, 40.0) < echo_time(2.0, 0.0)


def test_a_comparator_without_a_seed_has_nothing_random(random: np.random.Generator) -> None:
    distance = random.uniform(0.3, 3.0, 50)
    once, again = (echo_time(distance, 20.0, 0.5, detector="comparator") for _ in range(2))
    np.testing.assert_array_equal(once, again)
    noisy = [echo_time(distance, 20.0, 0.5, detector="comparator", seed=seed) for seed in (1, 1, 2)]
    np.testing.assert_array_equal(noisy[0], noisy[1])
    assert (noisy[0] != noisy[2]).any()
