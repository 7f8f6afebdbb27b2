"""Echo times in noise: the bound is reached, uncertainties and ambiguities are what they say."""

import numpy as np
import pytest
from made_echoes import Echo, captures
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt

import echocal
from echocal.waveforms import cramer_rao_bound, ziv_zakai_bound
from echocal.waveforms.detection import FALSE_ALARM
from echocal.waveforms.estimators import ESTIMATORS

RATE, COUNT, CAPTURES = 500e3, 3000, 600
LATE, HALF = 3e-3, 12.5e-6  # s: begin of the echoes, half a period
LEVEL = 0.3
Array = NDArray[np.float64]
TIMERS = sorted(set(ESTIMATORS) - {"threshold"})


@pytest.fixture(scope="module")
def echo() -> Echo:
    return Echo()


def noise_of(echo: Echo, ratio_db: float | Array) -> Array:
    """Standard deviation of white noise at a ratio 2E/N0 [dB]: the sum of squares by the variance."""
    return np.asarray(np.sqrt(np.sum(echo.samples(RATE) ** 2)) * 10.0 ** (-np.asarray(ratio_db) / 20.0))


def timed(
    echo: Echo, random: np.random.Generator, method: str, noise: Array, amplitude: object = 1.0
) -> tuple[Array, echocal.EchoTimes]:
    """Errors of captures with an echo [s], against what is found without noise, and what is found."""
    delays = random.uniform(LATE, LATE + 0.5e-3, CAPTURES)
    clean = captures(echo, delays, RATE, COUNT, amplitude)
    made = clean + np.broadcast_to(noise, CAPTURES)[:, None] * random.standard_normal(clean.shape)
    options = {"threshold": LEVEL} if method == "threshold" else {}
    found = echocal.echo_times(made, RATE, method, **options)
    truth = delays
    if method == "threshold":
        truth = echocal.echo_times(clean, RATE, method, noise=1e-6, **options).time
    return found.time - truth, found


@pytest.mark.parametrize("ratio", [15.0, 25.0, 35.0, 45.0, 55.0, 65.0])
def test_the_matched_filter_reaches_the_bound_in_the_right_cycle(
    ratio: float, echo: Echo, random: np.random.Generator
) -> None:
    noise = noise_of(echo, ratio)
    off, _ = timed(echo, random, "matched_filter", noise)
    right = off[np.abs(off) < HALF]
    bound = cramer_rao_bound(echo.samples(RATE), RATE, float(noise))
    allowed = 1.2 + (4.0 / np.sqrt(2.0 * len(right)) if len(right) < 300 else 0.0)  # few have the right cycle
    assert np.sqrt(np.mean(right**2)) < allowed * bound


@pytest.mark.parametrize("ratio", [40.0, 50.0])
def test_the_matched_filter_reaches_the_bound_in_every_cycle(
    ratio: float, echo: Echo, random: np.random.Generator
) -> None:
    noise = noise_of(echo, ratio)
    off, _ = timed(echo, random, "matched_filter", noise)
    assert np.sqrt(np.mean(off**2)) < 1.2 * cramer_rao_bound(echo.samples(RATE), RATE, float(noise))


def test_below_the_threshold_the_error_is_above_the_ziv_zakai_bound(
    echo: Echo, random: np.random.Generator
) -> None:
    noise = noise_of(echo, 27.5)
    off, _ = timed(echo, random, "matched_filter", noise)
    error, samples = np.sqrt(np.mean(off**2)), echo.samples(RATE)
    assert ziv_zakai_bound(samples, RATE, float(noise), 0.5e-3) < error
    assert error > 20.0 * cramer_rao_bound(samples, RATE, float(noise))


@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize("ratio", [45.0, 60.0])
def test_uncertainties_are_those_of_the_errors(
    method: str, ratio: float, echo: Echo, random: np.random.Generator
) -> None:
    off, found = timed(echo, random, method, noise_of(echo, ratio))
    score = off / found.standard_uncertainty
    assert found.found.all()
    assert np.std(score) == pytest.approx(1.0, abs=0.13)  # 4.5 times 1/sqrt(2 n)
    assert abs(np.mean(score)) < 0.25


