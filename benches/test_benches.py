"""The same cases under pytest-benchmark: `pytest benches --benchmark-only`."""

import numpy as np
import pytest
from cases import calls, columns
from pytest_benchmark.fixture import BenchmarkFixture

ROWS = 1_000_000
DOUBLE, SINGLE = columns(ROWS, np.float64), columns(ROWS, np.float32)
CALLS, NAMES = calls()


@pytest.mark.parametrize("name", DOUBLE)
@pytest.mark.parametrize("cases", [DOUBLE, SINGLE], ids=["float64", "float32"])
def test_columns(benchmark: BenchmarkFixture, cases: dict, name: str) -> None:
    benchmark.group = "columns"
    benchmark(cases[name])


@pytest.mark.parametrize("name", CALLS)
def test_calls(benchmark: BenchmarkFixture, name: str) -> None:
    benchmark.group = "calls"
    code = compile(CALLS[name], name, "eval")
    benchmark(eval, code, NAMES)
