"""One HTML document that needs nothing from any host, from a template of this package."""

from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from typing import Any

__all__ = ["Drawn", "drawn", "rendered"]

_CONFIG = {"displaylogo": False, "responsive": True, "scrollZoom": False}


@dataclass(frozen=True)
class Drawn:
    """A figure as HTML."""

    title: str
    html: str
    caption: str = ""


def drawn(title: str, figure: Any, caption: str = "") -> Drawn:
    """Return a figure of plotly as a part of a page."""
    return Drawn(title, figure.to_html(full_html=False, include_plotlyjs=False, config=_CONFIG), caption)


def rendered(template: str, command: str, title: str, **content: Any) -> str:
    """Fill a template.

    Parameters
    ----------
    template : str
        File of this package.
    command : str
        Command that makes the page, by which it is known again.
    title : str
        Title of the window.
    **content
        What the template shows.

    """
    from jinja2 import Environment, FunctionLoader, StrictUndefined
    from plotly.offline import get_plotlyjs

    environment = Environment(
        loader=FunctionLoader(lambda name: (files(__package__) / name).read_text(encoding="utf-8")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    common = {"command": command, "title": title, "version": version("echocal")}
    return environment.get_template(template).render(script=get_plotlyjs(), **common, **content)
