"""What a terminal or a file cannot show is written in letters that it can."""

import codecs
import sys

__all__ = ["visible", "write_what_can_be_written"]

_PLAIN = str.maketrans(
    {"✓": "+", "✗": "x", "≠": "#", "█": "#", "━": "-", "−": "-", "–": "-", "≥": ">=", "±": "+/-", "…": "..."}
    | dict(zip("▁▂▃▄▅▆▇", "._-=+*%", strict=True))
    | {"°": "deg", "µ": "u", "μ": "u", "²": "^2"}
)
"""Signs that messages use, in ASCII."""


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
