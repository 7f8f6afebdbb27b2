"""Labels and titles: text of any length, as matplotlib can draw it."""

import textwrap
from collections.abc import Iterable

from matplotlib.axes import Axes

__all__ = ["fitted", "title_beside"]

_MOST = 3  # lines
_LABEL_CHARACTER, _TITLE_CHARACTER = 0.069, 0.062  # inches, at 9 and at 8 points
_MARGIN = 0.2  # inches


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
