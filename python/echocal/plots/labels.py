"""Names that somebody else chose, as matplotlib can draw them."""

import textwrap

__all__ = ["fitted"]

_MOST = 3  # lines


def fitted(text: str, width: int) -> str:
    r"""Text in a few lines of `width` characters, cut off after them; no part of it is taken for mathematics.

    Examples
    --------
    >>> fitted("a column of $dollars$ and cents", 16)
    'a column of\n\\$dollars\\$ and\ncents'
    """
    return textwrap.fill(text, width, max_lines=_MOST, placeholder=" …").replace("$", r"\$")
