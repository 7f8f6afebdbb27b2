"""The console that every command prints by: it shows the signs of other people's data, never obeys them."""

import codecs
import sys
from collections.abc import Iterator
from typing import Any

import rich.console
from rich.segment import Segment
from rich.text import Text

_PLAIN = str.maketrans(
    {"✓": "+", "✗": "x", "≠": "#", "█": "#", "━": "-", "−": "-", "–": "-", "≥": ">=", "±": "+/-", "…": "..."}
    | dict(zip("▁▂▃▄▅▆▇", "._-=+*%", strict=True))
    | {"°": "deg", "µ": "u", "μ": "u", "²": "^2"}
)
"""Signs that messages use, in ASCII."""


class Console(rich.console.Console):
    """A console whose texts cannot steer the terminal: notes, tables, reports; see `visible`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.push_render_hook(_Visible())

    def render_str(self, text: str, **options: Any) -> Text:
        """Make a text of a string; rich alone would leave some signs out."""
        return super().render_str(_lines(text), **options)


class _Visible(rich.console.RenderHook):
    """Stands where all that is printed passes."""

    def process_renderables(
        self, renderables: list[rich.console.ConsoleRenderable]
    ) -> list[rich.console.ConsoleRenderable]:
        return [_Shown(own) for own in renderables]


class _Shown:
    def __init__(self, own: rich.console.ConsoleRenderable) -> None:
        self._own = own

    def __rich_console__(
        self, console: rich.console.Console, options: rich.console.ConsoleOptions
    ) -> Iterator[Segment]:
        for text, style, control in console.render(self._own, options):
            # colors and moves of the cursor are rich's own, and no text
            yield Segment(text if control else _lines(text), style, control)


def _lines(text: str) -> str:
    return "\n".join(visible(line) for line in text.split("\n"))


def write_what_can_be_written() -> None:
    """Let output in an encoding without our signs, such as cp1252, use plain ones instead of failing."""
    codecs.register_error("echocal.plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)  # a stream that somebody put in place may lack it
        if reconfigure is not None:
            reconfigure(errors="echocal.plain")


def visible(text: str) -> str:
    r"""Text on one line, with the signs that would steer a terminal written as escapes.

    Names and ids come from other people's data. They may hold escape sequences, line ends, or marks that
    turn the direction of writing; a terminal would obey.

    Examples
    --------
    >>> visible("tank 7\x1b[2J°\n")
    'tank 7\\x1b[2J°\\n'
    """
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in text)


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end].translate(_PLAIN)
    return text.encode("ascii", "backslashreplace").decode("ascii"), error.end
