"""Every command and every example that the documentation shows is run."""

import doctest
import importlib
import os
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import echocal
from echocal.cli import COMMANDS

ROOT = Path(__file__).parents[1]
STORIES = {"tutorial.md"}  # each block goes on where the one before ended: tests/test_how_to.py
PAGES = [ROOT / "README.md", *(p for p in sorted((ROOT / "docs").glob("*.md")) if p.name not in STORIES)]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(language: str) -> list[tuple[str, str]]:
    found = []
    for page in PAGES:
        fences = FENCE.finditer(page.read_text())
        texts = [match[2] for match in fences if match[1] == language]
        found += [(f"{page.name}-{number}", text) for number, text in enumerate(texts, 1)]
    return found


def commands(text: str) -> list[str]:
    joined = text.replace("\\\n", " ")
    return [line for line in joined.splitlines() if line.startswith("echocal ")]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the shipped examples, in which the documentation's commands run."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize(("name", "text"), blocks("sh"), ids=lambda value: value.split("\n")[0][:40])
def test_shell_blocks(name: str, text: str, workplace: Path) -> None:
    bin_first = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for command in commands(text):
        run = subprocess.run(  # the page's command, as a reader would type it
            ["bash", "-c", command],
            cwd=workplace,
            env={**os.environ, "PATH": bin_first},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert run.returncode == 0, f"{name}: {command}\n{run.stdout}\n{run.stderr}"


@pytest.mark.parametrize(("name", "text"), blocks("python"), ids=lambda value: value.split("\n")[0][:40])
def test_python_blocks(name: str, text: str, workplace: Path) -> None:
    engines = [name for name in ("duckdb", "pyspark") if re.search(rf"(import|from) {name}\b", text)]
    for engine in engines:
        pytest.importorskip(engine)
        if engine == "pyspark" and shutil.which("java") is None and "JAVA_HOME" not in os.environ:
            pytest.skip("Spark needs Java")
    if engines:  # in a process of their own: they keep threads and write when they end
        subprocess.run(
            [sys.executable, "-c", text], cwd=workplace, capture_output=True, timeout=300, check=True
        )
        return
    if ">>>" in text:
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
        runner.run(doctest.DocTestParser().get_doctest(text, {"echocal": echocal}, name, None, 0))
        assert runner.failures == 0
    else:
        exec(compile(text, name, "exec"), {"__name__": name})


def modules() -> list[str]:
    found = pkgutil.walk_packages(echocal.__path__, "echocal.")
    return ["echocal", *(module.name for module in found if module.name != "echocal.__main__")]


@pytest.mark.parametrize("name", modules())
def test_docstrings(name: str, workplace: Path) -> None:
    module = importlib.import_module(name)
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    assert doctest.testmod(module, optionflags=flags).failed == 0


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_documented(name: str) -> None:
    pages = "\n".join(page.read_text() for page in PAGES)
    assert f"echocal {name}" in pages, f"no page shows `echocal {name}`"


def test_public_objects_have_examples() -> None:
    for name in echocal.__all__:
        public = getattr(echocal, name)
        if callable(public) and not (isinstance(public, type) and issubclass(public, Exception | Warning)):
            assert ">>>" in (public.__doc__ or ""), f"echocal.{name} has no runnable example"
