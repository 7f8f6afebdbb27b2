"""One HTML document that needs nothing from any host, from a template of this package."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from importlib.metadata import version
from importlib.resources import files
from typing import Any

from numpy.typing import NDArray

from echocal.charts.parts import Axis, Bar, Bars, Chart, Line, Panel, Points, Rug
from echocal.checksums import SEAL, sealed

_DIGITS = 6  # of a value in a page: more than a screen shows


def rendered(template: str, command: str, title: str, **content: Any) -> str:
    """Fill a template.

    The page is known again by the `command` that makes it; `content` is what the template shows.
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


def drawn(chart: Chart | Bars | None) -> str:
    """Return a chart as HTML; nothing for None.

    Examples
    --------
    >>> from echocal.charts.parts import Bar, Bars
    >>> "<b>0.95</b>" in drawn(Bars("", "probability", [Bar("delay", 0.95, "0.95", "after")]))
    True
    """
    if chart is None:
        return ""
    body = _bars(chart) if isinstance(chart, Bars) else _chart(chart)
    title = f"<h3>{escape(chart.title)}</h3>" if chart.title else ""
    said = " ".join(f"{note[:1].upper()}{note[1:]}." for note in chart.notes)
    caption = f"<figcaption>{escape(said)}</figcaption>" if said else ""
    return f"<figure>{title}{body}{caption}</figure>"


def _chart(chart: Chart) -> str:
    panels = "".join(_panel(panel) for panel in chart.panels)
    names = {(mark.tone, mark.name) for panel in chart.panels if not panel.title for mark in panel.marks}
    key = "".join(f'<span class="{tone}">{escape(name)}</span>' for tone, name in sorted(names))
    legend = f'<p class="key">{key}</p>' if key else ""
    label = escape(chart.title or "figure", quote=True)
    return f'<svg class="chart" role="img" aria-label="{label}"{_axis("x", chart.x)}>{panels}</svg>{legend}'


def _panel(panel: Panel) -> str:
    y = "" if panel.y is None else _axis("y", panel.y)
    marks = "".join(_mark(mark) for mark in panel.marks)
    return f'<g class="panel" data-title="{escape(panel.title, quote=True)}"{y}>{marks}</g>'


def _axis(name: str, axis: Axis) -> str:
    begin = "" if axis.begin is None else f' data-begin="{axis.begin}Z"'
    label = escape(axis.label, quote=True)
    return f' data-{name}="{axis.low:.{_DIGITS}g} {axis.high:.{_DIGITS}g}" data-{name}-label="{label}"{begin}'


def _mark(mark: Points | Line | Rug) -> str:
    """A path in the units of the data; the script moves it to its place, and reads values from it."""
    rows = ""
    if isinstance(mark, Rug):
        kind, path = "rug", "".join(f"M{x} 0v9" for x in _texts(mark.x))
    else:
        pairs = zip(_texts(mark.x), _texts(mark.y), strict=True)
        if isinstance(mark, Points):
            kind, path = "points", "".join(f"M{x} {y}h0" for x, y in pairs)
            rows = "" if mark.rows is None else f' data-rows="{" ".join(map(str, mark.rows.tolist()))}"'
        else:
            kind = "line dashed" if mark.dashed else "line"
            path = "M" + "L".join(f"{x} {y}" for x, y in pairs)
    name = escape(mark.name, quote=True)
    return f'<path class="{kind} {mark.tone}" data-name="{name}"{rows} d="{path}"/>'


def _texts(values: NDArray[Any]) -> list[str]:
    return [f"{value:.{_DIGITS}g}" for value in values.tolist()]


def _bars(chart: Bars) -> str:
    most = chart.most or 1.0
    rows = "".join(
        f"<span>{escape(bar.label)}</span><i>{_bar(bar, most)}</i><b>{escape(bar.text)}</b>"
        for bar in chart.bars
    )
    scale = f"<span>{escape(chart.label)}</span><em><span>0</span><span>{most:.3g}</span></em><b></b>"
    return f'<div class="bars">{rows}{scale}</div>'


def _bar(bar: Bar, most: float) -> str:
    return "".join(
        f'<i class="{bar.tone}" style="width:{100 * share / most:.4g}%"></i>'
        for share in bar.shares or (bar.value,)
    )


@dataclass(frozen=True)
class Head:
    """What stands above all sections."""

    kind: str  # what the page is: ``Calibration``
    heading: str  # name of the table or the model
    sentence: str  # the result, without the period
    verdict: str = ""  # a word before it, which gives it its color
    facts: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True)
class Section:
    """A part of a page; an empty one is left out."""

    title: str
    texts: Sequence[str] = ()
    charts: Sequence[Chart | Bars] = ()
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()


def sections_page(command: str, head: Head, sections: Iterable[Section], made_by: str = "") -> str:
    """Return a page as an HTML document that needs no other file and no network.

    Examples
    --------
    >>> page = sections_page("verify", Head("Verification", "log.csv", "all is well"), [])
    >>> "<h1>log.csv</h1>" in page
    True
    """
    filled = [one for one in sections if one.texts or one.charts or one.rows]
    title = f"{head.kind.lower()} of {head.heading}"
    return rendered("sections.html.j2", command, title, sections=filled, made_by=made_by, **vars(head))


def notes_of(notes: Iterable[str]) -> Section:
    """Notes as the last section."""
    return Section("Notes", [f"{note}." for note in notes])
