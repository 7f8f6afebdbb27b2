"""A page as its readers have it: what it says, what it would fetch, and what a browser does with it."""

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

__all__ = ["CLEAN", "Drawn", "Text", "browsed", "chromium", "drawn_in"]

CLEAN = {"said": [], "drawn": True, "wide": False, "asked": []}
"""What a browser tells of a page that is in order."""

_WATCH = r"""<script>
const said = []; window.addEventListener("error", e => said.push(e.message));
for (const kind of ["error", "warn"]) console[kind] = (...w) => said.push(w.join(" "));
window.addEventListener("load", () => setTimeout(() => {
  const figures = [...document.querySelectorAll("svg.chart")];
  const some = document.querySelector("svg.chart, .bars") !== null;
  const drawn = some && figures.every(svg => svg.querySelector("text.tick") &&
    [...svg.querySelectorAll(".plot path")].every(p => /^matrix\([^N]*$/.test(p.getAttribute("transform"))));
  const wide = document.documentElement.scrollWidth > document.documentElement.clientWidth;
  const asked = performance.getEntriesByType("resource").filter(r => !r.name.startsWith("data:"));
  document.title = JSON.stringify({said, drawn, wide, asked: asked.map(r => r.name)});
}, 500));
</script>"""


class Text(HTMLParser):
    """What a reader sees, and what the page would fetch."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self._parts: list[str] = []
        self._hidden = ""
        self.feed(page)
        self.seen = re.sub(r"\s+", " ", " ".join(self._parts))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "style"):
            self._hidden = tag
        self.ids += [value or "" for name, value in attrs if name == "id"]
        asked = [value or "" for name, value in attrs if name in ("src", "href", "srcset", "data")]
        self.links += [value[1:] for value in asked if value.startswith("#")]
        self.fetched += [value for value in asked if not value.startswith("#")]

    def handle_endtag(self, tag: str) -> None:
        if tag == self._hidden:
            self._hidden = ""

    def handle_data(self, data: str) -> None:
        if not self._hidden:
            self._parts.append(data)


@dataclass(frozen=True)
class Drawn:
    """What a figure of a page shows of one kind: its name, its values, and the rows of the source."""

    name: str
    x: list[float]
    y: list[float]
    rows: list[int]


def drawn_in(page: str, figure: int) -> list[Drawn]:
    """Points and lines of a figure, as they stand in the page."""
    svg = re.findall(r'<svg class="chart".*?</svg>', page, re.DOTALL)[figure]
    found = []
    for kind, name, rows, path in re.findall(
        r'<path class="(\w+)[^"]*" data-name="([^"]*)"(?: data-rows="([^"]*)")? d="([^"]*)"', svg
    ):
        numbers = [float(text) for text in re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", path)]
        every = 2 if kind == "line" else 3
        found.append(Drawn(name, numbers[::every], numbers[1::every], [int(row) for row in rows.split()]))
    return found


def chromium() -> str:
    """Path of the browser; without one, the test is skipped."""
    names = ("chromium", "chromium-browser", "google-chrome")
    if (browser := next(filter(None, map(shutil.which, names)), None)) is None:
        pytest.skip("no Chromium")
    return browser


def browsed(page: str, folder: Path) -> dict[str, Any]:
    """Show a page in a browser of 500 pixels: messages, whether all is drawn and fits, and requests."""
    browser = chromium()
    file = folder / "page.html"
    file.write_text(page.replace("<head>", f"<head>{_WATCH}", 1), encoding="utf-8")
    command = [browser, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    command += ["--dump-dom", f"--user-data-dir={folder / 'profile'}", "--window-size=500,900"]
    command += ["--virtual-time-budget=20000", file.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=True)
    (title,) = re.findall(r"<title>(\{.*?\})</title>", done.stdout)
    told: dict[str, Any] = json.loads(title.replace("&quot;", '"'))
    return told
