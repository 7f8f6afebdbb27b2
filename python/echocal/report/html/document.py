"""One HTML document that needs nothing from any host, from a template of this package."""

from importlib.metadata import version
from importlib.resources import files
from typing import Any

from echocal.checksums import SEAL, sealed
from echocal.report.html.drawing import drawn

__all__ = ["rendered"]


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
    from markupsafe import Markup

    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["drawn"] = lambda chart: Markup(drawn(chart))
    common = {"command": command, "title": title, "version": version("echocal")}
    common |= {"seal": SEAL.format("")}
    common |= {"script": _text("chart.js"), "style": _text("page.css")}
    return sealed(environment.get_template(template).render(**common, **content))


def _text(name: str) -> str:
    return (files(__package__) / name).read_text(encoding="utf-8")
