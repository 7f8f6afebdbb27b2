"""Echo times without noise, or whatever the noise: exact, and the laws that every method obeys."""

import numpy as np
import pytest
from made_echoes import Echo, captures
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

import echocal
from echocal.waveforms import cramer_rao_bound, model_burst, ziv_zakai_bound
from echocal.waveforms.baseband import Plan
from echocal.waveforms.detection import detect
from echocal.waveforms.estimators import ESTIMATORS
from echocal.waveforms.template import Template

RATE, COUNT = 500e3, 3500
LATE = 3e-3  # s, about when echoes begin
ORIGIN = sorted(set(ESTIMATORS) - {"threshold"})  # methods that give the begin of the template
QUIET = 1e-4  # standard deviation that is told where there is no noise
Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def echo() -> Echo:
    return Echo()


def options(method: str) -> dict[str, float]:
    return {"threshold": 0.3} if method == "threshold" else {}


def noisy(echo: Echo, random: np.random.Generator, count: int = 6, noise: float = 0.02) -> Array:
    clean = captures(echo, random.uniform(LATE, LATE + 1e-3, count), RATE, COUNT)
    return np.asarray(clean + noise * random.standard_normal(clean.shape))


def test_the_model_burst_is_what_lsim_gives(echo: Echo) -> None:
    for rate in (137e3, 500e3, 1e6):
        burst = model_burst(rate)
        peak = 2e-3 if rate < 200e3 else 1e-4  # its envelope's maximum is known at the samples only
        assert burst == pytest.approx(echo.samples(rate)[: len(burst)], abs=peak)


@pytest.mark.parametrize("method", ORIGIN)
@pytest.mark.parametrize(("rate", "carrier_phase", "envelope"), [(100e3, 3e-9, 2e-7), (1e6, 1e-10, 1e-9)])
def test_an_echo_without_noise_is_timed_exactly(
    method: str, rate: float, carrier_phase: float, envelope: float, echo: Echo, random: np.random.Generator
) -> None:
    delays = random.uniform(LATE, LATE + 1e-3, 20)
    made = captures(echo, delays, rate, int(7e-3 * rate))
    found = echocal.echo_times(made, rate, method, noise=QUIET)
    assert found.time == pytest.approx(delays, abs=envelope if method == "envelope" else carrier_phase)
    assert found.amplitude == pytest.approx(1.0, rel=1e-3)


def test_a_threshold_is_crossed_where_the_filtered_echo_passes_it(
    echo: Echo, random: np.random.Generator
) -> None:
    fine = 16e6
    delay = float(random.uniform(LATE, LATE + 1e-3))
    level, width = float(random.uniform(0.1, 0.8)), 5e3
    spectrum = np.fft.rfft(captures(echo, np.array([delay]), fine, int(8e-3 * fine))[0])
    frequency = np.fft.rfftfreq(int(8e-3 * fine), 1.0 / fine)
    filtered = np.fft.irfft(spectrum * 0.5 ** (0.5 * ((frequency - 40e3) / (0.5 * width)) ** 2))
    after = int(np.argmax(filtered >= level))
    part = (level - filtered[after - 1]) / (filtered[after] - filtered[after - 1])
    made = captures(echo, np.array([delay]), RATE, COUNT)
    found = echocal.echo_times(made, RATE, "threshold", threshold=level, bandwidth=width, noise=QUIET)
    assert found.time[0] == pytest.approx((after - 1 + part) / fine, abs=2e-9)


@pytest.mark.parametrize("method", ESTIMATORS)
def test_a_shift_by_a_part_of_a_sample_shifts_the_time_by_it(
    method: str, echo: Echo, random: np.random.Generator
) -> None:
    delay, shifts = random.uniform(LATE, LATE + 1e-3), random.uniform(0.0, 10.0, 20) / RATE
    made = captures(echo, delay + np.append(0.0, shifts), RATE, COUNT)
    time = echocal.echo_times(made, RATE, method, noise=QUIET, **options(method)).time
    assert time[1:] - time[0] == pytest.approx(shifts, abs=1e-9)


