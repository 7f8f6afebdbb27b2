"""The site builds without a warning, asks no other host for anything, and has every page and name."""

import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from browsed import chromium

import echocal

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(out)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},  # about a version to come
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stderr
    return out


class Loaded(HTMLParser):
    """What a page loads by itself, its anchors, and the text outside its code."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.urls: list[str] = []
        self.anchors: set[str] = set()
        self.text: list[str] = []
        self.inside: list[str] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag in {"script", "img", "iframe", "source"} and given.get("src"):
            self.urls.append(str(given["src"]))
        if tag == "link" and given.get("rel") not in {"canonical", "prev", "next"} and given.get("href"):
            self.urls.append(str(given["href"]))
        if given.get("id"):
            self.anchors.add(str(given["id"]))
        if tag in {"code", "pre", "script", "style", "math"}:
            self.inside.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.inside and self.inside[-1] == tag:
            self.inside.pop()

    def handle_data(self, data: str) -> None:
        if not self.inside:
            self.text.append(data)


def pages(site: Path) -> list[Path]:
    found = sorted(site.rglob("*.html"))
    assert len(found) >= 25
    return found


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    for page in pages(site):
        foreign = [url for url in Loaded(page).urls if re.match(r"(https?:)?//", url)]
        assert not foreign, (page.name, foreign)
    for sheet in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(https?:)?//", sheet.read_text(encoding="utf-8")), sheet.name


def test_every_page_of_the_folder_is_in_the_site(site: Path) -> None:
    for page in DOCS.rglob("*.md"):
        assert (site / page.relative_to(DOCS)).with_suffix(".html").is_file(), page


@pytest.fixture
def page(site: Path) -> Iterator[Any]:
    """A page of a browser that is told what it asks for and what goes wrong."""
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1200, "height": 900})
        page.set_default_timeout(60_000)
        page.said, page.asked = [], []
        page.on("console", lambda message: page.said.append(message.text))
        page.on("pageerror", lambda error: page.said.append(str(error)))
        page.on("request", lambda request: page.asked.append(request.url))
        yield page
        browser.close()


@pytest.mark.parametrize("served", [False, True], ids=["as files", "from a server"])
def test_the_search_finds_a_page(site: Path, page: Any, served: bool) -> None:
    with ExitStack() as at_end:
        address = site.as_uri()
        if served:
            handler = partial(Silent, directory=str(site))
            server = at_end.enter_context(ThreadingHTTPServer(("127.0.0.1", 0), handler))
            threading.Thread(target=server.serve_forever, daemon=True).start()
            at_end.callback(server.shutdown)
            address = f"http://127.0.0.1:{server.server_port}"
        page.goto(f"{address}/index.html")
        page.locator("[data-md-component=search-query]").click()
        page.keyboard.type("crosstalk")
        first = page.locator(".md-search-result__link").first
        first.wait_for()
        assert first.get_attribute("href").partition("?")[0] == f"{address}/effects.html"
        assert not [url for url in page.asked if not url.startswith(address)]
        assert not page.said


class Silent(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Say nothing of requests."""


def test_the_gallery_begins_with_thumbnails_side_by_side(site: Path, page: Any) -> None:
    page.goto((site / "gallery.html").as_uri())
    pictures = page.locator(".thumbnails img").all()
    assert len(pictures) == page.locator("article h2").count() > 0
    boxes = [picture.bounding_box() for picture in pictures]
    assert len({box["y"] for box in boxes[:4]}) == 1, "a row of them"
    assert all(picture.evaluate("one => one.naturalWidth > 0") for picture in pictures)
    anchors = Loaded(site / "gallery.html").anchors
    for link in page.locator(".thumbnails a").all():
        assert link.get_attribute("href").removeprefix("#") in anchors


def test_signatures_are_wrapped(site: Path, page: Any) -> None:
    """At the width of a phone, too, no signature goes beyond its box."""
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto((site / "reference" / "python.html").as_uri())
    signatures = page.locator(".doc-signature code")
    assert signatures.count() > len(echocal.__all__) / 2
    assert (
        signatures.evaluate_all("all => all.filter(one => one.scrollWidth > one.clientWidth + 1).length") == 0
    )
    assert signatures.first.inner_text().count("\n") > 5, "an argument a line"


def test_equations_are_mathematics(site: Path) -> None:
    for page in (DOCS / "method.md", *(DOCS / "method").glob("*.md")):
        method = (site / page.relative_to(DOCS)).with_suffix(".html").read_text(encoding="utf-8")
        source = page.read_text(encoding="utf-8")
        assert method.count('class="equation"') == source.count("```math")
        for tag in re.findall(r"\\tag\{([^}]*)\}", source):
            assert f'id="eq-{tag}"' in method
    for page in pages(site):
        read = Loaded(page)
        assert not [text for text in read.text if re.search(r"\$\\?[a-zA-Z]", text)], page.name
        assert not re.findall(r"<m[a-z]+>\\[a-zA-Z]+", page.read_text(encoding="utf-8")), page.name


def test_the_reference_has_every_public_name(site: Path) -> None:
    anchors = Loaded(site / "reference" / "python.html").anchors
    tables = {"DOMAIN_VIOLATIONS", "__version__", "firmware"}
    for name in set(echocal.__all__) - tables:
        assert any(anchor.rpartition(".")[2] == name for anchor in anchors), name


def test_the_reference_has_every_command_and_option(site: Path) -> None:
    text = (site / "reference" / "command-line.html").read_text(encoding="utf-8")
    for words in ("diagnose", "correct", "inspect", "watch", "firmware", "effects list"):
        assert f'id="echocal-{words.replace(" ", "-")}"' in text
    assert "--hold-out-after" in text
    assert "..." not in re.findall(r'<li><a href="#echocal-diagnose">.*?</li>', text, re.DOTALL)[0]
