"""A random test that failed can be run again with the same numbers."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
FAILING = """
import numpy as np
import pytest
from hypothesis import Phase, given, settings, strategies as st

@pytest.fixture(scope="module")
def shift(request, seeded):
    return seeded(request).integers(10**9)

@pytest.mark.parametrize("case", [1, 2])
def test_numbers(case, random, shift):
    assert False, f"drawn {case}: {random.integers(10**9)} {shift}"

@settings(phases=[Phase.generate])
@given(st.integers(0, 10**9))
def test_hypothesis(number):
    drawn.append(number)
    assert len(drawn) < 5, f"drawn h: {drawn[:5]}"

def test_without_numbers():
    assert False

drawn = []
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Tests that fail, beside a copy of this project's conftest.py."""
    place = tmp_path_factory.mktemp("failing")
    shutil.copy(HERE / "conftest.py", place)
    (place / "test_failing.py").write_text(FAILING)
    (place / "pytest.ini").write_text("[pytest]\n")
    return place


def run(folder: Path, *more: str, seed: int | None = None) -> str:
    known = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST_", "ECHOCAL_SEED"))}
    environment = known | ({} if seed is None else {"ECHOCAL_SEED": str(seed)})
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *more]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stdout


def drawn(output: str) -> dict[str, str]:
    return dict(re.findall(r"^E +AssertionError: drawn (\w): (.*)$", output, re.MULTILINE))


@pytest.mark.slow
def test_a_failed_test_says_its_seed_and_draws_the_same_again(folder: Path) -> None:
    """In two worker processes, then in none, then one test alone; and other numbers from another seed."""
    first = run(folder, "-n", "2")
    (seed,) = {int(found) for found in re.findall(r"ECHOCAL_SEED=(\d+)", first)}
    assert first.count("same numbers again") == 3  # not where nothing was drawn
    name = "test_failing.py::test_numbers[2]"
    assert f"ECHOCAL_SEED={seed} pytest '{name}'" in first
    numbers = drawn(first)
    assert set(numbers) == {"1", "2", "h"}
    assert numbers["1"].split()[0] != numbers["2"].split()[0]
    assert drawn(run(folder, seed=seed)) == numbers
    assert drawn(run(folder, name, seed=seed)) == {"2": numbers["2"]}
    other = drawn(run(folder, name, seed=seed + 1))["2"]
    assert not set(other.split()) & set(numbers["2"].split())


def unseeded(source: str) -> list[int]:
    """Lines of calls that draw numbers which nobody can draw again."""
    lines = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            no_seed = not node.args and not node.keywords
            if (name.endswith(("default_rng", "SeedSequence")) and no_seed) or re.match(
                r"secrets\.|os\.urandom|np\.random\.(rand|normal|uniform|choice|seed)", name
            ):
                lines.append(node.lineno)
    return lines


def test_what_is_forbidden_is_seen() -> None:
    assert unseeded("a = np.random.default_rng()\nb = default_rng(1)\nc = secrets.randbits(3)") == [1, 3]


def test_no_test_draws_what_cannot_be_drawn_again() -> None:
    files = [path for path in HERE.rglob("*.py") if path.name != "conftest.py"]
    assert len(files) > 80
    found = [f"{path.relative_to(HERE)}:{line}" for path in files for line in unseeded(path.read_text())]
    assert not found, "take the fixture `random` or `seeded` of tests/conftest.py"


CLAIMS = """
import pytest

draws = {}

def draw(random, name):
    draws.setdefault(name, []).append(random.integers(10**9))
    return draws[name]

@pytest.mark.statistical
def test_unlucky_once(random):
    drawn = draw(random, "once")
    assert len(set(drawn)) == 2

@pytest.mark.statistical
def test_broken(random):
    assert len(draw(random, "broken")) > 2

def test_of_every_draw(random):
    assert len(draw(random, "every")) > 1
"""


@pytest.mark.slow
def test_a_claim_about_nearly_all_draws_is_drawn_once_more(folder: Path, tmp_path: Path) -> None:
    """Others are not, and one that fails twice fails."""
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    (tmp_path / "test_failing.py").write_text(CLAIMS)
    output = run(tmp_path, "-n", "2")
    assert re.search(r"2 failed, 1 passed, .*2 rerun in", output)
    failed = re.findall(r"^FAILED \S+::(\w+)", output, re.MULTILINE)
    assert sorted(failed) == ["test_broken", "test_of_every_draw"]
