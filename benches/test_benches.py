"""The same cases under pytest-benchmark: `pytest benches --benchmark-only`."""

from collections.abc import Iterator

import numpy as np
import pytest
from cases import Cases, calls, models, ours, rivals
from pytest_benchmark.fixture import BenchmarkFixture

from echocal import _core

ROWS = 1_000_000
ALL: dict[str, Cases] = {
    "float64": ours(ROWS, np.float64, (1, 2)) | rivals(ROWS, np.float64),
    "float32": ours(ROWS, np.float32, (1, 2)) | rivals(ROWS, np.float32),
    "in cache": ours(10_000, np.float64, (1,)),
    "models": models(100_000),
}
CALLS, NAMES = calls()


@pytest.fixture(autouse=True)
def widest() -> Iterator[None]:
    yield
    _core.set_instruction_set(None)


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, cases in ALL.items() for name in cases])
def test_columns(benchmark: BenchmarkFixture, group: str, name: str) -> None:
    benchmark.group = group
    case = ALL[group][name]
    _core.set_instruction_set(case.instruction_set)
    benchmark(case.run)


@pytest.mark.parametrize("name", CALLS)
def test_calls(benchmark: BenchmarkFixture, name: str) -> None:
    benchmark.group = "calls"
    code = compile(CALLS[name], name, "eval")
    benchmark(eval, code, NAMES)
