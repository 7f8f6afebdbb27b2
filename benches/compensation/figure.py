"""The figure of docs/compensation.md: millimeters against euro, and by method and weather."""

from pathlib import Path
from typing import Any

import matplotlib as mpl

from compensation.campaign import ALL, BEST, LIMIT, Setting
from compensation.hardware import SENSOR_EURO, THERMOMETERS

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BOUGHT = {
    "cramer": ("as bought", "#888888", "s"),
    "zeroed": ("zero at one mark", "#c55a11", "^"),
    "line": ("line through all marks", "#1f4e79", "o"),
    "named": ("named causes", "#2e8b57", "D"),
    "boosting_left": ("gradient boosting of what Cramer leaves", "black", "x"),
}
_SHORT = {name: own.label for name, own in THERMOMETERS.items()} | {
    "none": "none: 343 m/s",
    "hand": "potentiometer,\nset once",
    "shield": "DHT22 in a shield",
    "hih4030": "DS18B20\nand HIH-4030",
    "path": "second HC-SR04,\nplate at 1 m",
}
_WEATHER = {
    "spring": ("same weather as the training", "#2e8b57", "o"),
    "summer": ("summer", "#c55a11", "^"),
    "winter": ("winter", "#1f4e79", "s"),
}


def bought(name: str, method: str) -> Setting:
    """Return the configuration of a thermometer; as bought, one without has a fixed speed."""
    return Setting(name, method="fixed" if (name, method) == ("none", "cramer") else method)


def draw(results: dict[str, Any]) -> Figure:
    """Draw both panels."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(13.5, 6.4), layout="constrained")
    _euro(left, results["figures"])
    _methods(right, results["figures"])
    return figure


def save(results: dict[str, Any], path: Path) -> None:
    """Write the figure."""
    draw(results).savefig(path, dpi=110)
    plt.close("all")


def _euro(ax: Axes, figures: dict[str, Any]) -> None:
    order = sorted(THERMOMETERS, key=lambda name: THERMOMETERS[name].euro)
    for shift, (method, (label, color, marker)) in enumerate(BOUGHT.items()):
        points = []
        for place, name in enumerate(order):
            known = figures.get(bought(name, method).key)
            if known:
                points.append((place + 0.13 * (shift - 2), *known["other"]["all"]["rms"]))
        x, y, low, high = zip(*points, strict=True)
        spread = [[a - b for a, b in zip(y, low, strict=True)], [b - a for a, b in zip(y, high, strict=True)]]
        ax.errorbar(x, y, spread, fmt=marker, color=color, label=label, ms=5, lw=1)
    ax.axhline(LIMIT, color="black", lw=0.8, ls="--", label="the data sheet's 3 mm")
    clean = [figures[Setting(name, oracle="detector").key]["other"]["all"]["rms"][0] for name in order]
    ax.plot(
        range(len(order)),
        clean,
        "o",
        mfc="none",
        color="#1f4e79",
        ms=5,
        label="line, no time walk: no product",
    )
    names = [f"{_SHORT[name]}\n{SENSOR_EURO + THERMOMETERS[name].euro:.1f} €" for name in order]
    ax.set_xticks(range(len(order)), names, rotation=90, fontsize=8)
    ax.set(yscale="log", ylabel="RMS error in summer and winter, 0.2 to 4 m [mm]")
    ax.set_yticks([1, 2, 3, 5, 10, 20, 50], ["1", "2", "3", "5", "10", "20", "50"])
    ax.minorticks_off()
    ax.set_title("Which euro: HC-SR04 with a thermometer", fontsize=10)
    ax.grid(alpha=0.3, axis="y")
    ax.legend(fontsize=8, ncols=2, loc="upper right")
    ax.set_ylim(1, 300)


def _methods(ax: Axes, figures: dict[str, Any]) -> None:
    names = [name for name in ALL if name not in ("dry", "half", "dry_line", "half_line")][::-1]
    for test, (label, color, marker) in _WEATHER.items():
        values = [figures[Setting(BEST, method=name).key][test]["all"]["rms"][0] for name in names]
        ax.plot(values, range(len(names)), marker, color=color, ms=5, label=f"trained in spring: {label}")
    keys = [Setting(BEST, method=name, trained="room").key for name in names]
    rooms = [figures[key]["other"]["all"]["rms"][0] for key in keys]
    ax.plot(rooms, range(len(names)), "x", color="black", ms=6, label="trained in a room: summer and winter")
    ax.axvline(LIMIT, color="black", lw=0.8, ls="--")
    ax.set_yticks(range(len(names)), [ALL[name].label.replace("`", "") for name in names], fontsize=8)
    ax.set(xscale="log", xlabel="RMS error, 0.2 to 4 m [mm]")
    ax.set_xticks([3, 10, 30, 100, 300, 1000, 3000], ["3", "10", "30", "100", "300", "1000", "3000"])
    ax.minorticks_off()
    ax.set_title("Which method: DHT22 in a shield, timer capture", fontsize=10)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, loc="center right", bbox_to_anchor=(1.0, 0.62))
