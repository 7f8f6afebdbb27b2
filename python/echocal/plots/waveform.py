"""What a comparator sees: the received voltage, its threshold, and where it crosses."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.virtual_bench import Scene, Sensor
from echocal.virtual_bench import waveform as sampled

_RATE = 2e6  # Hz
_MILLI = 1e3
_BEFORE, _AFTER = 0.1, 0.9  # ms about the front of the echo


def waveform_figure(scene: Scene, sensor: Sensor | None = None, *, row: int = 1, seed: int = 0) -> Figure:
    """Draw one reading, with noise of its own: the whole time, and the echo alone.

    Raises `DataError` if there is no such row. The sensor is an HC-SR04 by default; rows count from 1.
    """
    if not 1 <= row <= len(scene):
        raise DataError(f"there is no row {row}: rows are 1 to {len(scene)}")
    sensor = sensor or Sensor()
    one = scene.at(np.array([row - 1]))
    arrives = _MILLI * float(one.paths(sensor)[0][0, 1])
    elapsed, voltage = sampled(one, sensor, np.random.default_rng(seed), _RATE)
    figure, (whole, echo) = plt.subplots(2, 1, figsize=(9.0, 6.0), layout="constrained")
    for ax, title, span in (
        (whole, f"row {row}: target at {one.distance[0]:.3f} m", (0.0, 1.6 * arrives + 1.0)),
        (echo, "the same, about the echo", (arrives - _BEFORE, arrives + _AFTER)),
    ):
        plot_waveform(_MILLI * elapsed, voltage[0], sensor, ax)
        ax.axvline(arrives, color="0.4", lw=1.0, ls=":", label="front of the echo")
        ax.set(title=title, xlim=span)
        near = voltage[0][np.abs(_MILLI * elapsed - arrives - 0.4) < 0.5]
        top = 1.3 * max(np.abs(near).max(initial=0.0), 2 * sensor.comparator.threshold)
        ax.set_ylim(-top, top)
    whole.legend(loc="upper right", fontsize=8)
    return figure


def plot_waveform(
    milliseconds: NDArray[np.float64], voltage: NDArray[np.float64], sensor: Sensor, ax: Axes
) -> None:
    """Draw a voltage, the threshold, and the first crossing into axes."""
    seconds = milliseconds / _MILLI
    threshold = sensor.comparator.at(seconds)
    listening = seconds >= sensor.comparator.blanking
    ax.plot(milliseconds, voltage, lw=0.6, color="C0", label="voltage before the comparator")
    ax.plot(milliseconds[listening], threshold[listening], color="C3", lw=1.0, label="threshold")
    above = (voltage > threshold) & listening
    # The voltage must stay above the threshold until the output answers.
    answers = round(sensor.comparator.response_time / (seconds[1] - seconds[0]))
    crossed = np.flatnonzero(above[: len(above) - answers] & above[answers:])
    if len(crossed):
        ax.axvline(milliseconds[crossed[0]], color="C2", lw=1.0, label="crossing")
    ax.set_xlabel("time since the burst began [ms]")
    ax.set_ylabel("voltage [units of a wall at 1 m]")
