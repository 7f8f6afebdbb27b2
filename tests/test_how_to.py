"""The how-to pages are stories: their blocks run in order in one folder, and print what the pages show."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "docs" / "tutorial.md", *sorted((ROOT / "docs" / "how-to").glob("*.md"))]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"\d[\d,]*(?:\.\d+)?")
BORDER = re.compile(r"[\u2500-\u259f]+")


def flat(text: str) -> str:
    return " ".join(BORDER.sub(" ", text).split())


def near(shown: str, printed: str) -> bool:
    """Whether two numbers agree to two units of the last digit, or to 2 %: processors differ."""
    a, b = (float(text.replace(",", "")) for text in (shown, printed))
    last = 10.0 ** -len(shown.partition(".")[2])
    return abs(a - b) <= max(2 * last if "." in shown else 0.0, 0.02 * abs(b))


def shows(piece: str, output: str) -> bool:
    numbers = NUMBER.findall(piece)
    pattern = NUMBER.pattern.join(re.escape(part) for part in NUMBER.split(piece))
    pattern = pattern.replace(NUMBER.pattern, f"({NUMBER.pattern})")
    return any(
        all(near(a, b) for a, b in zip(numbers, found.groups(), strict=True))
        for found in re.finditer(pattern, output)
    )


def run(language: str, text: str, folder: Path) -> str:
    text = re.sub(r"# exit code (\d)$", r"&& exit 99 || test $? = \1", text, flags=re.MULTILINE)
    start = ["bash", "-euo", "pipefail", "-c"] if language == "sh" else [sys.executable, "-c"]
    first = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(  # as a reader would type it
        [*start, text],
        cwd=folder,
        env={**os.environ, "PATH": first, "COLUMNS": "200"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, f"{text}\n{done.stdout}"
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_page_is_true(page: Path, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    output = ""
    for language, text in FENCE.findall(page.read_text()):
        if language in ("sh", "python"):
            output = run(language, text, tmp_path)
        elif language == "text":
            for piece in re.split(r"^ *\.\.\.\n", text, flags=re.MULTILINE):
                assert shows(flat(piece), flat(output)), f"{page.name} shows, and nothing prints:\n{piece}"


def test_a_page_that_is_not_true_is_seen() -> None:
    printed = flat("│ named: the data name fixed_delay │\ndelay = 78.57 +/- 0.47 us\n 480 of 480 rows")
    assert shows(flat("delay = 78.6 +/- 0.5 us"), printed)
    assert shows(flat("named: the data\nname fixed_delay"), printed)
    assert not shows(flat("delay = 88.57 +/- 0.47 us"), printed)
    assert not shows(flat("479 of 480 rows").replace("479", "40"), printed)
    assert not shows(flat("delay = 78.57 +/- 0.47 ms"), printed)
