"""The bench of compensation: its page is fresh; its parts, methods and filters do what they say."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("sklearn", reason="scikit-learn is absent: pip install 'echocal[bench]'")
sys.path.insert(0, str(Path(__file__).parents[1] / "benches"))

from compensation import campaign, filters, methods, page, world
from compensation.campaign import Setting

from echocal.virtual_bench import Sensor

_LONG = 4000


@pytest.fixture(scope="module")
def drawn(seeded: Any, request: pytest.FixtureRequest) -> campaign.Drawn:
    """One device and all its campaigns."""
    return campaign.draw(int(seeded(request).integers(2**31)), "spring")


def test_the_page_is_fresh() -> None:
    text = page.page(page.load())
    assert page.PAGE.read_text(encoding="utf-8") == text, "run: python benches/compensation --draw"


def test_every_setting_has_figures() -> None:
    assert sorted(page.load()["figures"]) == sorted(setting.key for setting in campaign.settings())


def test_a_device_is_the_same_in_all_campaigns(drawn: campaign.Drawn) -> None:
    device, truth = drawn.device, drawn.tested["nominal"]
    again = campaign.draw(drawn.seed, "spring")
    assert again.device.unit == device.unit
    pd.testing.assert_frame_equal(again.device.log(truth, "tmp36"), device.log(truth, "tmp36"))


def test_pulse_in_loses_what_the_emulated_board_loses(drawn: campaign.Drawn) -> None:
    """5.98 us of each 1024 us."""
    logs = {
        name: drawn.device.log(drawn.trained, "none", name)["echo_us"] for name in ("capture", "pulse_in")
    }
    lost = 1 - logs["pulse_in"] / logs["capture"]
    assert np.average(lost, weights=logs["capture"]) == pytest.approx(5.98 / 1024, abs=2e-4)


def test_whole_centimeters_are_multiples_of_58_us(drawn: campaign.Drawn) -> None:
    echo = drawn.device.log(drawn.trained, "none", "whole_cm")["echo_us"]
    assert (echo % 58 == 0).all()


def test_an_lm35_reads_nothing_below_two_degrees(drawn: campaign.Drawn) -> None:
    winter = drawn.tested["winter"]
    air = winter.around.temperature
    cold = replace(winter, around=replace(winter.around, temperature=air - air.max() - 10.0))
    assert drawn.device.log(cold, "lm35")["temperature_C"].between(1.4, 2.6).all()
    assert (drawn.device.log(cold, "tmp36")["temperature_C"] < 0.0).mean() > 0.7


def test_a_shield_keeps_the_sun_off(drawn: campaign.Drawn) -> None:
    summer = drawn.tested["summer"]
    sun = summer.around.radiation
    noon, night = sun > 0.5 * sun.max(), sun == 0.0
    warmed = []
    for name in ("dht22", "shield"):
        error = drawn.device.log(summer, name)["temperature_C"] - summer.around.temperature
        warmed.append(error[noon].mean() - error[night].mean())
    assert 0.5 < warmed[1] * 2 < warmed[0]


def test_the_second_sensor_follows_the_temperature(drawn: campaign.Drawn) -> None:
    """Another cycle of its echo, 4.3 mm at 1 m, is 2.5 K."""
    summer = drawn.tested["summer"]
    read = drawn.device.log(summer, "path")["temperature_C"]
    assert np.corrcoef(read, summer.around.temperature)[0, 1] > 0.8


@pytest.mark.parametrize("name", ["dht22", "hih4030"])
def test_a_hygrometer_follows_the_humidity(name: str, drawn: campaign.Drawn) -> None:
    """At night: by day the sun dries the air in the part."""
    spring = drawn.tested["spring"]
    night = spring.around.radiation == 0.0
    error = drawn.device.log(spring, name)["humidity_percent"] - 100 * spring.around.relative_humidity
    assert np.abs(error[night]).median() < 12.0


def test_a_weaker_module_hears_no_more_noise(drawn: campaign.Drawn) -> None:
    """Threshold and noise are told by the echo: their ratio is that of the bench's module."""
    own, usual = drawn.device.unit.sensor, Sensor()
    assert own.comparator.threshold / own.noise == pytest.approx(usual.comparator.threshold / usual.noise)
    assert own.transmitter.quality == usual.transmitter.quality


def test_nothing_is_learned_from_a_false_echo(drawn: campaign.Drawn) -> None:
    log = drawn.device.log(drawn.trained, "none")
    log.loc[7, "echo_us"] -= 2000.0
    found = campaign.without_false(log, drawn.trained)["echo_us"]
    assert np.isnan(found[7])
    assert np.isfinite(found[[5, 6, 8, 9]]).sum() >= np.isfinite(log["echo_us"][[5, 6, 8, 9]]).sum() - 1


