"""Figures of the study's question; nothing is computed here."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.plots.draw import save_figure
from echocal.study.question.answer import Answer, Made
from echocal.study.question.explanations import LIMIT, unrounded
from echocal.study.question.page import FIGURES

INK, GRAY, GRID = "#1f2933", "#7b8794", "#e4e7eb"
REMAINS, EXCLUDED, TABLE = "#2d7dd2", "#9fb3c8", "#e08e0b"
_LOWEST, _HIGHEST = -26.0, 13.0  # mm
_SHOWN = 3  # explanations
_LINES = ("#2d7dd2", "#2e8b57", "#d64545")


def save(found: Answer, folder: Path) -> list[Path]:
    """Draw the figures as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    first = Figure(figsize=(11.5, 8.2), layout="constrained")
    left, right = first.subplots(1, 2, width_ratios=[5, 4])
    draw_suspects(found, left)
    draw_rows(found, right)
    second = Figure(figsize=(8.6, 3.4), layout="constrained")
    draw_outcomes(found, second.subplots())
    paths = [folder / name for name in FIGURES]
    for figure, path in zip((first, second), paths, strict=True):
        save_figure(figure, path, "study", facecolor="white")
    return paths


def _style(axes: Axes, title: str) -> None:
    axes.set_title(title, loc="left", fontsize=11, fontweight="bold", color=INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)


def draw_suspects(found: Answer, axes: Axes) -> None:
    """Mean that each suspect makes, beside that of Table 2; of a free size, what it can make."""
    shown = [one for one in found.made if one.suspect.place not in ("setting", "none")]
    wanted = found.wanted
    axes.axvspan(
        wanted.mean - LIMIT * wanted.mean_error,
        wanted.mean + LIMIT * wanted.mean_error,
        color=TABLE,
        alpha=0.25,
        linewidth=0,
        label=f"Table 2: {wanted.mean:.1f} mm, ± {LIMIT:g} standard errors".replace("-", "−"),
    )
    for row, one in enumerate(shown):
        _suspect(axes, row, one)
    axes.set_yticks(range(len(shown)), [one.suspect.title for one in shown], fontsize=8)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlim(_LOWEST, _HIGHEST)
    axes.set_xlabel("reading less calculation at 2 m, mean [mm]")
    axes.plot([], [], "o", color=REMAINS, label="remains")
    axes.plot([], [], "o", color=EXCLUDED, label="excluded (by size, sign, slope, step, or not in Tinkercad)")
    axes.plot([], [], "-", color=GRAY, linewidth=4, label="bar: any size that is possible")
    _style(axes, "What each suspect makes of 2 m")
    axes.legend(fontsize=7.5, loc="upper center", bbox_to_anchor=(0.35, -0.07), ncols=2, frameon=False)


def _suspect(axes: Axes, row: int, one: Made) -> None:
    color = REMAINS if one.verdict.remains else EXCLUDED
    free = one.suspect.free
    if free is not None:
        ends = [one.pattern.mean / free.staged * size for size in (free.low, free.high)]
        axes.plot(
            np.clip(ends, _LOWEST, _HIGHEST), [row, row], "-", color=color, linewidth=4, solid_capstyle="butt"
        )
        return
    if one.pattern.mean < _LOWEST:
        axes.plot(_LOWEST + 0.6, row, "<", color=color)
        text = f"{one.pattern.mean:.0f} mm".replace("-", "−")
        axes.text(_LOWEST + 1.4, row, text, fontsize=7.5, color=GRAY, va="center")
        return
    axes.plot(one.pattern.mean, row, "o", color=color)


def draw_rows(found: Answer, axes: Axes) -> None:
    """Rows of Table 2 and what the most probable explanations make of them."""
    table = found.tables.table2
    away = 1e3 * (table.values("measured_distance_tinkercad_m") - unrounded(table))
    axes.plot(table.temperature, away, "D", color=TABLE, markersize=5, label="Table 2")
    for color, one in zip(_LINES, found.explanations[:_SHOWN], strict=False):
        total = np.zeros(len(table))
        for own in one.suspects:
            made = found.of(own.id).smooth
            total = total + (made if own.free is None else made * one.sizes[own.id] / own.free.staged)
        name = " and\n".join(own.title for own in one.suspects)
        axes.plot(
            table.temperature,
            total,
            color=color,
            linewidth=1.3,
            label=f"{name} ({100 * one.probability:.0f} %)",
        )
    loss = found.of("pulse_in").smooth
    axes.plot(table.temperature, loss, color=GRAY, linewidth=1.0, linestyle="--", label="pulseIn() alone")
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set(xlabel="temperature [°C]", ylabel="reading less calculation [mm]")
    axes.set_ylim(-15.0, 7.0)
    _style(axes, "Row by row")
    axes.legend(fontsize=7.5, loc="upper right")


def draw_outcomes(found: Answer, axes: Axes) -> None:
    """Expected probability of what is true, after each measurement."""
    outcomes = found.outcomes[::-1]
    now = sum(one.probability**2 for one in found.explanations)
    values = [100 * one.expected_probability for one in outcomes]
    axes.barh(range(len(outcomes)), values, color=REMAINS, height=0.6)
    for row, value in enumerate(values):
        axes.text(value + 1.0, row, f"{value:.0f} %", fontsize=8.5, va="center", color=INK)
    axes.axvline(100 * now, color=TABLE, linewidth=1.5, label=f"from Table 2 alone: {100 * now:.0f} %")
    axes.set_yticks(range(len(outcomes)), [one.measurement.title for one in outcomes], fontsize=8.5)
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel("expected probability of the true explanation [%]")
    _style(axes, "Which measurement would have told")
    axes.legend(fontsize=8.5, loc="lower right")
