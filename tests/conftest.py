"""What all tests share; above all one seed for a whole run, printed, and set again by ``ECHOCAL_SEED``.

A test that needs random numbers asks for the fixture `random`, a fixture of a wider scope for `seeded`.
Each generator depends on the seed of the run and on the name of its test or fixture, on nothing else: a
test draws the same numbers alone, among others, and in any worker process. Hypothesis draws from the same
seed.

The mark ``statistical`` is for a claim about nearly all draws, as "names what was planted", which some draw
in a hundred refutes. Such a test draws once more where its first draw fails, and fails where both do. A claim
about every draw never carries it.
"""

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import hypothesis
import numpy as np
import pytest

VARIABLE = "ECHOCAL_SEED"
SEED = pytest.StashKey[int]()
Seeded = Callable[..., np.random.Generator]


def seed_of(config: pytest.Config) -> int:
    """Seed of this run, the same in every worker process of it."""
    if SEED not in config.stash:
        given = getattr(config, "workerinput", {}).get(VARIABLE) or os.environ.get(VARIABLE)
        config.stash[SEED] = int(given) if given else int(np.random.SeedSequence().generate_state(1)[0])
    return config.stash[SEED]


def generator(seed: int, *words: str) -> np.random.Generator:
    """Generate numbers for one name within a run."""
    return np.random.default_rng([seed, *"\0".join(words).encode()])


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    if config.option.hypothesis_seed is None:
        config.option.hypothesis_seed = str(seed_of(config))
    hypothesis.settings.register_profile("echocal", hypothesis.settings.default, print_blob=True)
    hypothesis.settings.load_profile("echocal")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Draw once more for a claim about nearly all draws."""
    for item in items:
        if item.get_closest_marker("statistical"):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell a worker process of xdist the seed."""
    node.workerinput[VARIABLE] = str(seed_of(node.config))


def pytest_report_header(config: pytest.Config) -> str:
    return f"random tests: {VARIABLE}={seed_of(config)}"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Say how to repeat a failed test that drew random numbers."""
    report = yield
    drew = "seeded" in getattr(item, "fixturenames", ()) or hasattr(getattr(item, "obj", None), "hypothesis")
    if report.failed and drew:
        again = f"{VARIABLE}={seed_of(item.config)} pytest '{item.nodeid}'"
        report.sections.append(("the same numbers again", again))
    return report


@pytest.fixture(scope="session")
def seeded(pytestconfig: pytest.Config) -> Seeded:
    """Call it with a fixture's ``request`` (and words): a generator for that fixture (and those words)."""

    def fresh(request: pytest.FixtureRequest, *words: str) -> np.random.Generator:
        names = (request.node.nodeid, str(request.fixturename), str(getattr(request, "param", "")))
        draw = getattr(request.node, "execution_count", 1)
        again = () if draw == 1 else (f"draw {draw}",)
        return generator(seed_of(pytestconfig), *names, *words, *again)

    return fresh


@pytest.fixture
def random(request: pytest.FixtureRequest, seeded: Seeded) -> np.random.Generator:
    """Random numbers of one test, drawn anew in every run; repeated with ``ECHOCAL_SEED``."""
    return seeded(request)


@pytest.fixture(scope="session", autouse=True)
def cache_of_this_run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What is kept for later calls, such as the compiled Arduino core, is kept for this run only."""
    base = tmp_path_factory.getbasetemp()
    with pytest.MonkeyPatch.context() as patch:
        workers_share = base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base
        patch.setenv("ECHOCAL_CACHE", str(workers_share / "cache"))
        yield


@pytest.fixture
def run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., tuple[int, str]]:
    """Run a command line in an empty folder of its own: exit code and stderr."""
    from echocal.cli import main

    monkeypatch.chdir(tmp_path)

    def command(*words: str) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["echocal", *words])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), capsys.readouterr().err

    return command


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of real measurements, which stands beside the repository and never in it."""
    beside = Path(__file__).parents[2] / "shared"
    folder = Path(os.environ.get("ECHOCAL_SHARED", beside))
    if not folder.is_dir():
        pytest.skip(f"real measurements are absent: no folder {folder} (set ECHOCAL_SHARED)")
    return folder
