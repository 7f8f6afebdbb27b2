"""What a comparator sees: the received voltage, its threshold, and where it crosses."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.errors import DataError
from echocal.virtual_bench import Simulation, waveform

__all__ = ["plot_waveform", "waveform_figure"]

_RATE = 2e6  # Hz
_MILLI = 1e3


def waveform_figure(made: Simulation, row: int = 1) -> Figure:
    """Draw one reading: the whole time, and the echo alone.

    Parameters
    ----------
    made : Simulation
    row : int
        From 1.

    Returns
    -------
    Figure

    Raises
    ------
    DataError
        If there is no such row.
    """
    if not 1 <= row <= len(made.table):
        message = f"row {row} is none of the {len(made.table)} rows"
        raise DataError(message)
    figure, (whole, echo) = plt.subplots(2, 1, figsize=(9.0, 6.0), layout="constrained")
    at = np.array([row - 1])
    middle = (
        _MILLI * 2 * made.scene.distance[row - 1] / made.scene.speed(made.campaign.sensor.frequency)[row - 1]
    )
    plot_waveform(made, at, whole)
    whole.set_xlim(0, 1.6 * middle + 1.0)
    plot_waveform(made, at, echo)
    echo.set_xlim(middle - 0.1, middle + 0.9)
    echo.get_legend().remove()
    whole.set_title(f"row {row}: target at {made.scene.distance[row - 1]:.3f} m")
    echo.set_title("the same, about the echo")
    return figure


def plot_waveform(made: Simulation, row: np.ndarray, ax: Axes) -> None:
    """Draw the voltage of a row with its threshold into axes."""
    sensor = made.campaign.sensor
    elapsed, voltage = waveform(made.scene.at(row), sensor, np.random.default_rng(made.seed), _RATE)
    threshold = sensor.comparator.at(elapsed)
    listening = elapsed >= sensor.comparator.blanking
    ax.plot(_MILLI * elapsed, voltage[0], lw=0.6, color="C0", label="voltage before the comparator")
    ax.plot(_MILLI * elapsed[listening], threshold[listening], color="C3", lw=1.0, label="threshold")
    front = elapsed[-1] if np.isnan(made.echoes.delay[row[0]]) else 0.0
    speed = made.scene.speed(sensor.frequency)[row[0]]
    arrives = np.hypot(2 * made.scene.distance[row[0]], sensor.spacing) / speed + front
    ax.axvline(_MILLI * arrives, color="0.6", lw=0.8, ls=":", label="front of the echo")
    if not np.isnan(made.echoes.delay[row[0]]):
        crossed = arrives + made.echoes.delay[row[0]]
        ax.axvline(_MILLI * crossed, color="C2", lw=1.0, label="crossing")
    top = 1.3 * max(np.abs(voltage[0][elapsed > arrives - 1e-4]).max(initial=0.0), threshold[-1] * 2)
    ax.set_ylim(-top, top)
    ax.set_xlabel("time since the burst began [ms]")
    ax.set_ylabel("voltage [units of a wall at 1 m]")
    ax.legend(loc="upper right", fontsize=8)
