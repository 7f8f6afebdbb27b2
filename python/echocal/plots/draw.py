"""Charts as pictures and as files: one renderer for what `echocal.charts` describes."""

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.dates as dates
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from echocal.charts.parts import Axis, Bars, Chart, Line, Panel, Points, Rug
from echocal.errors import UsageError, writing
from echocal.outputs import replacing

_MOST = 3  # lines
_LABEL_CHARACTER, _TITLE_CHARACTER = 0.069, 0.062  # inches, at 9 and at 8 points
_MARGIN = 0.2  # inches

TONES = {
    "before": "#e0862a",
    "after": "#155a75",
    "quiet": "#a9b6bd",
    "out": "#9b2335",
    "term": "#7a3b8f",
    "ink": "0.15",
}
"""Color of each role: light and dark before and after, which are different without color, too."""

_FEWEST = 2  # bars that there is always room for, so that a single one is not too high
_WIDTH = 46  # characters of a line of a bar's label
_LABEL = 55  # characters of a line below a panel
_FEW = 200  # points that are visible one by one
_MARK = 0.97  # height of a rug, in parts of the axis
STYLE: Any = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
"""How figures look: of results, diagnoses and fleets."""

FORMS = ("png", "svg", "pdf")
"""Formats of the plots of a command."""

_MAKER = {"png": "Software", "svg": "Creator", "pdf": "Creator", "ps": "Creator", "eps": "Creator"}
"""Name of the metadata field for the maker of a figure, by format."""


def draw_bars(chart: Bars, ax: Axes, said: Sequence[str] = ()) -> None:
    """Draw bars, the first one on top; above them what is `said`, and the notes of the chart."""
    labels = [textwrap.fill(bar.label, _WIDTH) for bar in chart.bars]
    for place, bar in enumerate(chart.bars):
        left = 0.0
        for share in bar.shares or (bar.value,):
            ax.barh(place, share, 0.6, left=left, color=TONES[bar.tone], edgecolor="white", linewidth=0.8)
            left += share
        ax.text(left + 0.015 * chart.most, place, bar.text, va="center")
    ax.set_yticks(range(len(labels)), labels)
    ax.set_ylim(max(len(labels), _FEWEST) - 0.5, -0.5)
    ax.set_xlim(0.0, 1.25 * chart.most)
    ax.set_xticks([tick for tick in ax.get_xticks() if tick <= 1.0001 * chart.most])
    ax.set_xlim(0.0, 1.25 * chart.most)
    ax.spines["bottom"].set_bounds(0.0, chart.most)
    ax.set_xlabel(fitted(chart.label, _WIDTH))
    width = title_beside(labels, ax)
    ax.set_title(
        "\n".join(textwrap.fill(line, width) for line in (*said, *chart.notes)), fontsize=8, loc="left"
    )


def draw_chart(chart: Chart, axes: Sequence[Axes]) -> None:
    """Draw the panels of a chart, each into its own axes, above each other."""
    for ax, panel in zip(axes, chart.panels, strict=True):
        draw_panel(panel, chart.x, ax)


def draw_panel(panel: Panel, x: Axis, ax: Axes) -> None:
    """Draw a panel; points are more transparent where there are more of them."""
    for mark in panel.marks:
        color, at = TONES[mark.tone], _values(mark.x, x)
        match mark:
            case Rug():
                height, across = np.full(len(at), _MARK), ax.get_xaxis_transform()
                ax.plot(
                    at, height, "|", color=color, ms=7, transform=across, label=f"{mark.count} {mark.name}"
                )
                ax.legend(
                    loc="lower right", bbox_to_anchor=(1.0, 0.98), frameon=False, fontsize=8, borderpad=0.0
                )
            case Points():
                size = 5 if len(at) <= _FEW else 2.5
                opacity = float(np.clip(_FEW / max(len(at), 1), 0.12, 0.9))
                ax.plot(at, mark.y, "o", color=color, mew=0, markersize=size, alpha=opacity)
            case Line():
                ax.plot(at, mark.y, ":" if mark.dashed else "-", color=color, linewidth=1.6)
    tones = [mark.tone for mark in panel.marks if isinstance(mark, Points)]
    ax.set_xlabel(fitted(x.label, _LABEL))
    ax.set_xlim(*_values(np.array([x.low, x.high]), x))
    if x.begin is not None:
        short = dates.ConciseDateFormatter(ax.xaxis.get_major_locator())  # type: ignore[no-untyped-call]
        ax.xaxis.set_major_formatter(short)
    if panel.y is not None:
        ax.set_ylim(panel.y.low, panel.y.high)
        ax.set_ylabel(panel.y.label.replace(" minus ", " minus\n"))
        ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set_title(panel.title, loc="left", fontsize=9, color=TONES[tones[0]] if tones else None)


def _values(values: NDArray[np.floating], axis: Axis) -> NDArray[np.floating] | NDArray[np.datetime64]:
    """Values as matplotlib takes them: instants where the axis has dates."""
    if axis.begin is None:
        return values
    return axis.begin + (1e3 * values).astype("timedelta64[ms]")


def title_beside(labels: Iterable[str], ax: Axes) -> int:
    """Characters in a line of a title that begins to the right of the labels of the vertical axis."""
    longest = max((len(line) for label in labels for line in label.splitlines()), default=0)
    inches = ax.figure.bbox.width / ax.figure.dpi
    return max(20, int((inches - _MARGIN - _LABEL_CHARACTER * longest) / _TITLE_CHARACTER))


def fitted(text: str, width: int) -> str:
    r"""Text in at most three lines of `width` characters; dollar signs do not begin mathematics.

    Examples
    --------
    >>> fitted("a column of $dollars$ and cents", 16)
    'a column of\n\\$dollars\\$ and\ncents'
    """
    return textwrap.fill(text, width, max_lines=_MOST, placeholder=" …").replace("$", r"\$")


def save_figure(figure: Figure, path: Path, command: str, **options: Any) -> None:
    """Write a figure, complete or not at all, in the format of its ending.

    Raises `UsageError` if the file cannot be written. The command that made it is written to the file if its
    format allows; `options` are for `Figure.savefig`.
    """
    ending = path.suffix.lower().removeprefix(".")
    metadata = {_MAKER[ending]: f"echocal {command}"} if ending in _MAKER else None
    with replacing(path) as unfinished:
        figure.savefig(unfinished, format=ending, dpi=150, metadata=metadata, **options)


def save_figures(figures: Mapping[str, Figure | None], folder: str | Path, form: str) -> list[Path]:
    """Write figures by the names of their files, which end as their format is called.

    The folder is created if it does not exist. Raises `UsageError` if it cannot be written.
    """
    named = zip(in_form(figures, form), figures.values(), strict=True)
    paths = {Path(folder) / name: figure for name, figure in named if figure is not None}
    with writing(Path(folder)):
        Path(folder).mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        for path, figure in paths.items():
            save_figure(figure, path, "diagnose")
    return list(paths)


def in_form(names: Iterable[str], form: str) -> tuple[str, ...]:
    """Names of files with the ending of a format.

    Raises `UsageError` if it is none of `FORMS`.

    Examples
    --------
    >>> in_form(["gain.png"], "svg")
    ('gain.svg',)
    """
    if form not in FORMS:
        raise UsageError(f"plots are written as {', '.join(FORMS)}, not as '{form}'")
    return tuple(str(Path(name).with_suffix(f".{form}")) for name in names)
