"""What MicroPython and CircuitPython bring to an example: pins and a clock; and a virtual HC-SR04."""

import sys
import types
from collections.abc import Iterator

import pytest

SILENCE = 450e-6  # s from trigger to pulse
LATER = 0.0655  # s after a pulse until an ESP32 tells of it
MOST = 65_535  # us, the longest pulse that PulseIn tells
BOARDS = ("micropython", "circuitpython", "circuitpython on an ESP32")


class EnoughError(Exception):
    """Leaves the endless loop of an example."""


class Sensor:
    """A clock, and the echo pulses of a module; 0 is none at all."""

    def __init__(self, pulses: list[int]) -> None:
        self.now = 0.0
        self.pulses = iter(pulses)
        self.rise = self.fall = -1.0

    def wait(self, seconds: float) -> None:
        self.now += seconds

    def trigger(self, level: int) -> None:
        if level or self.sounding():  # a module hears no trigger while it sounds
            return
        length = next(self.pulses, None)
        if length is None:
            raise EnoughError
        self.rise = self.now + SILENCE if length else -1.0
        self.fall = self.rise + length * 1e-6

    def sounding(self) -> bool:
        return self.rise <= self.now < self.fall

    def time_pulse_us(self, _pin: object, _level: int, timeout: int) -> int:
        """As extmod/machine_pulse.c: timing starts at once where the pin is high already."""
        if not self.sounding() and (self.rise < self.now or self.rise - self.now > timeout * 1e-6):
            self.wait(timeout * 1e-6)
            return -2
        start = max(self.now, self.rise)
        length = min(self.fall - start, timeout * 1e-6)
        self.now = start + length
        return round(length * 1e6) if self.now >= self.fall else -1


class Pulses:
    """As shared-bindings/pulseio; an ESP32 tells of a pulse after a long pause, and of that too."""

    def __init__(self, sensor: Sensor, slow: bool, maxlen: int) -> None:
        self.sensor, self.slow, self.maxlen = sensor, slow, maxlen
        self.since, self.paused = 0.0, False

    def pause(self) -> None:
        self.paused = True

    def clear(self) -> None:
        self.since = self.sensor.now

    def resume(self) -> None:
        assert self.paused
        self.since, self.paused = self.sensor.now, False

    def told(self) -> Iterator[int]:
        sensor = self.sensor
        start = max(sensor.rise, self.since)
        if sensor.fall > start and sensor.now >= sensor.fall + self.slow * LATER:
            yield min(round((sensor.fall - start) * 1e6), MOST)
            yield from [MOST] * self.slow

    def __len__(self) -> int:
        return min(len(list(self.told())), self.maxlen)

    def __getitem__(self, index: int) -> int:
        return list(self.told())[-self.maxlen :][index]


class Output:
    """A pin whose level is set."""

    def __init__(self, sensor: Sensor) -> None:
        self.sensor = sensor

    def switch_to_output(self, _level: bool) -> None:
        """Nothing to do."""

    def __setattr__(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)
        if name == "value":
            self.sensor.trigger(bool(value))


def fakes(board: str, monkeypatch: pytest.MonkeyPatch, pulses: list[int]) -> None:
    """Put a board's modules in place; the sensor gives the pulses [us], one for each trigger it hears."""

    def module(name: str, **names: object) -> None:
        monkeypatch.setitem(sys.modules, name, types.SimpleNamespace(**names))  # type: ignore[arg-type]

    sensor = Sensor(pulses)
    module("time", sleep=sensor.wait, sleep_us=lambda us: sensor.wait(us * 1e-6))
    if board == "micropython":

        class Pin:
            OUT, IN = 1, 0

            def __init__(self, _number: int, mode: int) -> None:
                self.mode = mode

            def value(self, level: int | None = None) -> int:
                if level is not None:
                    sensor.trigger(level)
                return int(sensor.sounding())

        module("machine", Pin=Pin, time_pulse_us=sensor.time_pulse_us)
        return
    module("board", D7=7, D8=8)
    module("digitalio", DigitalInOut=lambda _: Output(sensor))
    module("pulseio", PulseIn=lambda _, maxlen: Pulses(sensor, "ESP32" in board, maxlen))