def _made(random: np.random.Generator, noise: float) -> pd.DataFrame:
    """Readings of a device with a delay and a wrong clock, of many placements."""
    stand = np.repeat(np.arange(40), 5)
    distance = random.uniform(0.3, 3.5, 40)[stand]
    temperature = 17.0 + 12.0 * np.sin(np.arange(200) / 20.0 + random.uniform(0.0, 6.0))
    flight = np.asarray(methods.echocal.time_of_flight(distance, temperature, relative_humidity=0.5))
    echo = 1e6 * 1.003 * (flight - 90e-6 + noise * random.normal(size=200))
    return pd.DataFrame(
        {
            "time_s": 60.0 * np.arange(200),
            "echo_us": echo,
            "temperature_C": temperature,
            "humidity_percent": 50.0,
            "distance_m": distance,
            "stand": stand + 1,
        }
    )


@pytest.mark.parametrize(
    "name", ["line", "calibrated", "local", pytest.param("hybrid", marks=pytest.mark.slow)]
)
def test_a_method_takes_a_delay_and_a_clock_away(name: str, random: np.random.Generator) -> None:
    log, other = _made(random, 1e-6), _made(random, 1e-6)
    left = methods.METHODS[name].learn(log, 1)(other) - other["distance_m"]
    bare = methods.cramer(other) - other["distance_m"]
    assert np.sqrt(np.mean(left**2)) < 0.1 * np.sqrt(np.mean(bare**2))


def test_learned_residuals_hold_between_the_marks(random: np.random.Generator) -> None:
    from compensation.learners import LEARNERS

    log, other = _made(random, 1e-6), _made(random, 1e-6)
    left = LEARNERS["boosting_left"].learn(log, 1)(other) - other["distance_m"]
    bare = methods.cramer(other) - other["distance_m"]
    assert np.sqrt(np.mean(left**2)) < 0.3 * np.sqrt(np.mean(bare**2))


def test_a_kalman_filter_finds_its_variances(random: np.random.Generator) -> None:
    seconds = np.arange(float(_LONG))
    walk, noise = 1e-8, 4e-6
    true = 2.0 + np.cumsum(np.sqrt(walk) * random.normal(size=_LONG))
    read = true + np.sqrt(noise) * random.normal(size=_LONG)
    found = filters.Kalman.fitted(read, seconds)
    assert found.noise == pytest.approx(noise, rel=0.3)
    assert found.walk == pytest.approx(walk, rel=1.0)
    states = found.run(read, seconds)[0]
    assert np.std(states - true) < 0.5 * np.sqrt(noise)


def test_a_gate_begins_anew_after_a_move(random: np.random.Generator) -> None:
    seconds = np.arange(200.0)
    true = np.where(seconds < 100, 1.0, 2.0)
    read = true + 1e-3 * random.normal(size=200)
    gated = filters.Kalman(1e-12, 1e-6, gate=True).run(read, seconds)[0]
    bare = filters.Kalman(1e-12, 1e-6).run(read, seconds)[0]
    assert np.abs(gated - true).max() < 6e-3
    assert np.abs(bare - true)[100:110].min() > 0.5


def test_a_filter_says_nothing_where_no_echo_came() -> None:
    read = np.repeat([1.0, np.nan, 2.0], world.EACH)
    seconds = np.arange(float(len(read)))
    found = filters.Kalman(1e-6, 1e-6)(read, seconds)
    assert np.isfinite(found).tolist() == [True, False, True]
    assert np.isfinite(filters.median(read, seconds)).tolist() == [True, False, True]


def test_a_row_without_an_echo_is_told(drawn: campaign.Drawn) -> None:
    truth = drawn.tested["nominal"]
    values = truth.distance[:: world.EACH].copy()
    values[:10] = np.nan
    found = campaign.figures(values, truth)["all"]
    assert found["missing"] == pytest.approx(10 / len(values))
    assert found["mean_square"] == 0.0


def test_a_better_detector_is_better(seeded: Any, request: pytest.FixtureRequest) -> None:
    """The claim of the page: the comparator limits what a thermometer and a ruler leave.

    It is so for most devices, not for each: for 5 devices a majority decides.
    """
    chosen = [Setting(campaign.BEST), Setting(campaign.BEST, oracle="detector")]
    better = 0
    for device in range(5):
        drawn = campaign.draw(int(seeded(request, str(device)).integers(2**31)), "spring")
        walked, ideal = (campaign.run(drawn, [one])[0][one.key]["nominal"]["all"] for one in chosen)
        better += ideal["mean_square"] < walked["mean_square"]
    assert better >= 3
