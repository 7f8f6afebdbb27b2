"""Echo times over the captures, and one capture with its echo."""

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from echocal.plots.draw import STYLE
from echocal.waveforms import EchoTimes

_DARK, _LIGHT, _PALE = "#155a75", "#e0862a", "#9fb4bd"
_MS = 1e3  # ms in a second
_DOUBTFUL = 0.01  # cycle ambiguity above which a capture is marked


def echo_times_figure(
    echoes: EchoTimes, waveform: NDArray[Any] | None = None, sample_rate: float = 1.0
) -> Figure:
    """Draw echo times, and above them the first capture that has one.

    The captures, shape (..., N), have samples at a rate [Hz].
    """
    with mpl.rc_context(STYLE):
        rows = 1 if waveform is None else 2
        drawn = Figure((6.8, 3.2 * rows), layout="constrained")
        axes = drawn.subplots(rows, 1, squeeze=False)[:, 0]
        if waveform is not None:
            _draw_capture(axes[0], echoes, waveform.reshape(-1, waveform.shape[-1]), sample_rate)
        _draw_times(axes[-1], echoes)
    return drawn


def _draw_times(ax: Axes, echoes: EchoTimes) -> None:
    time, spread = np.ravel(_MS * echoes.time), np.ravel(_MS * echoes.standard_uncertainty)
    number = np.arange(1, time.size + 1)
    found = np.ravel(echoes.found)
    doubtful = found & (np.ravel(echoes.cycle_ambiguity) > _DOUBTFUL)
    for where, color, label in (
        (found & ~doubtful, _DARK, "echo time ± standard uncertainty"),
        (doubtful, _LIGHT, f"the same, cycle ambiguity above {_DOUBTFUL:g}"),
    ):
        if where.any():
            ax.errorbar(
                number[where], time[where], spread[where], fmt=".", ms=4, lw=0.8, color=color, label=label
            )
    if not found.all():
        ax.plot(
            number[~found],
            np.zeros(int((~found).sum())),
            "x",
            ms=5,
            color=_PALE,
            transform=ax.get_xaxis_transform(),
            clip_on=False,
            label="no echo time",
        )
    ax.set(xlabel="capture", ylabel="echo time [ms]")
    ax.set_title(f"method: {echoes.method}", loc="left", fontsize=9)
    ax.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(0.0, -0.2), ncols=3)


def _draw_capture(ax: Axes, echoes: EchoTimes, waveform: NDArray[Any], sample_rate: float) -> None:
    found = np.flatnonzero(np.ravel(echoes.found))
    place = int(found[0]) if len(found) else 0
    along = _MS * np.arange(waveform.shape[-1]) / sample_rate
    ax.plot(along, waveform[place], lw=0.5, color=_PALE, label=f"capture {place + 1}")
    if len(found):
        ax.axvline(_MS * np.ravel(echoes.time)[place], color=_DARK, lw=1.2, label="echo time")
    ax.set(xlabel="time [ms]", ylabel="waveform [its unit]", xlim=(along[0], along[-1]))
    ax.legend(frameon=False, fontsize=8, loc="upper right")