def test_uncertainties_of_the_matched_filter_hold_where_cycles_are_doubtful(
    echo: Echo, random: np.random.Generator
) -> None:
    off, found = timed(echo, random, "matched_filter", noise_of(echo, random.uniform(20.0, 40.0, CAPTURES)))
    right = np.abs(off) < HALF
    assert np.std((off / found.standard_uncertainty)[right]) == pytest.approx(1.0, abs=0.16)


@pytest.mark.parametrize("method", ESTIMATORS)
def test_ambiguities_are_shares_of_wrong_cycles(method: str, echo: Echo, random: np.random.Generator) -> None:
    ratio = random.uniform(20.0, 34.0, CAPTURES)
    amplitude: object = 1.0
    if method == "threshold":  # whose crest near the level is doubtful: echoes of every strength
        amplitude = np.exp(random.uniform(np.log(1.2 * LEVEL), np.log(10.0 * LEVEL), CAPTURES))
        ratio += 6.0
    off, found = timed(echo, random, method, noise_of(echo, ratio) * np.asarray(amplitude), amplitude)
    known = np.isfinite(off)
    told, wrong = found.cycle_ambiguity[known], np.abs(off[known]) > HALF
    expected, spread = told.sum(), np.sqrt(np.sum(told * (1.0 - told)))
    assert wrong.sum() > 10
    assert abs(wrong.sum() - expected) < 5.0 * spread
    sure = told < 0.02
    assert wrong[sure].sum() < told[sure].sum() + 5.0 * np.sqrt(told[sure].sum()) + 6.0


@pytest.mark.parametrize("method", ESTIMATORS)
def test_noise_of_a_receiver_with_a_band_is_known_at_the_carrier(
    method: str, echo: Echo, random: np.random.Generator
) -> None:
    delays = random.uniform(LATE, LATE + 0.5e-3, CAPTURES)
    clean = captures(echo, delays, RATE, COUNT)
    band = butter(2, (25e3, 60e3), "bandpass", fs=RATE, output="sos")
    white = random.standard_normal((CAPTURES, COUNT + 500))
    made = clean + noise_of(echo, 45.0) * sosfilt(band, white, axis=-1)[:, 500:]
    options = {"threshold": LEVEL} if method == "threshold" else {}
    truth = echocal.echo_times(clean, RATE, method, noise=1e-6, **options).time
    found = echocal.echo_times(made, RATE, method, **options)
    assert np.std((found.time - truth) / found.standard_uncertainty) == pytest.approx(1.0, abs=0.15)
    assert np.median(found.noise) == pytest.approx(float(noise_of(echo, 45.0)), rel=0.05)
    assert np.std(made[:, :1000]) < 0.7 * np.median(found.noise)  # which the whole band would say


@pytest.mark.parametrize("known", [True, False])
def test_noise_alone_is_seldom_an_echo(known: bool, random: np.random.Generator) -> None:
    made = random.standard_normal((5000, 1250))
    found = echocal.echo_times(made, 250e3, noise=1.0 if known else None)
    assert found.found.sum() < 5000 * FALSE_ALARM + 5.0 * np.sqrt(5000 * FALSE_ALARM)
    assert set(found.reasons) <= {"", "no_echo", "noise_unknown", "cut_off"}
    assert (found.reasons == "no_echo").mean() > 0.99
    assert np.isnan(found.time[~found.found]).all()


def test_strength_and_noise_are_estimated_without_bias(echo: Echo, random: np.random.Generator) -> None:
    _, found = timed(echo, random, "matched_filter", noise_of(echo, 40.0), 3.0)
    assert np.mean(found.noise) == pytest.approx(float(noise_of(echo, 40.0)), rel=0.02)
    assert np.mean(found.amplitude) == pytest.approx(3.0, rel=1e-3)
    ratio = 40.0 + 20.0 * np.log10(3.0)
    assert 10.0 * np.log10(np.median(found.signal_to_noise)) == pytest.approx(ratio, abs=0.3)
