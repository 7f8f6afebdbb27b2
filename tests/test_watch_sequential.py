"""The sequential test: its false alarms, its delay and its dating, on fresh draws."""

import math

import numpy as np
import pytest
from watched import WAIT, noise, temperatures

import echocal
from echocal.watch import WatchSettings
from echocal.watch.monitor import Alarm, Monitor
from echocal.watch.settings import WatchSettings as Numbers
from echocal.watch.signatures import Signatures
from echocal.watch.threshold import (
    cusum_delay,
    cusum_run_length,
    cusum_threshold,
    false_alarm_rate,
    overshoot,
    slack,
    threshold,
)

YEAR = 365.25 * 86400.0


def columns_of(random: np.random.Generator, rows: int) -> np.ndarray:
    """Step and causes at random distances in changing weather [m per prior sd]."""
    temperature = temperatures(random, rows)
    distance = random.uniform(0.5, 3.0, rows)
    found = Signatures(echocal.Model("linear"), ["temperature"]).at(distance, {"temperature": temperature})
    return np.column_stack([np.full(rows, 0.005), found])


def watch(monitor: Monitor, residual: np.ndarray, columns: np.ndarray) -> list[Alarm]:
    alarms = [
        monitor.add(WAIT * i, float(y), x) for i, (y, x) in enumerate(zip(residual, columns, strict=True))
    ]
    return [alarm for alarm in alarms if alarm is not None]


def at_rate(per_row: float, learn: int = 500) -> Monitor:
    return Monitor(WatchSettings(false_alarms=per_row * YEAR / WAIT, learn=learn))


@pytest.mark.statistical
def test_overshoot_is_that_of_a_random_walk(random: np.random.Generator) -> None:
    """Siegmund 1985: nu(x) is the mean of exp(-x R), R a walk's overshoot over a far level."""
    for x in (0.5, 1.0, 2.0):
        walks = np.cumsum(random.normal(0.5 * x, 1.0, (4000, int(80 / x))), axis=1)
        level = 12.0
        first = np.argmax(walks > level, axis=1)
        over = walks[np.arange(len(walks)), first] - level
        sizes = np.exp(-x * over[over > 0.0])
        error = sizes.std() / math.sqrt(len(sizes))
        assert abs(sizes.mean() - overshoot(x)) < 4.0 * error
    assert overshoot(0.2999) == pytest.approx(overshoot(0.3), abs=1e-3)


def test_threshold_has_the_rate_that_it_was_made_for() -> None:
    for rate, directions in ((1e-3, 1), (1e-6, 12)):
        assert false_alarm_rate(threshold(rate, directions), directions) == pytest.approx(rate)


def test_slack_is_one_for_known_noise_and_grows_with_what_is_unknown() -> None:
    known = slack(np.ones(1), np.ones(1), 1e12, 0.9)
    few = slack(np.ones(1), np.ones(1), 100.0, 0.9)
    torn = slack(np.array([1.0, 1.5]), np.array([0.8, 0.2]), 100.0, 0.9)
    assert known == pytest.approx(1.0, abs=1e-5)
    assert few == pytest.approx(math.exp(1.2816 / math.sqrt(200.0)), rel=1e-2)
    assert torn > few


@pytest.mark.statistical
def test_pages_test_has_the_run_lengths_of_siegmund(random: np.random.Generator) -> None:
    """By simulation of Page's test itself: two means of 400 runs."""
    shift, height = 1.0, cusum_threshold(200.0, 1.0)
    for mean in (0.0, shift):
        runs = np.empty(400)
        for run in range(len(runs)):
            level, rows = 0.0, 0
            while level < height:
                steps = shift * (random.standard_normal(64) + mean - 0.5 * shift)
                for step in steps.tolist():
                    level, rows = max(0.0, level + step), rows + 1
                    if level >= height:
                        break
            runs[run] = rows
        error = runs.std() / math.sqrt(len(runs))
        assert abs(runs.mean() - cusum_run_length(shift, height, mean)) < 4.0 * error + 0.05 * runs.mean()