@pytest.mark.parametrize("method", ESTIMATORS)
def test_the_unit_of_the_waveform_does_not_matter(
    method: str, echo: Echo, random: np.random.Generator
) -> None:
    made, factor = noisy(echo, random), float(10.0 ** random.uniform(-6, 6))
    one = echocal.echo_times(made, RATE, method, **options(method))
    scaled = {name: factor * value for name, value in options(method).items()}
    other = echocal.echo_times(factor * (made + 7.0), RATE, method, **scaled)
    for name in ("time", "standard_uncertainty", "cycle_ambiguity", "signal_to_noise"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-6, abs=1e-12), name
    for name in ("amplitude", "noise"):
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=1e-6), name


def test_crests_are_maxima_also_where_the_echo_grows(echo: Echo, random: np.random.Generator) -> None:
    samples = echo.samples(RATE)
    plan = Plan(Template(samples, RATE), 40e3, 5e3, len(samples))
    band = detect(plan, samples[None], np.ones(1)).passed
    near = random.uniform(1e-4, 6e-4, (1, 50))
    time, height = band.crest(near)
    rate = 40e3 * 2.0 * np.pi
    value, slope = band.carried(time)
    assert np.abs(slope.real).max() < 1e-5 * rate * height.min()  # 40 ps
    assert height == pytest.approx(value.real)
    assert (height > band.carried(time + 1e-6)[0].real).all()
    assert (height > band.carried(time - 1e-6)[0].real).all()
    assert np.abs(time - near).max() < 0.51 / 40e3 + 1e-6


@pytest.mark.parametrize("method", ESTIMATORS)
def test_a_batch_is_a_loop(method: str, echo: Echo, random: np.random.Generator) -> None:
    made = noisy(echo, random, 12).reshape(2, 3, 2, COUNT)
    made[1, 2, 0, 100] = np.inf
    batch = echocal.echo_times(made, RATE, method, **options(method))
    for place in np.ndindex(made.shape[:-1]):
        alone = echocal.echo_times(made[place], RATE, method, **options(method))
        assert alone.status == batch.status[place]
        for name in ("time", "standard_uncertainty", "cycle_ambiguity", "amplitude", "signal_to_noise"):
            value, own = getattr(batch, name)[place], getattr(alone, name)
            assert own == pytest.approx(value, rel=1e-9, abs=1e-15, nan_ok=True), name


