"""Pages that are made: the start (README), the command line (its help), Python (its docstrings)."""

import re
from inspect import unwrap
from operator import attrgetter
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from typer.cli import get_docs_for_click
from typer.main import get_command

import echocal
from echocal.cli import app

__all__ = ["on_files"]

ROOT = Path(__file__).parents[1]

_ESTIMATOR = ("EchoCorrector",) if "EchoCorrector" in echocal.__all__ else ()  # needs scikit-learn
TOPICS = {
    "Air and distances": ("speed_of_sound", "time_of_flight", "distance", "error", "absorption"),
    "Models": ("Model", "effects", "domain_violations"),
    "Waveforms": ("echo_times", "EchoTimes", "read_waveforms"),
    "Tables": (
        "read_observations",
        "Observations",
        "correct",
        "Corrected",
        "correct_files",
        "sweep",
        *_ESTIMATOR,
    ),
    "Diagnosis": (
        "diagnose",
        "diagnose_many",
        "diagnose_fleet",
        "Diagnosis",
        "noises",
        "gross_faults",
        "row_faults",
    ),
    "Watching": (
        "watch",
        "watch.Fleet",
        "watch.Reference",
        "watch.State",
        "watch.WatchSettings",
        "watch.Event",
    ),
    "Calibration and verification": (
        "calibrate",
        "Calibration",
        "Regression",
        "budget",
        "Budget",
        "verify",
        "verify_model",
        "Verification",
    ),
    "An emulated board": ("emulate", "Emulation", "error_parts"),
    "Errors and warnings": (
        "EchocalError",
        "BoundError",
        "DataError",
        "ModelError",
        "UsageError",
        "DataWarning",
        "DisagreementWarning",
        "DomainWarning",
    ),
}
"""Public names by topic; a test checks that none is missing."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made."""
    pages = {
        "index.md": _linked(ROOT / "README.md"),
        "reference/changelog.md": _linked(ROOT / "CHANGELOG.md", "../"),
        "reference/contributing.md": _linked(ROOT / "CONTRIBUTING.md", "../"),
        "reference/command-line.md": _command_line(),
        "reference/python.md": _python(),
    }
    for name, content in pages.items():
        files.append(File.generated(config, name, content=content))
    return files


def _linked(page: Path, up: str = "") -> str:
    """A page of the root: links into docs become links of the site, others become plain text."""

    def link(found: re.Match[str]) -> str:
        text, target = found[1], found[2]
        if target.startswith("docs/"):
            return f"[{text}]({up}{target.removeprefix('docs/')})"
        made = {"README.md": "index.md", "CHANGELOG.md": "reference/changelog.md"}
        made["CONTRIBUTING.md"] = "reference/contributing.md"
        name, _, anchor = target.partition("#")
        if name in made:
            return f"[{text}]({up}{made[name]}{anchor and '#' + anchor})"
        return found[0] if target.startswith(("#", "http")) else f"{text} (`{target}`)"

    return re.sub(r"(?<!`)\[([^\]]+)\]\(([^)\s]+)\)", link, page.read_text(encoding="utf-8"))


def _command_line() -> str:
    command: Any = get_command(app)
    with command.make_context("echocal", [], resilient_parsing=True) as context:
        text: str = get_docs_for_click(obj=command, ctx=context, name="echocal", title="Command line")
        for name in command.list_commands(context):  # the list of commands cuts their sentences off
            told = command.get_command(context, name).help.partition("\n\n")[0].replace("\n", " ")
            cut = re.search(rf"^\* `{name}`: .*$", text, re.MULTILINE)
            assert cut
            text = text.replace(cut[0], f"* [`{name}`](#echocal-{name}): {told}", 1)
    return text


def _python() -> str:
    lines = ["# Python", "", "`import echocal` gives all names of this page.", ""]
    for topic, names in TOPICS.items():
        lines += [f"## {topic}", ""]
        for name in names:
            made = attrgetter(name)(echocal)
            made = unwrap(made)
            lines += [
                f"::: {made.__module__}.{made.__qualname__}",
                "    options:",
                "      heading_level: 3",
                "",
            ]
    return "\n".join(lines)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Comments of the sources are no text."""
    return re.sub(r"<!--.*?-->\n?", "", markdown, flags=re.DOTALL)
