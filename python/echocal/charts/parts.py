"""Parts that describe a figure. A description draws nothing: a renderer does, for a page or for a picture."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.floating[Any]]

MOST = 2000
"""Points of one kind that a figure shows at most: more lie on each other, and make a page heavy."""

_MARGIN = 0.04  # of the range of an axis, on each side


@dataclass(frozen=True)
class Axis:
    """An axis."""

    label: str
    # low, high: ends of what is shown first
    """What it shows, with the unit in brackets."""
    low: float
    high: float
    begin: np.datetime64 | None = None
    """Where the values are seconds since an instant: this instant. Dates are shown then."""


@dataclass(frozen=True, eq=False)
class Points:
    """Points; `rows` are their row numbers in the source, from 1.

    `tone` is the role of a color, such as ``before``: each renderer has its own colors for it.
    """

    name: str
    tone: str
    x: Column
    y: Column
    rows: NDArray[np.int64] | None = None


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points."""

    name: str
    tone: str
    x: Column
    y: Column
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Rug:
    """Marks along the upper edge, which have an x and no y; of `count` marks, these are drawn."""

    name: str
    tone: str
    x: Column
    count: int


@dataclass(frozen=True)
class Panel:
    """Axes and what is drawn in them. Without a `y` axis it is low and shows marks only."""

    title: str
    y: Axis | None
    marks: Sequence[Points | Line | Rug]


@dataclass(frozen=True)
class Chart:
    """Panels above each other that share the x axis."""

    title: str
    x: Axis
    panels: Sequence[Panel]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Bar:
    """A bar: its label, its length, and the number as it is told; `shares` are its parts."""

    label: str
    value: float
    text: str
    tone: str
    shares: Sequence[float] = ()


@dataclass(frozen=True)
class Bars:
    """Bars that begin at zero."""

    title: str
    label: str  # what the length of a bar is, with the unit in brackets
    bars: Sequence[Bar] = field(default_factory=tuple)
    most: float = 1.0  # end of the axis; no bar is longer
    notes: Sequence[str] = ()  # what is said of it, without periods


def span(values: Sequence[Column] | Column) -> tuple[float, float]:
    """Ends of an axis on which all values are visible.

    Examples
    --------
    >>> import numpy as np
    >>> span(np.array([0.0, 100.0, np.nan]))
    (-4.0, 104.0)
    """
    every = np.concatenate([np.ravel(one) for one in values])
    known = every[np.isfinite(every)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    room = _MARGIN * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room


def evenly(count: int, most: int = MOST) -> NDArray[np.int64]:
    """Positions of at most `most` of `count` things, evenly chosen.

    Examples
    --------
    >>> evenly(5, 3).tolist()
    [0, 2, 4]
    """
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))
