"""The gallery: figures that commands draw of the examples, drawn anew when the site is built."""

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from markdown.extensions.toc import slugify
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

__all__ = ["FIGURES", "Figure", "on_files"]

ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Figure:
    """A figure, the command that draws it, and what a reader can see in it."""

    title: str
    command: str
    file: str
    text: str
    page: str


STUDY = "diagnose examples/study_table2.csv --plots study"
WAREHOUSE = "diagnose examples/warehouse.csv --base cramer --plots warehouse"
STANDS = "diagnose examples/warehouse.csv --base cramer --by stand --plots stands"
FLEET = "diagnose examples/fleet --by sensor_id --base cramer -o verdicts.parquet --plots fleet"
SWEEP = (
    "sweep --temperature 0:50:2 --distance 2 --law linear --effect fixed_speed:weight=1,speed=343 "
    "-o sweep.csv --plot sweep.png"
)
CHOICES = (
    "firmware examples/tank_model.json --target avr --temperature-lsb 0.5 "
    "--max-error-mm 2 --explore -o choices"
)

FIGURES = (
    Figure(
        "Residuals",
        WAREHOUSE,
        "warehouse/residuals.png",
        "What the base simulation leaves, against each column, and what the extended model leaves.",
        "diagnose.md",
    ),
    Figure(
        "Posterior",
        WAREHOUSE,
        "warehouse/posterior.png",
        "Which causes can explain the table. Causes of one class cannot be told apart in these rows.",
        "diagnose.md",
    ),
    Figure(
        "Gain",
        STUDY,
        "study/gain.png",
        "How much smaller the error is on rows that neither the choice nor the fit has seen.",
        "diagnose.md",
    ),
    Figure(
        "What to measure next",
        WAREHOUSE,
        "warehouse/next.png",
        "Rows that would separate the causes of a class, among the rows that there are.",
        "diagnose.md",
    ),
    Figure(
        "Several tables",
        STANDS,
        "stands/sizes.png",
        "The size of a cause in each table, and in all of them together.",
        "diagnose.md",
    ),
    Figure(
        "A fleet",
        FLEET,
        "fleet/fleet.png",
        "In how many sensors each cause is, and how large the errors are.",
        "fleet.md",
    ),
    Figure(
        "A sweep",
        SWEEP,
        "sweep.png",
        "Error of a device that converts with one speed of sound, over the temperature.",
        "tables.md",
    ),
    Figure(
        "Choices for a microcontroller",
        CHOICES,
        "choices/choices.png",
        "Flash, time and error of every function that no other one dominates.",
        "firmware.md",
    ),
)
"""Figures in the order of the page."""


@cache
def _drawn() -> dict[str, bytes]:
    """Content of each figure, by its file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "examples").symlink_to(ROOT / "examples")
        for command in dict.fromkeys(figure.command for figure in FIGURES):
            words = [sys.executable, "-m", "echocal", *command.split()]
            done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode:
                message = f"gallery: echocal {command}: {done.stderr}"
                raise RuntimeError(message)
        return {figure.file: (Path(folder) / figure.file).read_bytes() for figure in FIGURES}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the figures and their page."""
    lines = [
        "# Gallery",
        "",
        "Each figure is drawn by the command below it, from tables of the repository.",
        "",
    ]
    pictures = (f"[![](gallery/{one.file})<br>{one.title}](#{slugify(one.title, '-')})" for one in FIGURES)
    lines += [
        '<div class="thumbnails" markdown>',
        "",
        *(f"- {picture}" for picture in pictures),
        "",
        "</div>",
        "",
    ]
    for figure in FIGURES:
        lines += [
            f"## {figure.title}",
            "",
            figure.text,
            f"More: [{figure.page.removesuffix('.md')}]({figure.page}).",
            "",
        ]
        lines += [
            f"![{figure.title}](gallery/{figure.file})",
            "",
            "```sh",
            f"echocal {figure.command}",
            "```",
            "",
        ]
    files.append(File.generated(config, "gallery.md", content="\n".join(lines)))
    for file, content in _drawn().items():
        files.append(File.generated(config, f"gallery/{file}", content=content))
    return files