def test_blocks_do_not_matter(
    echo: Echo, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, level = noisy(echo, random, 11), random.uniform(0.2, 0.5, 11)
    whole = echocal.echo_times(made, RATE, "threshold", threshold=level, noise=0.02)
    monkeypatch.setattr("echocal.waveforms.captures._AT_ONCE", 4 * COUNT)
    told: list[tuple[int, int]] = []
    parts = echocal.echo_times(
        made, RATE, "threshold", threshold=level, noise=0.02, progress=lambda *done: told.append(done)
    )
    assert parts.time == pytest.approx(whole.time, abs=1e-15)
    assert told == [(4, 11), (8, 11), (11, 11)]


@pytest.mark.parametrize("method", ESTIMATORS)
def test_times_are_from_the_first_sample_whatever_the_window(
    method: str, echo: Echo, random: np.random.Generator
) -> None:
    made = noisy(echo, random)
    made[:, :200] += 30.0 * np.exp(-np.arange(200) / 50.0) * (-1.0) ** (np.arange(200) // 6)  # ringing
    late = {"start": 1.5e-3, "stop": 6.5e-3, "noise": 0.02, **options(method)}
    windowed = echocal.echo_times(made, RATE, method, **late)
    cut = echocal.echo_times(made[:, 750:3250], RATE, method, noise=0.02, **options(method))
    assert windowed.time == pytest.approx(cut.time + 1.5e-3, abs=1e-15)


def test_the_matched_filter_is_the_least_squares_fit(echo: Echo, random: np.random.Generator) -> None:
    noise = 0.05
    made = noisy(echo, random, 8, noise)
    bound = cramer_rao_bound(echo.samples(RATE), RATE, noise)
    found = echocal.echo_times(made, RATE, template=echo.samples(RATE))
    along = np.arange(COUNT) / RATE
    for capture, time in zip(made, found.time, strict=True):
        fit = minimize_scalar(
            lambda delay, capture=capture: -capture @ echo(along - delay),
            bounds=(time - 5e-6, time + 5e-6),
            method="bounded",
            options={"xatol": 1e-12},
        )
        assert fit.x == pytest.approx(time, abs=0.02 * bound)


@pytest.mark.parametrize("quality", [(14.0, 26.0), (20.0, 20.0)])
@pytest.mark.parametrize("center", [(39.3e3, 40.5e3), (40e3, 40e3)])
def test_the_mean_of_the_captures_is_a_template(
    quality: tuple[float, ...], center: tuple[float, ...], random: np.random.Generator
) -> None:
    odd = Echo(quality, center)
    delays, strength = random.uniform(LATE, LATE + 1e-3, 200), random.uniform(0.5, 2.0, 200)
    clean = -captures(odd, delays, RATE, COUNT, strength)  # an amplifier that inverts
    made = clean + 0.02 * random.standard_normal(clean.shape)
    off = echocal.echo_times(made, RATE, template="mean").time - delays
    bound = cramer_rao_bound(odd.samples(RATE), RATE, 0.02) / strength
    assert np.std((off - np.median(off)) / bound) < 1.2
    assert abs(np.median(off)) < 50e-6  # where a mean begins is a convention


@pytest.mark.parametrize("rounds", [0, 3])
def test_the_mean_of_inverted_echoes_does_not_mix_cycles(
    rounds: int, echo: Echo, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("echocal.waveforms.timing._ROUNDS", rounds)
    delays = random.uniform(LATE, LATE + 1e-3, 60)
    made = -captures(echo, delays, RATE, COUNT) + 0.05 * random.standard_normal((60, COUNT))
    off = echocal.echo_times(made, RATE, template="mean").time - delays
    assert np.abs(off - np.median(off)).max() < 0.5 / 40e3  # the model burst alone fits two cycles alike


def test_the_cramer_rao_bound_is_its_formula(echo: Echo) -> None:
    fine = 16e6
    slope = np.gradient(echo.samples(fine), 1.0 / fine)
    expected = 0.1 / np.sqrt(np.sum(slope**2) * RATE / fine)  # the same density of the noise
    assert cramer_rao_bound(echo.samples(RATE), RATE, 0.1) == pytest.approx(expected, rel=1e-4)


def test_the_ziv_zakai_bound_has_its_limits(echo: Echo) -> None:
    samples, interval = echo.samples(RATE), 1e-3
    strong = ziv_zakai_bound(samples, RATE, 1e-4, interval)
    assert strong == pytest.approx(cramer_rao_bound(samples, RATE, 1e-4), rel=0.01)
    assert ziv_zakai_bound(samples, RATE, 1e6, interval) == pytest.approx(interval / np.sqrt(12.0), rel=0.01)
    bounds = [ziv_zakai_bound(samples, RATE, noise, interval) for noise in np.geomspace(1e-3, 1e2, 8)]
    assert (np.diff(bounds) > 0.0).all()


@pytest.mark.parametrize("method", ESTIMATORS)
def test_no_captures_are_no_echoes(method: str) -> None:
    found = echocal.echo_times(np.zeros((0, 5, COUNT)), RATE, method)
    assert found.time.shape == (0, 5)
    assert str(found) == f"Echo times by {method}: 0 of 0 captures"
