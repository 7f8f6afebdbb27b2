"""A page of sections, each with sentences, figures and a table."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from echocal.charts.parts import Bars, Chart
from echocal.report.html.document import rendered

__all__ = ["Head", "Section", "notes_of", "sections_page"]


@dataclass(frozen=True)
class Head:
    """What stands above all sections.

    Attributes
    ----------
    kind : str
        What the page is: ``Calibration``.
    heading : str
        Name of the table or the model.
    sentence : str
        The result, without the period.
    verdict : str
        A word before it, which gives it its color.
    facts : sequence of (str, str)
    """

    kind: str
    heading: str
    sentence: str
    verdict: str = ""
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
