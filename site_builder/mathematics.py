"""Mathematics as MathML, which browsers show without a script: blocks ```math, and $...$ in a line."""

import re
from html import escape
from typing import Any
from xml.etree.ElementTree import Element

from latex2mathml.converter import convert, convert_to_element
from markdown import Extension, Markdown
from markdown.inlinepatterns import InlineProcessor

__all__ = ["block", "makeExtension"]

_INLINE = r"(?<![\\$\w])\$(?!\s)([^$]+?)(?<!\s)\$(?![\w$])"
_TAG = re.compile(r"\s*\\tag\{([^}]*)\}")


def block(source: str, *_: Any, **__: Any) -> str:
    """Format a displayed equation; its number stands at the right, and is an anchor (``eq-32``)."""
    tags = _TAG.findall(source)
    body = convert(_TAG.sub("", source).strip(), display="block")
    number = "".join(f'<span class="equation-number">({escape(tag)})</span>' for tag in tags)
    anchor = f' id="eq-{escape(tags[0])}"' if tags else ""
    return f'<div class="equation"{anchor}>{body}{number}</div>'


class _Inline(InlineProcessor):
    def handleMatch(self, found: re.Match[str], data: str) -> tuple[Element, int, int]:  # type: ignore[override]  # noqa: N802
        return convert_to_element(found[1]), found.start(0), found.end(0)


class _Mathematics(Extension):
    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802
        md.inlinePatterns.register(
            _Inline(r"(?<![\\$\w])\$(?!\s)([^$]+?)(?<!\s)\$(?![\w$])", md), "math", 185
        )


def makeExtension(**options: Any) -> Extension:  # noqa: N802
    """Make the extension, as Markdown asks for it."""
    return _Mathematics(**options)
