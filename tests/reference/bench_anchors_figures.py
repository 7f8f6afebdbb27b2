"""Figures of docs/virtual-bench.md: real records and the virtual bench in the same axes."""

import bench_anchors as anchors
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.virtual_bench import Scene, Sensor, Target, measure
from echocal.virtual_bench.waveform.measure import received

__all__ = ["PANEL", "PLATE", "RULE", "amplitudes", "staircase", "walks"]

PLATE = Target(half_width=0.0165, half_height=0.019)  # m, of aluminum: last told at 1.52 m, lost at 1.85 m
RULE = Target(half_width=0.0127, half_height=0.43)  # m, of steel: last told at 2.15 m, lost at 2.45 m
PANEL = {0.15: 20.0, 0.45: 9.0, 1.0: 10.0, 1.45: 10.0, 2.45: 4.0}  # m and degree, off the axis
REAL, BENCH = "C0", "C3"


def slips(real: pd.DataFrame, bench: pd.DataFrame, boxes: pd.DataFrame) -> Figure:
    """Share and spacing of slips against the distance."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    for arduino, name, marker in ((True, "Arduino", "x"), (False, "Raspberry Pi", "+")):
        runs = boxes[boxes["arduino"] == arduino]
        label = f"kb-hcsr04 on {name}, a run each"
        left.plot(runs["distance"], runs["share"], marker, color="0.6", ms=5, label=label)
        right.plot(runs["distance"], runs["spacing"], marker, color="0.6", ms=5, label=label)
    for record, name, color in ((real, "desk-hcsr04", REAL), (bench, "bench, the same campaign", BENCH)):
        _slips_of(record, name, color, left, right)
    left.set(xlabel="distance [m]", ylabel="share of readings off the main cycle [1]", xlim=(0, 1.6))
    left.set_ylim(0, 0.8)
    right.axhline(25.0, color="0.8", lw=0.8, zorder=0)
    right.set(xlabel="distance [m]", ylabel="one cycle in echo time [µs]", xlim=(0, 1.6), ylim=(19, 29))
    left.legend(fontsize=8, loc="upper left")
    return figure


def _slips_of(record: pd.DataFrame, name: str, color: str, left: Axes, right: Axes) -> None:
    """Both panels of one record, with bars of two standard errors."""
    style = {"fmt": "o-", "capsize": 3, "color": color, "label": name}
    shares = anchors.shares(record)
    left.errorbar(0.5 * (shares["low"] + shares["high"]), shares["share"], 2 * shares["error"], **style)
    known = anchors.cycles(record)
    known = known.assign(off=known["off"].abs())
    slipped = known[known["off"].between(*anchors.SLIP)]
    bands = pd.cut(slipped["distance"], [0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5])
    means = slipped.groupby(bands, observed=True).agg({"distance": "mean", "off": ["mean", "sem"]})
    right.errorbar(means["distance"]["mean"], means["off"]["mean"], 2 * means["off"]["sem"], **style)


def staircase(real: pd.DataFrame, bench: pd.DataFrame) -> Figure:
    """Placements at 4 to 20 cm: each holds its cycle."""
    figure, panes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    for pane, record, name in zip(panes, (real, bench), ("desk-hcsr04", "bench"), strict=True):
        table, numbers = anchors.branches(record)
        for cycle, color, words in (
            (0, "C0", "main cycle"),
            (-1, "C1", "one earlier"),
            (1, "C2", "one later"),
        ):
            here = table[table["cycle"] == cycle]
            label = f"{words}: {len(here) / len(table):.2f}"
            height = here["delay"] - numbers["offset"]
            pane.plot(100 * here["distance"], height, ".", color=color, ms=5, label=label)
        pane.set(xlabel="distance [cm]", title=f"{name}: {len(table)} placements", ylim=(-70, 90))
        pane.legend(fontsize=8, loc="upper right", title="share of placements on the", title_fontsize=8)
    panes[0].set_ylabel("echo time less 2 d / c,\nabout the median of the main cycle [µs]")
    return figure


def walks(real: pd.DataFrame, bench: pd.DataFrame) -> Figure:
    """Delay against the distance."""
    figure, ax = plt.subplots(figsize=(7.5, 4.6), layout="constrained")
    for record, name, color in (
        (real, "desk-hcsr04, four long sessions", REAL),
        (bench, "bench, the same campaign", BENCH),
    ):
        table = anchors.walk(record)
        style = {"fmt": "o-", "capsize": 3, "color": color, "label": name}
        ax.errorbar(table.index, table["mean"], 2 * table["error"], **style)
    far = np.linspace(0.3, 1.5, 300)
    fixed = Sensor(noise=0.0, burst_scatter=0.0).but(raised=0.0, blanking=1.6e-3)
    delay = 1e6 * (measure(Scene(far), fixed).delay - fixed.zero)
    ax.plot(far, delay, ".", ms=3, color="C1", label="bench, one threshold at all times")
    for slope, name, style_ in (
        (48.0, "kb-hcsr04, Raspberry Pi: slope of +48 µs/m", "--"),
        (-37.0, "kb-hcsr04, Arduino: slope of -17 to -59 µs/m", ":"),
    ):
        ax.plot([0.3, 1.5], np.array([0.3, 1.5]) * slope - 40.0, style_, color="0.5", lw=1.2, label=name)
    ax.set(xlabel="distance [m]", ylabel="echo time less 2 d / c [µs]", xlim=(0, 1.6), ylim=(-200, 130))
    ax.legend(fontsize=8, loc="upper left")
    return figure


def amplitudes(angles: pd.Series) -> Figure:
    """Far-field amplitude, and where small targets and edges are lost."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    far = np.geomspace(0.2, 5.0, 400)
    wall = Target(half_width=3.0, half_height=3.0)
    _echo_of(left, far, wall, "wall", "C0", None)
    _echo_of(left, far, RULE, "steel rule, 25 mm wide", "C1", (2.15, 2.45))
    _echo_of(left, far, PLATE, "plate, 33 x 38 mm", "C2", (1.52, 1.85))
    sensor = Sensor()
    left.plot(far, sensor.comparator.at(2 * far / 344.0), "k", lw=1.2, label="threshold")
    left.axhline(sensor.noise, color="0.6", lw=0.8, ls="--", label="noise, standard deviation")
    left.set(xscale="log", yscale="log", xlabel="distance [m]", ylim=(1e-3, 3), xlim=(0.2, 5))
    left.set_xticks([0.2, 0.5, 1.0, 2.0, 5.0], ["0.2", "0.5", "1", "2", "5"])
    left.minorticks_off()
    left.set_ylabel("peak of the echo [carrier of a wall at 1 m]")
    left.legend(fontsize=7, loc="upper right", ncols=2)
    right.plot(angles.index, angles, ".-", color=BENCH, label="bench")
    right.plot(list(PANEL), list(PANEL.values()), "o", color=REAL, label="as G. Dyrkacz tells")
    right.set(xlabel="distance [m]", ylim=(0, 25), xlim=(0, 2.7))
    right.set_ylabel("angle off the axis up to which the edge\nof a parallel panel is told [degree]")
    right.legend(fontsize=8)
    return figure


def _echo_of(
    ax: Axes, far: np.ndarray, target: Target, name: str, color: str, lost: tuple[float, float] | None
) -> None:
    """Amplitude of a target, and the span in which it was lost in reality."""
    signal = received(Scene(far, temperature=16.5, relative_humidity=0.32, target=target), Sensor())
    ax.plot(far, np.abs(signal.sizes[:, 1]) * signal.response.peak / 1.05, color=color, label=name)
    if lost:
        label = f"was lost in {lost[0]} to {lost[1]} m"
        ax.axvspan(*lost, color=color, alpha=0.2, lw=0, label=label)
