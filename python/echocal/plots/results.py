"""One figure for each kind of result: what its method ``plot`` draws."""

from functools import singledispatch

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.budget import Budget
from echocal.calibrate import Calibration
from echocal.charts.results import errors_chart, residual_chart
from echocal.diagnose import Diagnosis
from echocal.model import Model
from echocal.observations import Observations
from echocal.plots.diagnosis import residuals_figure
from echocal.plots.draw import STYLE, draw_bars, draw_chart
from echocal.plots.echo_times import echo_times_figure
from echocal.plots.sweep import plot_sweep
from echocal.sweep import sweep
from echocal.verify import Verification
from echocal.waveforms import EchoTimes

_DARK, _LIGHT = "#155a75", "#e0862a"
_MM = 1e3  # mm in a meter


@singledispatch
def figure(result: object) -> Figure:
    """Draw a result."""
    raise TypeError(type(result).__name__)


def _axes(width: float = 6.4, height: float = 3.6) -> tuple[Figure, Axes]:
    with mpl.rc_context(STYLE):
        drawn = Figure((width, height), layout="constrained")
        return drawn, drawn.add_subplot()


@figure.register
def _(result: Diagnosis) -> Figure:
    with mpl.rc_context(STYLE):
        return residuals_figure(result)


@figure.register
def _(result: Model) -> Figure:
    drawn, ax = _axes()
    grid = sweep(result, temperature=(-10.0, 50.0, 1.0), distance=[0.5, 1.0, 2.0, 4.0])
    plot_sweep(grid, "error", ax)
    ax.set_title("error of indication of a device that the model describes", loc="left", fontsize=9)
    return drawn


@figure.register
def _(result: Calibration) -> Figure:
    drawn, ax = _axes()
    draw_chart(residual_chart(result), [ax])
    ax.set_title(f"residuals of {', '.join(result.names)}", loc="left", fontsize=9)
    return drawn


@figure.register
def _(result: Observations) -> Figure:
    drawn, ax = _axes()
    along = np.arange(1, len(result) + 1) if result.time is None else result.time
    values = result.reading if result.reading is not None else _MM * result.echo_time
    label = "reading [m]" if result.reading is not None else "echo time [ms]"
    ax.plot(along[result.usable], values[result.usable], ".", ms=3, color=_DARK, label="usable rows")
    if not result.usable.all():
        off = ~result.usable & np.isfinite(values)
        ax.plot(along[off], values[off], "x", ms=4, color=_LIGHT, label="rows that cannot be used")
        ax.legend(frameon=False, fontsize=8)
    ax.set(xlabel="row" if result.time is None else "time (UTC)", ylabel=label)
    drawn.autofmt_xdate()
    return drawn


@figure.register
def _(result: Verification) -> Figure:
    drawn, ax = _axes(6.4, 2.2)
    bound = _MM * result.maximum_permissible_error
    draw_bars(
        errors_chart(result), ax, [f"{result.exceeding} of {result.count} errors exceed {bound:.3g} mm"]
    )
    return drawn


@figure.register
def _(result: EchoTimes) -> Figure:
    return echo_times_figure(result)


@figure.register
def _(result: Budget) -> Figure:
    drawn, ax = _axes()
    row = int(np.nanargmax(result.expanded_uncertainty))
    sizes = _MM * np.abs(result.itemized.contributions[row])
    names = [entry.words for entry in result.entries]
    ax.barh([*names, "combined"], [*sizes, _MM * result.standard_uncertainty[row]], color=_DARK)
    ax.invert_yaxis()
    ax.set(xlabel="contribution to the standard uncertainty [mm]")
    ax.set_title(f"budget of row {result.row[row]}", loc="left", fontsize=9)
    return drawn
