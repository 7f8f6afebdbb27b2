"""Figures 3, 4 and 6 of the study, redrawn beside the physics of humid air; nothing is computed here."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.plots.draw import save_figure
from echocal.study import Study
from echocal.study.origin import error
from echocal.study.tables import DISTANCE

INK, GRAY, GRID = "#1f2933", "#7b8794", "#e4e7eb"
STUDY, TINKERCAD = "#d64545", "#e08e0b"
AIR = {"dry air": "#9fb3c8", "50 % RH": "#2d7dd2", "100 % RH": "#12355b"}


def _style(axes: Axes, title: str, subtitle: str, y_label: str) -> None:
    axes.set_title(title, loc="left", fontsize=13, fontweight="bold", color=INK, pad=26)
    axes.text(0.0, 1.025, subtitle, transform=axes.transAxes, fontsize=9.5, color=GRAY)
    axes.set_ylabel(y_label, color=INK)
    axes.set_xlabel("temperature [°C]", color=INK)
    axes.set_xlim(-1.0, 51.0)
    axes.set_xticks(range(0, 51, 10))
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=GRAY, length=0)
    for side in ("top", "right", "left", "bottom"):
        axes.spines[side].set_visible(False)


def _air(axes: Axes, study: Study, transform: Callable[[np.ndarray], np.ndarray]) -> dict[str, float]:
    """Draw the curves of true air with the band between dry and saturated; return where they end."""
    temperature, air = study.curves.temperature, study.curves.air
    lines = {name: transform(curve) for name, curve in air.items()}
    axes.fill_between(
        temperature, lines["dry air"], lines["100 % RH"], color=AIR["50 % RH"], alpha=0.10, linewidth=0
    )
    for name, line in lines.items():
        axes.plot(temperature, line, color=AIR[name], linewidth=2.0)
    return {name: float(line[-1]) for name, line in lines.items()}


def _label(axes: Axes, ends: dict[str, tuple[float, str]], gap: float) -> None:
    """Write each name beside the end of its curve, at least a gap apart and no farther than needed."""
    names = sorted(ends, key=lambda name: ends[name][0])
    heights = np.array([ends[name][0] for name in names])
    steps = gap * np.arange(len(names))
    up = np.maximum.accumulate(heights - steps) + steps
    down = np.minimum.accumulate((heights - steps)[::-1])[::-1] + steps
    for name, height, place in zip(names, heights, 0.5 * (up + down), strict=True):
        axes.annotate(
            name,
            (50.5, height),
            (53.0, place),
            color=ends[name][1],
            fontsize=9.5,
            va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": ends[name][1],
                "linewidth": 0.8,
                "shrinkA": 1,
                "shrinkB": 1,
            },
        )


def draw_figure_3(study: Study, axes: Axes) -> None:
    """Measured distance against temperature (figure 3 of the study)."""
    table = study.tables.table1
    ends = {name: (end, AIR[name]) for name, end in _air(axes, study, np.asarray).items()}
    axes.axhline(DISTANCE, color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.text(1.0, DISTANCE - 0.004, "true distance, 2 m", color=INK, fontsize=9, va="top")
    measured = table.values("measured_distance_m")
    axes.scatter(table.temperature, measured, s=26, color=STUDY, edgecolor="white", linewidth=0.8, zorder=3)
    _label(axes, ends | {"study": (float(measured[-1]), STUDY)}, 0.011)
    _style(
        axes,
        "A sensor that assumes 343 m/s, at 2 m",
        "figure 3: Table 1 of the study (points) beside true air; the band is what humidity adds",
        "measured distance [m]",
    )


def draw_figure_4(study: Study, axes: Axes) -> None:
    """Error against temperature, with the sign that Table 1 drops (figure 4 of the study)."""
    table = study.tables.table1
    ends = {name: (end, AIR[name]) for name, end in _air(axes, study, error).items()}
    printed = table.values("error_percent")
    signed = np.sign(error(table.values("measured_distance_m"))) * printed
    dropped = signed != printed
    axes.axhline(0.0, color=INK, linewidth=1.0)
    for side, place in ((-5.0, "top"), (5.0, "bottom")):
        axes.axhline(side, color=GRAY, linewidth=0.9, linestyle=(0, (4, 3)))
        text = f"{side:+.0f} % threshold of the study".replace("-", "−")
        axes.text(0.0, side + np.sign(side) * 0.12, text, color=GRAY, fontsize=9, va=place)
    axes.scatter(
        table.temperature[dropped],
        printed[dropped],
        s=26,
        facecolor="none",
        edgecolor=STUDY,
        linewidth=1.0,
        alpha=0.6,
    )
    axes.scatter(table.temperature, signed, s=26, color=STUDY, edgecolor="white", linewidth=0.8, zorder=3)
    _label(
        axes,
        ends
        | {"study": (float(signed[-1]), STUDY), "as printed,\nsign dropped": (float(printed[-1]), STUDY)},
        0.55,
    )
    axes.set_ylim(-7.2, 6.4)
    _style(
        axes,
        "Cold reads long, warm reads short",
        "figure 4: errors of Table 1 with their sign (full points) and as printed (rings) beside true air",
        "error [%]",
    )


def draw_figure_6(study: Study, axes: Axes, below: Axes) -> None:
    """Calculation and Tinkercad (figure 6 of the study), and their differences below."""
    table = study.tables.table2
    calculation = table.values("measured_distance_calculation_m")
    tinkercad = table.values("measured_distance_tinkercad_m")
    ends = {name: (end, AIR[name]) for name, end in _air(axes, study, np.asarray).items()}
    axes.scatter(
        table.temperature, calculation, s=26, color=STUDY, edgecolor="white", linewidth=0.8, zorder=3
    )
    axes.scatter(
        table.temperature,
        tinkercad,
        s=24,
        color=TINKERCAD,
        marker="D",
        edgecolor="white",
        linewidth=0.8,
        zorder=3,
    )
    _label(
        axes,
        ends
        | {"calculation": (float(calculation[-1]), STUDY), "Tinkercad": (float(tinkercad[-1]), TINKERCAD)},
        0.014,
    )
    _style(
        axes,
        "Tinkercad reads short at every temperature" if np.all(tinkercad < calculation) else "Tinkercad",
        "figure 6: Table 2 of the study beside true air",
        "measured distance [m]",
    )
    axes.set_xlabel("")
    _draw_difference(study, below, (tinkercad - calculation) * 1e3)


def _draw_difference(study: Study, axes: Axes, away: np.ndarray) -> None:
    temperature = study.tables.table2.temperature
    mean = study["table2-tinkercad"].numbers["mean"]
    axes.axhspan(-3.0, 3.0, color=GRID, alpha=0.7, linewidth=0)
    axes.axhline(0.0, color=STUDY, linewidth=1.4)
    axes.vlines(temperature, 0.0, away, color=TINKERCAD, linewidth=1.2, alpha=0.7)
    axes.scatter(
        temperature, away, s=24, color=TINKERCAD, marker="D", edgecolor="white", linewidth=0.8, zorder=3
    )
    axes.axhline(mean, color=TINKERCAD, linewidth=1.2, linestyle=(0, (4, 3)))
    axes.text(52.0, mean, f"mean {mean:.1f} mm".replace("-", "−"), color=TINKERCAD, fontsize=9.5, va="center")
    axes.text(52.0, 0.0, "±3 mm of the\ndata sheet", color=GRAY, fontsize=9.5, va="center")
    odd = next(d for d in study.discoveries if d.id == "odd_row").numbers
    height = float(away[temperature == odd["temperature"]][0])
    axes.annotate(
        f"same number as at {odd['twin']:g} °C" if "twin" in odd else "does not belong",
        (odd["temperature"], height),
        (odd["temperature"] + 2.0, height + 2.6),
        color=GRAY,
        fontsize=9,
        arrowprops={"arrowstyle": "-", "color": GRAY, "linewidth": 0.7},
    )
    _style(axes, "", "", "Tinkercad − calculation [mm]")
    axes.set_ylim(-14.0, 4.5)


@contextmanager
def _saved(path: Path, height: float) -> Iterator[Figure]:
    figure = Figure(figsize=(8.6, height), layout="constrained")
    yield figure
    save_figure(figure, path, "study", facecolor="white")


FIGURES = ("study-figure-3.png", "study-figure-4.png", "study-figure-6.png")
"""Names of the files that `save` writes."""


def save(study: Study, folder: Path) -> list[Path]:
    """Draw the three figures as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in FIGURES]
    for path, draw in zip(paths[:2], (draw_figure_3, draw_figure_4), strict=True):
        with _saved(path, 5.2) as figure:
            draw(study, figure.subplots())
    with _saved(paths[2], 7.4) as figure:
        above, below = figure.subplots(2, height_ratios=[5, 3])
        draw_figure_6(study, above, below)
    return paths
