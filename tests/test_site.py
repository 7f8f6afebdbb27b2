"""The site builds without a warning, asks no other host for anything, and has every page and name."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

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
