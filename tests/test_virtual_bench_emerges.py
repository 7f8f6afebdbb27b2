"""What nobody wrote into the bench and what must be there: it comes from waves, noise and a threshold.

Each test says why in terms of physics, and draws its scene anew.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from echocal.virtual_bench import Scene, Sensor, Target, measure
from echocal.virtual_bench.waveform.fluctuations import Turbulence

Column = NDArray[np.float64]

PERIOD = 25e-6  # s
QUIET = Sensor(noise=1e-9, burst_scatter=0.0)
FIXED = QUIET.but(raised=0.0, blanking=1.6e-3)  # one threshold at all times
DETUNED = 41e3  # Hz


def jumps(delay: Column) -> Column:
    """Steps of a staircase [s]."""
    change = np.diff(delay)
    return change[np.abs(change) > 0.4 * PERIOD]


def test_a_weaker_echo_comes_whole_cycles_later(random: np.random.Generator) -> None:
    """The threshold is crossed near a crest; as the echo weakens, it sinks below, and the next one counts.

    The zero crossings are a period of the drive apart, or of the resonance that is pulled along. The crest
    that has just sunk was crossed at its tip, the next one is crossed on its flank: so a step is up to 3 us
    shorter than the period.
    """
    n = 4000
    loud = np.linspace(1.0, 0.12, n)
    scene = Scene(np.full(n, random.uniform(0.5, 1.2)), louder=loud, temperature=random.uniform(0, 40))
    delay = measure(scene, FIXED, random).delay
    steps = jumps(delay[~np.isnan(delay)])
    assert len(steps) >= 2
    assert ((steps > 21e-6) & (steps < 25.2e-6)).all()
    slow = np.diff(delay)[np.abs(np.diff(delay)) < 0.4 * PERIOD]
    assert (slow > -0.1e-6).all()  # between the steps it comes later, too, along the flank


def test_single_readings_slip_near_an_edge_of_the_staircase(random: np.random.Generator) -> None:
    """Noise moves a crest above or below the threshold: two clusters a cycle apart, without memory."""
    n = 4000
    loud = np.linspace(1.0, 0.2, n)
    distance = random.uniform(0.5, 1.2)
    delay = measure(Scene(np.full(n, distance), louder=loud), FIXED, random).delay
    edge = loud[:-1][np.diff(delay) > 0.4 * PERIOD][0]
    noisy = replace(FIXED, noise=4e-4)
    near, between = (
        measure(Scene(np.full(n, distance), louder=level), noisy, random).delay
        for level in (edge, 1.12 * edge)
    )
    late = near > 0.5 * (near.min() + near.max())  # half of each: the median may lie between the two
    assert 0.1 < late.mean() < 0.9
    assert np.abs(near[late].mean() - near[~late].mean() - 23.5e-6) < 2e-6
    assert abs(np.corrcoef(late[1:], late[:-1])[0, 1]) < 5 / np.sqrt(n)
    assert (np.abs(between - np.median(between)) > 0.4 * PERIOD).mean() < 0.02


def test_a_slip_is_held_as_long_as_the_hand_does_not_move(random: np.random.Generator) -> None:
    """Each placement has an amplitude of its own: most placements stand on one step, the steps differ."""
    placements, each = 60, 20
    hand = np.exp(0.5 * np.repeat(random.normal(size=placements), each))
    scene = Scene(np.full(placements * each, random.uniform(1.0, 1.5)), louder=hand)
    delay = measure(scene, replace(FIXED, noise=1e-4), random).delay.reshape(placements, each)
    held = np.median(delay, axis=1)
    assert (np.abs(delay - held[:, None]) > 0.4 * PERIOD).mean() < 0.1
    assert (np.abs(held - np.median(held)) > 0.4 * PERIOD).mean() > 0.15


def test_the_walk_has_either_sign(random: np.random.Generator) -> None:
    """An echo weakens with the distance: at one threshold it comes later. A threshold that sinks faster than
    the echo weakens is crossed earlier.
    """
    temperature = random.uniform(10, 35)

    def slope(sensor: Sensor, near: float, far: float) -> float:
        distance = np.linspace(near, far, 400)
        delay = measure(Scene(distance, temperature=temperature), sensor, random).delay
        return float(np.polyfit(distance, delay, 1)[0])

    assert 15e-6 < slope(FIXED, 0.3, 1.5) < 150e-6  # s/m
    assert -150e-6 < slope(QUIET, 0.15, 0.7) < -15e-6  # from about 0.7 m on, its threshold stands


def test_near_targets_are_told_by_a_later_echo_or_by_the_own_burst(random: np.random.Generator) -> None:
    """A deaf sensor hears the second or third echo of a wall; one that listens too soon hears itself."""
    blanked = QUIET.but(blanking=2e-3, raised=0.0)
    distance = random.uniform(0.1, 0.25, 50)
    echo = measure(Scene(distance, target=Target(half_width=1.0, half_height=1.0)), blanked, random).time
    ratio = (echo + blanked.zero) * 344.0 / (2 * distance)
    assert (echo + blanked.zero > 2e-3).all()
    assert np.all(ratio > 1.3)
    hasty = QUIET.but(raised=0.0, blanking=0.15e-3)
    far = measure(Scene(random.uniform(1, 3, 50)), hasty, random).time
    assert (far < 1e-3).all()  # the ring-down on the board
    assert (measure(Scene(random.uniform(1, 3, 50)), QUIET, random).time > 5e-3).all()


def test_a_tilted_or_far_or_soft_target_is_missed(random: np.random.Generator) -> None:
    """A mirror throws the sound past the sensor; spreading, and the air, take it; so does a soft surface."""
    plate = Target(half_width=0.15, half_height=0.15)
    distance = np.full(200, random.uniform(1.0, 2.0))

    def missed(target: Target, where: Column) -> float:
        return float(np.isnan(measure(Scene(where, target=target), QUIET, random).time).mean())

    assert missed(plate, distance) == 0.0
    assert missed(replace(plate, tilt=0.6), distance) == 1.0
    assert missed(plate, np.full(200, 6.0)) == 1.0
    assert missed(replace(plate, reflectivity=0.02), distance) == 1.0
    in_order = 0
    for away in random.uniform(1.0, 2.0, 5):  # an echo may come back between two lobes
        where, tilts = np.full(50, away), np.linspace(0, 0.6, 13)
        lost = [missed(replace(plate, tilt=tilt), where) for tilt in tilts]
        in_order += lost == sorted(lost)
    assert in_order >= 4


def test_the_floor_speaks_where_the_target_is_narrow(random: np.random.Generator) -> None:
    """The echo by the floor is as loud as the direct one and comes later: both interfere.

    With the distance the two ways differ by 2 h^2 / d, so the delay waves, slower and slower.
    """
    distance = np.linspace(0.5, 2.5, 1500)
    narrow = Target(half_width=0.02, half_height=0.15)
    bare, floored = (
        measure(Scene(distance, target=narrow, floor=floor, floor_reflectivity=0.9), FIXED, random).delay
        for floor in (np.inf, random.uniform(0.15, 0.2))
    )
    both = ~np.isnan(bare) & ~np.isnan(floored)
    other = np.abs(floored - bare)[both]
    assert both.mean() > 0.5
    assert (other > 1e-6).mean() > 0.1
    assert np.quantile(other, 0.98) > 15e-6


def test_a_burst_from_a_cold_pump_comes_late(random: np.random.Generator) -> None:
    """The first burst after a rest is driven by a lower voltage: it is later by the walk, or by a cycle."""
    bursts, order = 400, np.arange(5)
    cold = np.tile(np.where(order == 0, 0.8, 1.0), bursts)
    distance = np.repeat(random.uniform(0.5, 1.5, bursts), len(order))
    delay = measure(Scene(distance, supply=cold), replace(FIXED, noise=1e-4), random).delay.reshape(
        bursts, -1
    )
    first = delay[:, 0] - np.median(delay[:, 1:], axis=1)
    rest = delay[:, 1] - np.median(delay[:, 1:], axis=1)
    assert first.mean() > 1e-6
    assert (first > 0.4 * PERIOD).mean() > (np.abs(rest) > 0.4 * PERIOD).mean() + 0.05


def test_another_sensor_is_heard_as_a_near_target(random: np.random.Generator) -> None:
    """Its burst comes whenever it comes: before the echo it is told as a distance, after it as nothing."""
    distance = np.full(500, random.uniform(1.5, 2.5))
    arrives = random.uniform(4e-3, 25e-3, 500)  # while the threshold is still up, nothing is heard
    alone = measure(Scene(distance), QUIET, random).time
    heard = measure(Scene(distance, other_time=arrives, other_size=0.4), QUIET, random).time
    before = arrives < alone[0] - 0.5e-3
    assert (heard[before] < alone[before]).all()
    assert np.all(np.abs(heard[before] + QUIET.zero - arrives[before] - 0.1e-3) < 0.1e-3)
    after = arrives > alone[0] + QUIET.zero + 0.1e-3
    np.testing.assert_array_equal(heard[after], alone[after])


def test_a_transducer_that_has_left_its_frequency_comes_late(random: np.random.Generator) -> None:
    """Off its resonance it answers with beats and weakly: a weak echo crosses later or earlier by cycles.

    A loud echo moves less: its first cycles grow with the drive, whatever the resonance.
    """
    celsius = np.linspace(-20, 60, 200)
    far = np.full(200, random.uniform(0.6, 1.0))
    scene = Scene(far, temperature=20.0, device_temperature=celsius, louder=0.1)
    drifting = replace(
        FIXED,
        transmitter=replace(FIXED.transmitter, drift=-60.0),
        receiver=replace(FIXED.receiver, drift=-60.0),
    )
    steady = replace(
        FIXED,
        transmitter=replace(FIXED.transmitter, drift=0.0),
        receiver=replace(FIXED.receiver, drift=0.0),
    )
    moves, stands = (measure(scene, sensor, random).delay for sensor in (drifting, steady))
    assert np.ptp(stands) < 1e-6
    weak = np.nanmax(moves) - np.nanmin(moves)
    assert weak > 15e-6
    assert np.ptp(measure(replace(scene, louder=3.0), drifting, random).delay) < weak


def test_turbulence_remembers_and_grows(random: np.random.Generator) -> None:
    """Delays of neighbors agree, those of other paths do not; a way that is longer scatters more.

    Over a way shorter than a cell the standard deviation goes with the way, over a long one with its root.
    """
    n = 4000
    own = Turbulence(way=1e-3, log_amplitude=0.1)
    seconds, path = np.arange(n) * 0.2, np.zeros(n, dtype=np.int64)
    way, louder = own.draw(seconds, np.full(n, 1.0), path, random)
    assert np.corrcoef(way[1:], way[:-1])[0, 1] == pytest.approx(np.exp(-0.2 / 2.0), abs=0.05)
    assert np.corrcoef(way, np.log(louder))[0, 1] == pytest.approx(0.0, abs=0.15)
    apart, _ = own.draw(seconds, np.full(n, 1.0), np.arange(n), random)
    assert abs(np.corrcoef(apart[1:], apart[:-1])[0, 1]) < 0.08
    spread = [
        np.std(own.draw(seconds, np.full(n, far), np.arange(n), random)[0]) for far in (0.1, 0.2, 1, 40, 160)
    ]
    assert spread[2] == pytest.approx(1e-3, rel=0.06)
    assert spread[1] / spread[0] == pytest.approx(2.0, rel=0.1)
    assert spread[4] / spread[3] == pytest.approx(2.0, rel=0.1)
