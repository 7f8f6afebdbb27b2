"""What clears a table of faults at a glance clears none that a closer look would find."""

from collections.abc import Callable
from unittest.mock import PropertyMock, patch

import numpy as np
import pytest

import echocal
from echocal.diagnose.faults.registry import FAULTS
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings

ROWS = 120
Table = dict[str, np.ndarray]


def plain() -> Table:
    random = np.random.default_rng(8)
    temperature = 18 + 6 * np.sin(np.arange(ROWS) / 9)
    distance = random.uniform(0.3, 3.5, ROWS).round(2)
    humidity = random.uniform(0.3, 0.6, ROWS)
    echo = 2 * distance / echocal.speed_of_sound(temperature, humidity) + random.normal(0, 5e-6, ROWS)
    return {
        "echo_s": echo,
        "temperature_C": temperature,
        "distance_m": distance,
        "humidity_percent": 100 * humidity,
    }


def changed(column: str, rows: slice, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Table], None]:
    def spoil(table: Table) -> None:
        table[column][rows] = change(table[column][rows])

    return spoil


def swapped(table: Table) -> None:
    warm, humid = table["temperature_C"], table["humidity_percent"]
    warm[70:], humid[70:] = humid[70:].copy(), warm[70:].copy()


SPOILED: dict[str, Callable[[Table], None]] = {
    "nothing": lambda table: None,
    "twice": changed("echo_s", slice(None), lambda x: 2 * x),
    "feet": changed("distance_m", slice(None), lambda x: 0.3048 * x),
    "some in cm": changed("echo_s", slice(3, 90, 11), lambda x: 0.01 * x),
    "shifted": changed("echo_s", slice(60, None), lambda x: np.roll(x, 1)),
    "timeout": changed("echo_s", slice(5, 100, 17), lambda x: np.full(len(x), 38e-3)),
    "wild": changed("echo_s", slice(4, 100, 31), lambda x: 1.6 * x),
    "short": changed("echo_s", slice(4, 100, 31), lambda x: 0.7 * x),
    "near a limit": changed("echo_s", slice(4, 100, 31), lambda x: x + 60e-6),
    "fahrenheit": changed("temperature_C", slice(None), lambda x: 32 + 1.8 * x),
    "some fahrenheit": changed("temperature_C", slice(2, 100, 25), lambda x: 32 + 1.8 * x),
    "swapped": swapped,
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("spoil", SPOILED.values(), ids=SPOILED.keys())
def test_with_the_glance_and_without(spoil: Callable[[Table], None]) -> None:
    table = plain()
    spoil(table)
    data = echocal.read_observations(table, reading_speed="linear", trust=list(table))

    def findings() -> list[tuple[str, float] | None]:
        view = View(data, Base.of("linear"), None, True)
        found = (fault.search(view, FaultSettings()) for fault in FAULTS)
        return [(f.because, f.log_bayes) if f and f.log_bayes > 0.0 else None for f in found]

    glanced = findings()
    far, wide = PropertyMock(return_value=np.inf), PropertyMock(return_value=(0.0, np.inf))
    with patch.object(View, "farthest", far), patch.object(View, "ratios", wide):
        assert findings() == glanced
    assert far.called
    assert wide.called
