"""What cannot be is refused in one line that names the thing, its value, its limit and the way out."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from echocal.errors import UsageError
from echocal.virtual_bench import CAUSES, Resonance, Scene, Sensor, Target, measure, simulate

TWO = np.array([0.5, 1.0])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"distance": np.array([0.5, 0.0])}, "distance is 0 m in reading 2; it must be more than 0 m"),
        ({"distance": np.array([-0.2, 1.0])}, "distance is -0.2 m in reading 1; it must be more than 0 m"),
        ({"distance": np.array([np.nan, 1.0])}, "distance is nan m in reading 1"),
        ({"distance": np.array([0.5, np.inf])}, "distance is inf m in reading 2"),
        ({"relative_humidity": 50.0}, "relative_humidity is 50; it must be .* write 0.5 for 50 %"),
        ({"relative_humidity": np.array([0.5, -0.1])}, "relative_humidity is -0.1 in reading 2"),
        ({"temperature": -300.0}, "temperature is -300 degC; it must be more than -273.15 degC"),
        ({"device_temperature": -300.0}, "device_temperature is -300 degC"),
        ({"temperature": np.full(3, 20.0)}, r"temperature has the shape \(3,\), and distance has 2 readings"),
        ({"pressure": 0.0}, "pressure is 0 Pa; it must be more than 0 Pa"),
        ({"wind_along": 400.0}, "wind_along is 400 m/s; it must be from -250 to 250 m/s"),
        ({"supply": 0.0}, "supply is 0; it must be more than 0"),
        ({"louder": -1.0}, "louder is -1; it must be at least 0"),
        ({"floor": 0.0}, "floor is 0 m; it must be more than 0 m: inf stands for none"),
        ({"object_distance": -1.0}, "object_distance is -1 m"),
        ({"other_time": np.nan}, "other_time is nan s"),
    ],
)
def test_a_scene_that_cannot_be(given: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        Scene(**({"distance": TWO} | given))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"half_width": 0.0}, "target.half_width is 0 m; it must be more than 0 m"),
        ({"half_height": -0.1}, "target.half_height is -0.1 m"),
        ({"radius": 0.0}, "target.radius is 0 m"),
        ({"reflectivity": 1.5}, "target.reflectivity is 1.5; it must be from 0 to 1"),
        ({"tilt": 2.0}, "target.tilt is 2 rad; .*turned further, it shows its back"),
        ({"roughness": np.array([0.0, -1e-3])}, "target.roughness is -0.001 m in reading 2"),
        ({"offset": np.inf}, "target.offset is inf m; it must be a finite number"),
    ],
)
def test_a_target_that_cannot_be(given: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        Target(**given)


def test_a_target_that_shows_its_back() -> None:
    """Beside the axis and turned away: its plane runs behind the sensor."""
    with pytest.raises(UsageError, match=r"reading 1 shows its back .* at 0.5 m, 1 m off the axis"):
        Scene(TWO, target=Target(tilt=0.6, offset=1.0))
    Scene(TWO, target=Target(tilt=-0.6, offset=1.0))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sensor(noise=-1.0), "sensor.noise is -1; it must be at least 0"),
        (lambda: Sensor(piston=0.0), "sensor.piston is 0 m"),
        (lambda: Sensor(cycles=0), "sensor.cycles is 0; it must be at least 1"),
        (lambda: Sensor().but(threshold=0.0), "comparator.threshold is 0; it must be more than 0"),
        (lambda: Sensor().but(recovery=np.nan), "comparator.recovery is nan s"),
        (lambda: Resonance(quality=0.4), "quality of a resonance is 0.4; it must be more than 0.5"),
        (lambda: Resonance(center=-1.0), "center of a resonance is -1 Hz"),
    ],
)
def test_a_sensor_that_cannot_be(make: Callable[[], object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        make()


def test_what_is_rare_but_possible() -> None:
    """Ends of the limits, and things without end."""
    scene = Scene(
        TWO,
        relative_humidity=np.array([0.0, 1.0]),
        temperature=-80.0,
        louder=0.0,
        target=Target(half_width=np.inf, half_height=np.inf, reflectivity=0.0),
    )
    assert np.isnan(measure(scene, Sensor(noise=0.0), np.random.default_rng(0)).time).all()
    assert measure(Scene(TWO[:0])).time.shape == (0,)


@pytest.mark.parametrize("size", [np.nan, np.inf, -np.inf])
def test_a_size_that_is_no_number(size: float) -> None:
    with pytest.raises(UsageError, match=r"zero_error=.*its size is from -0.15 to 0.15"):
        simulate("quick", {"zero_error": size})


@pytest.mark.parametrize("name", ["divisor", "polling_jitter", "timer_quantization", "reference_error"])
def test_a_size_of_the_wrong_sign(name: str) -> None:
    for size in (0.0, -CAUSES[name].high, 11 * CAUSES[name].high):
        with pytest.raises(UsageError, match=f"{name}=.*usual is"):
            simulate("quick", {name: size})


def test_two_causes_that_cannot_be_together(random: np.random.Generator) -> None:
    """Each size is possible; together they put the target behind the sensor."""

    def draw_until_one_cannot_be() -> None:
        for seed in random.integers(2**31, size=50):  # each draws its nearest place, 0.15 to 0.3 m
            simulate("quick", {"zero_error": -0.15, "drift": -0.1}, seed=int(seed))

    words = r"quick with zero_error=-0.15 and drift=-0.1 cannot be: distance is -.*give a smaller size"
    with pytest.raises(UsageError, match=words):
        draw_until_one_cannot_be()


def test_the_command_says_it_in_a_line(run: Callable[..., tuple[int, str]]) -> None:
    code, text = run("simulate", "--design", "quick", "--cause", "zero_error=-3")
    assert code == 2
    assert "zero_error=-3: its size is from -0.15 to 0.15" in " ".join(text.split())
    assert "Traceback" not in text
