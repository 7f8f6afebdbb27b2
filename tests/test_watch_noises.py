"""What a watch learns of the noise, and where it states no rate of false alarms; on fresh sensors."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from watched import log

import echocal
from echocal.watch import Fleet, Reference, State, WatchSettings
from echocal.watch.noise import growth, weights


@pytest.fixture(scope="module")
def bench() -> ModuleType:
    path = Path(__file__).parents[1] / "benches" / "watch_noises.py"
    spec = importlib.util.spec_from_file_location("bench_of_noises", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def sensors(
    bench: ModuleType, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator, name: str, tested: int
) -> list[tuple[int, int, str]]:
    """Rows, alarms, and why no rate is stated, of ten sensors."""
    monkeypatch.setattr(bench, "TESTED", tested)
    return [bench.quiet((name, int(seed))) for seed in random.integers(2**31, size=10)]


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("name", "stated"),
    [
        ("white", True),
        ("autocorrelation 0.6", True),
        ("autocorrelation 0.95", True),
        ("grows with the distance, 0.9 to 10.5 mm", True),
        ("whole centimeters, many distances", True),
        ("whole centimeters, three distances", False),
        ("whole centimeters, one distance", False),
        ("times four for some hours (wind)", False),
    ],
)
def test_the_rate_is_stated_for_steady_noise_only(
    name: str,
    stated: bool,
    bench: ModuleType,
    monkeypatch: pytest.MonkeyPatch,
    random: np.random.Generator,
) -> None:
    found = [why == "" for _, _, why in sensors(bench, monkeypatch, random, name, 0)]
    assert found.count(stated) >= 8


@pytest.mark.statistical
@pytest.mark.slow
def test_noise_that_doubles_keeps_the_stated_rate(
    bench: ModuleType, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator
) -> None:
    """At most 1.5 alarms are stated for ten sensors."""
    found = sensors(bench, monkeypatch, random, "doubles at some time", 1500)
    assert sum(alarms for _, alarms, _ in found) <= 5


@pytest.mark.statistical
def test_growth_is_learned_where_rows_show_it(random: np.random.Generator) -> None:
    distance, white = random.uniform(0.3, 3.5, 500), 1e-3 * random.standard_normal(500)
    assert growth(white, distance)[0] == 0.0
    slope, usual = growth(white * distance, distance)
    assert weights(3.5, (slope, usual)) < 0.7
    assert weights(usual, (slope, usual)) == 1.0


@pytest.mark.parametrize("step_us", [None, 58.0])
def test_an_event_says_why_no_rate_is_stated(step_us: float | None, random: np.random.Generator) -> None:
    """A target at one distance, with echo times as they are and in whole centimeters."""
    rows = log(random, 200)
    for row in rows:
        echo = float(row["echo_us"]) * 1.5 / float(row["distance_m"])
        row["echo_us"] = repr(echo if step_us is None else step_us * round(echo / step_us))
        row["distance_m"] = "1.5"
    watch = Fleet(lambda _: echocal.Model("linear"), None, Reference(), WatchSettings(learn=200), State(None))
    told = watch.take(rows)[1][0]
    assert told.kind == "learned"
    coarse = "readings are whole steps of " in told.sentence
    assert coarse == (step_us is not None)
    if coarse:
        assert told.details["false_alarms_per_year"] is None
        assert told.details["no_rate_because"] in told.sentence
