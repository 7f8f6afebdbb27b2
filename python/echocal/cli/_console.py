"""The console that every command prints by: it shows the signs of other people's data, never obeys them."""

from collections.abc import Iterator
from typing import Any

import rich.console
from rich.segment import Segment
from rich.text import Text

from echocal.cli._terminal import visible

__all__ = ["Console"]


class Console(rich.console.Console):
    """A console whose texts cannot steer the terminal: notes, tables, reports; see `visible`.

    Parameters
    ----------
    **options
        As of `rich.console.Console`.
    """

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
