"""The figure of docs/echo-times.md from echo_times.json."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

COLORS = {"matched_filter": "#155a75", "phase": "#2a9d6f", "envelope": "#8a6bb1", "threshold": "#e0862a"}
MARKS = {"matched_filter": "o", "phase": "s", "envelope": "^", "threshold": "D"}
WORDS = {name: name.replace("_", " ") for name in COLORS}
US = 1e6  # us in a second


def draw(results: dict[str, Any], path: Path) -> None:
    """Errors against the ratio, the comparator's walk, and whether the ambiguity is right."""
    with plt.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = plt.figure(figsize=(9.2, 8.6), layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=(1.35, 1.0))
        _errors(figure.add_subplot(grid[0, :]), results["points"])
        _walk(figure.add_subplot(grid[1, 0]), results["walk"])
        _reliability(figure.add_subplot(grid[1, 1]), results["reliability"])
        figure.savefig(path, dpi=120)
        plt.close(figure)


def _errors(ax: Axes, points: list[dict[str, Any]]) -> None:
    ratio = np.array([one["ratio_dB"] for one in points])
    ax.plot(ratio, [US * one["cramer_rao_s"] for one in points], "k-", lw=1.2, label="Cramér-Rao bound")
    ax.plot(ratio, [US * one["ziv_zakai_s"] for one in points], "k--", lw=1.2, label="Ziv-Zakai bound")
    for method, color in COLORS.items():
        rms = [np.nan if one[method]["rms_s"] is None else US * one[method]["rms_s"] for one in points]
        ax.plot(ratio, rms, MARKS[method], ls="-", lw=0.8, ms=4.5, color=color, label=WORDS[method])
    for method in ("matched_filter", "phase"):
        own = [one[method]["right_rms_s"] for one in points]
        own = [np.nan if value is None else US * value for value in own]
        label = f"{WORDS[method]}, right cycle only"
        ax.plot(ratio, own, MARKS[method], ms=6.5, mfc="none", color=COLORS[method], label=label)
    ax.axhline(US / 40e3, color="0.8", lw=0.8, zorder=0)
    ax.annotate(
        "one period", (ratio[-1], US / 40e3), (0, 3), textcoords="offset points", ha="right", color="0.4"
    )
    ax.set(yscale="log", xlabel="signal to noise 2E/N0 [dB]", ylabel="RMS error of the echo time [µs]")
    ax.grid(alpha=0.25)
    ax.legend(frameon=False, fontsize=8, ncols=2, loc="upper right", bbox_to_anchor=(1.0, 0.92))
    shift = points[0]["ratio_dB"] - points[0]["peak_dB"]
    above = ax.secondary_xaxis("top", functions=(lambda x: x - shift, lambda x: x + shift))
    above.set_xlabel("peak by standard deviation of the noise, sampled at 1 MHz [dB]")


def _walk(ax: Axes, walk: dict[str, list[float]]) -> None:
    strength = np.geomspace(1.0, 30.0, len(walk["threshold_s"]))
    for method in ("threshold", "matched_filter"):
        ax.plot(
            strength,
            US * np.array(walk[f"{method}_s"], dtype=float),
            ".",
            ms=2.5,
            color=COLORS[method],
            label=WORDS[method],
        )
    ax.set(
        xscale="log",
        xlabel="amplitude of the echo, in thresholds",
        ylabel="time found after the echo's begin [µs]",
    )
    ax.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    ax.minorticks_off()
    ax.grid(alpha=0.25)
    ax.legend(frameon=False, fontsize=8, markerscale=4)
    ax.set_title("without noise: what a comparator makes of the amplitude", loc="left", fontsize=9)


def _reliability(ax: Axes, reliability: dict[str, list[dict[str, float]]]) -> None:
    ax.plot([0.0, 1.0], [0.0, 1.0], color="0.7", lw=0.8)
    for method, rows in reliability.items():
        told, wrong = (np.array([row[name] for row in rows]) for name in ("told", "wrong"))
        count = np.array([row["count"] for row in rows])
        spread = np.sqrt(np.maximum(wrong * (1.0 - wrong), 1.0 / count) / count)
        ax.errorbar(
            told,
            wrong,
            1.96 * spread,
            fmt=MARKS[method],
            ms=4,
            lw=0.8,
            color=COLORS[method],
            label=WORDS[method],
        )
    ax.set(xlabel="cycle ambiguity that is told", ylabel="share in a wrong cycle")
    ax.grid(alpha=0.25)
    ax.legend(frameon=False, fontsize=8, loc="upper left")
    ax.set_title("does the ambiguity hold? (bars: 95 %)", loc="left", fontsize=9)
