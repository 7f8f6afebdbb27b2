"""Waveforms of the bench: against other ways to compute the same."""

import ast
import sys
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lsim

import echocal.virtual_bench
from echocal.virtual_bench import Comparator, Resonance, Scene, Sensor, Target, measure, waveform
from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.measure import received
from echocal.virtual_bench.waveform.received import Noise, Received, first_crossing

Column = NDArray[np.float64]

FOLDER = Path(echocal.virtual_bench.__file__).parent
ALLOWED = {"numpy", "scipy", "pandas", "echocal.errors", "echocal.keywords", "echocal.shown"}
ALLOWED |= {"echocal.virtual_bench"}
HUNDREDTH_OF_A_CYCLE = 0.2e-6  # s
TIMES_ARE_KNOWN_TO = 2e-8  # s: straight lines and the end of the search are wrong by half of it at most


def imported(path: Path) -> set[str]:
    """Full names of the modules and members that a file imports."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide where a module comes from"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_the_bench_shares_nothing_with_what_it_tests() -> None:
    files = sorted(FOLDER.rglob("*.py"))
    assert files
    for path in files:
        for name in imported(path) - {"__future__"}:
            own = name.split(".")[0] in sys.stdlib_module_names
            assert own or any(f"{name}.".startswith(f"{allowed}.") for allowed in ALLOWED), f"{path}: {name}"
        assert "importlib" not in path.read_text(encoding="utf-8")


def drawn_sensor(random: np.random.Generator, noise: float) -> Sensor:
    """One of the transducers that are sold, with each kind of threshold in turn."""
    kinds: list[dict[str, object]] = [
        {"raised": 0.0, "threshold": random.uniform(0.005, 0.1)},
        {"threshold": 0.0127, "raised": random.uniform(10, 200), "recovery": random.uniform(4e-4, 3e-3)},
        {"raised": 0.0, "threshold": 0.02, "steps": ((random.uniform(1e-3, 3e-3), 8.0), (6e-3, 3.0))},
    ]
    return Sensor(
        noise=noise,
        burst_scatter=0.0,
        transmitter=Resonance(random.uniform(39.5e3, 40.7e3), random.uniform(20, 46), -40.0),
        receiver=Resonance(random.uniform(39.5e3, 40.9e3), random.uniform(20, 46), -40.0),
    ).but(blanking=random.uniform(0.1e-3, 1.5e-3), **kinds[random.integers(3)])


def drawn_scene(random: np.random.Generator, n: int) -> Scene:
    """Several paths, tilted targets, poles, something in front."""
    target = Target(
        tilt=random.normal(0, 0.15, n),
        half_width=random.uniform(0.03, 0.5),
        radius=random.choice([np.inf, 0.02, 1.0]),
    )
    return Scene(
        random.uniform(0.05, 3.5, n),
        temperature=random.uniform(-10, 50, n),
        relative_humidity=random.uniform(0.1, 0.9),
        target=target,
        floor=random.choice([np.inf, 0.2, 0.5]),
        wall=random.choice([np.inf, 0.6]),
        object_distance=random.choice([np.inf, 0.7]),
        object_aside=0.05,
        other_time=np.where(random.uniform(size=n) < 0.2, random.uniform(1e-3, 2e-2, n), np.inf),
    )


def test_a_burst_through_resonances_is_what_lsim_computes(random: np.random.Generator) -> None:
    rate, cycles = 20e6, int(random.integers(4, 17))
    chain = [Resonance(random.uniform(36e3, 44e3), random.uniform(1, 60), -40.0) for _ in range(3)]
    chain.append(chain[0])  # two at one frequency
    celsius = random.uniform(-20, 60)
    time = np.arange(0, 2e-3, 1 / rate)
    voltage = np.where(time < cycles / 40e3, np.sin(2 * np.pi * 40e3 * time), 0.0)
    for one in chain:
        omega = 2 * np.pi * (one.center - 40.0 * (celsius - 25.0))
        transfer = ([omega / one.quality, 0.0], [1.0, omega / one.quality, omega**2])
        voltage = lsim(transfer, voltage, time)[1]
    response = BurstResponse.of(chain, 40e3, cycles, np.array([celsius]))
    ours = (response.envelope(time[None])[0] * np.exp(2j * np.pi * 40e3 * time)).real
    # Of the two at one frequency the bench moves one by 1 Hz: a thousandth of the widest decay.
    assert ours == pytest.approx(voltage, abs=5e-3 * np.abs(voltage).max())
    assert np.abs(response.envelope(time[None])).max() <= response.peak


def first_lasting(time: Column, over: Column, lasting: float) -> Column:
    """First time from which the voltage stays above 0 for so long; infinite: none.

    The voltage is a straight line between two samples, and nothing after the last one.
    """
    found = np.full(len(over), np.inf)
    for row, voltage in enumerate(over):
        above = voltage > 0
        at = np.flatnonzero(above[1:] != above[:-1])
        turns = time[at] + np.diff(time)[at] * voltage[at] / (voltage[at] - voltage[at + 1])
        turns = np.concatenate([time[:1][above[:1]], turns, time[-1:][above[-1:]]])
        rises, falls = turns[0::2], turns[1::2]
        found[row] = min(rises[falls - rises > lasting], default=np.inf)
    return found


def sampled_crossing(
    signal: Received, start: Column, cycles: int, comparator: Comparator
) -> tuple[Column, ...]:
    """When a crossing is told at the earliest and at the latest, by 500 samples a cycle.

    A crest may last as long as the comparator needs, to what the times of either side are known to.
    """
    steps = [until for until, _ in comparator.steps]
    told = np.full((2, len(start)), np.inf)
    for row in range(len(start)):
        time = start[row] + np.arange(0.0, cycles / 40e3 + comparator.response_time, 1 / 20e6)
        sides = np.array([(np.nextafter(step, 0.0), step) for step in steps]).ravel()
        time = np.union1d(time, sides[(time[0] <= sides) & (sides <= time[-1])])
        over = signal.at(np.array([row])).voltage(time[None]) - comparator.at(time)
        for side, apart in enumerate((-TIMES_ARE_KNOWN_TO, TIMES_ARE_KNOWN_TO)):
            told[side, row] = first_lasting(time, over, comparator.response_time + apart)[0]
    return tuple(told + comparator.response_time)


@pytest.mark.parametrize("noise", [1e-6, 6e-4, 2e-3])
def test_crossings_are_those_of_the_sampled_waveform(random: np.random.Generator, noise: float) -> None:
    """The same noise in both. The standard deviation of the loudest is above a tenth of many thresholds."""
    n, cycles = 60, 24
    for _ in range(4):
        scene, sensor = drawn_scene(random, n), drawn_sensor(random, noise)
        comparator = sensor.comparator
        signal = received(scene, sensor)
        start = signal.delays[np.arange(n), random.integers(0, signal.delays.shape[1], n)]
        start = np.maximum(np.where(np.isfinite(start), start, 0.0), comparator.blanking)
        signal = replace(signal, noise=Noise.draw(sensor, start, 2 * cycles + 1, random))
        ours = np.nan_to_num(first_crossing(signal, start, cycles, comparator), nan=np.inf)
        early, late = sampled_crossing(signal, start, cycles, comparator)
        assert (ours >= early - HUNDREDTH_OF_A_CYCLE).all()
        assert (ours <= late + HUNDREDTH_OF_A_CYCLE).all()


def test_the_threshold_may_step_in_the_midst_of_a_crest(random: np.random.Generator) -> None:
    """A voltage that falls below the old threshold before the step has not lasted."""
    cycles, scene = 16, drawn_scene(random, 60)
    signal = received(scene, Sensor(burst_scatter=0.0))
    start = signal.delays[:, 1]
    for row in range(60):
        here, begin = signal.at(np.array([row])), start[[row]]
        time = begin + np.arange(0.0, cycles / 40e3, 1 / 20e6)
        voltage = here.voltage(time[None])[0]
        step = float(time[voltage.argmax()]) + random.uniform(-3e-6, 4e-6)
        high = max(float(voltage.max()), 1e-9) * random.uniform(0.85, 1.0)
        comparator = Comparator(threshold=0.5 * high, raised=0.0, steps=((step, 2.0),))
        ours = np.nan_to_num(first_crossing(here, begin, cycles, comparator), nan=np.inf)
        early, late = sampled_crossing(here, begin, cycles, comparator)
        assert (ours >= early - HUNDREDTH_OF_A_CYCLE).all()
        assert (ours <= late + HUNDREDTH_OF_A_CYCLE).all()


def test_readings_are_the_first_crossings_of_the_whole_waveform(random: np.random.Generator) -> None:
    """Without noise, over all windows, steps, blanking: nothing is skipped and nothing is invented."""
    tolerance = HUNDREDTH_OF_A_CYCLE + 1 / 2.5e6
    for _ in range(4):
        scene, sensor = drawn_scene(random, 20), drawn_sensor(random, 1e-9)
        sensor = replace(sensor, zero=0.0, tick=1e-9, timeout=15e-3)
        echo, response = measure(scene, sensor, random).time, sensor.comparator.response_time
        elapsed, voltage = waveform(scene, sensor, sample_rate=2.5e6)
        over = np.where(elapsed > sensor.comparator.blanking, voltage / sensor.comparator.at(elapsed), 0.0)
        # A crest, or what a step of the threshold leaves of it, may last for a sample more or less.
        early, late = (
            first_lasting(elapsed, over - 1 - 0.005 * more, response + more / 2.5e6) + response
            for more in (-1, 1)
        )
        told = np.where(np.isnan(echo), np.inf, echo)
        assert (told >= early - tolerance).all()
        assert (told <= late + tolerance).all()


def test_noise_is_as_strong_everywhere_and_crosses_as_often_as_rice_says(random: np.random.Generator) -> None:
    sensor = Sensor(noise=1.0, coupling=0.0, timeout=20e-3)
    nowhere = Scene(np.full(100, 50.0))  # the echo of a wall there comes after the time-out
    elapsed, voltage = waveform(nowhere, sensor, random, sample_rate=2e6)
    periods = voltage[:, : 50 * (len(elapsed) // 50)].reshape(100, -1, 50)  # a period of the carrier each
    assert np.std(periods, axis=(0, 1)) == pytest.approx(np.ones(50), abs=0.02)
    for height in (1.5, 2.5):
        counted = ((voltage[:, :-1] <= height) & (voltage[:, 1:] > height)).sum() / (100 * elapsed[-1])
        expected = Noise.rate(sensor) * np.exp(-0.5 * height**2)
        assert counted == pytest.approx(expected, rel=0.08)  # 3,600 crossings at the least, in clumps of two


@pytest.mark.parametrize("raised", [0.0, 5.0])
def test_false_triggers_come_as_often_and_as_late_as_in_sampled_noise(
    random: np.random.Generator, raised: float
) -> None:
    """Where no echo comes, the time of the first false trigger has the same distribution in both."""
    n, level = 300, random.uniform(3.0, 3.6)  # above the noise, in standard deviations
    sensor = Sensor(noise=1e-3, coupling=0.0, zero=0.0, timeout=10e-3)
    sensor = sensor.but(threshold=1e-3 * level, raised=raised, recovery=3e-3, blanking=0.1e-3)
    echo = measure(Scene(np.full(10 * n, 50.0)), sensor, random).time
    nowhere = Scene(np.full(n, 50.0))
    elapsed, voltage = waveform(nowhere, sensor, random, sample_rate=2e6)
    over = np.where(elapsed > sensor.comparator.blanking, voltage - sensor.comparator.at(elapsed), -1.0)
    sampled = first_lasting(elapsed, over, sensor.comparator.response_time)
    for until in (3e-3, 10e-3):
        ours, theirs = np.mean(echo <= until), np.mean(sampled <= until)
        error = np.sqrt(theirs * (1 - theirs) / n) + 1 / n
        assert ours == pytest.approx(theirs, abs=4 * error)


def test_the_same_seed_gives_the_same_readings_with_any_number_of_threads(
    random: np.random.Generator,
) -> None:
    scene, seed = drawn_scene(random, 5000), int(random.integers(2**32))
    one, four, other = (
        measure(scene, random=np.random.default_rng(s), threads=threads).time
        for s, threads in ((seed, 1), (seed, 4), (seed + 1, 4))
    )
    np.testing.assert_array_equal(one, four)
    assert (one != other).any()


def test_vectors_beat_a_loop(random: np.random.Generator) -> None:
    """How many readings a second it makes is measured by benches/virtual_bench.py."""
    scene = drawn_scene(random, 2000)
    times = []
    for rows in ([np.arange(2000)], [np.array([row]) for row in range(40)]):
        begin = process_time()
        for some in rows:
            measure(scene.at(some), random=random, threads=1)
        times.append((process_time() - begin) / sum(map(len, rows)))
    assert times[0] < times[1] / 10