@pytest.mark.statistical
@pytest.mark.slow
@pytest.mark.parametrize(("rho", "theta"), [(0.0, 0.0), (0.9, 0.0), (0.95, 0.8)])
def test_false_alarms_are_not_more_than_stated(rho: float, theta: float, random: np.random.Generator) -> None:
    """Eight logs at a rate of at most 1/1000 rows."""
    rows, logs, rate, alarms, unlucky = 2500, 8, 1e-3, 0, 0
    for _ in range(logs):
        monitor = at_rate(rate)
        own = len(watch(monitor, noise(random, rows, rho, theta), columns_of(random, rows)))
        alarms += own
        unlucky += own > 6  # of 2 expected: the rate of this log's threshold is higher than stated
    assert unlucky <= 3  # 1 in 10 may be, by the certainty of the settings
    assert alarms <= 29  # 16 expected at most


@pytest.mark.slow
def test_an_outlier_is_no_change(random: np.random.Generator) -> None:
    residual = noise(random, 1500)
    residual[[900, 1100, 1101, 1300]] += [1.0, -0.5, 0.3, 2.0]
    assert watch(Monitor(WatchSettings()), residual, columns_of(random, 1500)) == []


@pytest.mark.statistical
@pytest.mark.slow
def test_a_step_and_a_drift_are_told_in_time_and_dated(random: np.random.Generator) -> None:
    """Twice the delay at which the information reaches log(run length), in nearly all of 12 logs.

    docs/method/several-tables.md, Eq. 56.
    ."""
    run_length = YEAR / WAIT / WatchSettings().false_alarms
    late = missed = told = 0
    for log in range(12):
        rows, at = 1600, 900
        residual = noise(random, rows)
        if log % 2:
            slope = 2e-3 * WAIT / 86400.0  # 2 mm a day
            residual[at:] += slope * np.arange(rows - at)
            allowed = (6.0 * math.log(run_length) / (slope / 1e-3) ** 2) ** (1.0 / 3.0)
        else:
            residual[at:] += 1e-3
            allowed = 2.0 * math.log(run_length)
        alarms = watch(Monitor(WatchSettings()), residual, columns_of(random, rows))
        told += bool(alarms)
        if alarms:
            late += alarms[0].row - at > 2.0 * allowed + 5.0
            onset = alarms[0].onset
            missed += not onset.low <= at + 1 <= onset.high
    assert told == 12
    assert late <= 3
    assert missed <= 3  # 95 % intervals


def test_no_test_is_faster_than_pages_test() -> None:
    """The bound grows with the logarithm of the run length, divided by the information of a row."""
    for shift in (0.5, 1.0):
        assert cusum_delay(10_000.0, 1.0) == pytest.approx(15.0, abs=0.05)
        gained = cusum_delay(1e8, shift) - cusum_delay(1e6, shift)
        assert gained == pytest.approx(2.0 * math.log(100.0) / shift**2, rel=0.02)


def test_memory_does_not_grow_with_the_rows(random: np.random.Generator) -> None:
    monitor = at_rate(1e-9, learn=200)
    sizes = []
    for i, value in enumerate(noise(random, 6000).tolist()):
        monitor.add(WAIT * i, value, np.array([0.005]))
        if i in (2999, 5999):
            sizes.append(len(monitor.onsets.rows))
    assert sizes[1] <= sizes[0] + 2 * WatchSettings().onsets
    assert sizes[1] <= 8 * (math.log2(6000.0) + 1)


def test_every_number_that_decides_says_what_it_is_and_where_it_comes_from() -> None:
    for name, _, unit, source in Numbers.listed():
        assert unit, name
        assert len(source.split()) >= 5, f"{name}: {source}"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"false_alarms": 0.0}, "give a number above 0"),
        ({"learn": 3}, "learns from 3 rows; give 50 to 100000"),
    ],
)
def test_impossible_numbers_are_refused(given: dict[str, float], says: str) -> None:
    with pytest.raises(echocal.UsageError, match=says):
        WatchSettings(**given)  # type: ignore[arg-type]
