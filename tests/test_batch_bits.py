"""The same bits on every instruction set and any number of threads; the GIL; forks."""

import multiprocessing
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import echocal
from echocal import _core

ROWS = 300_007


@pytest.fixture
def levels() -> Iterator[list[str]]:
    yield _core.instruction_sets()
    _core.set_instruction_set(None)


def air(kind: type[np.floating], rows: int) -> list[np.ndarray]:
    random = np.random.default_rng(1)
    bounds = ((-20, 60), (0, 1), (6e4, 1.1e5), (3e-4, 2e-3))
    return [random.uniform(low, high, rows).astype(kind) for low, high in bounds]


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("law", [facts["id"] for facts in _core.laws()])
def test_every_instruction_set_gives_the_same_bits(
    levels: list[str], law: str, kind: type[np.floating]
) -> None:
    inputs = air(kind, 5003)
    bits = np.uint32 if kind is np.float32 else np.uint64
    results = []
    for level in levels:
        _core.set_instruction_set(level)
        results += [
            echocal.distance(kind(0.01), *inputs, law=law, frequency=frequency).view(bits)
            for frequency in (0.0, 40e3)
        ]
    for plain, dispersed in zip(results[::2], results[1::2], strict=True):
        np.testing.assert_array_equal(plain, results[0])
        np.testing.assert_array_equal(dispersed, results[1])
    assert (results[0] != results[1]).any()


def test_absorption_has_the_same_bits(levels: list[str]) -> None:
    results = []
    for level in levels:
        _core.set_instruction_set(level)
        results.append(echocal.absorption(*air(np.float64, 5003)[:3], 40e3).view(np.uint64))
    for result in results:
        np.testing.assert_array_equal(result, results[0])


def test_an_unavailable_instruction_set_is_refused() -> None:
    with pytest.raises(echocal.UsageError, match="available: baseline"):
        _core.set_instruction_set("mmx")


@pytest.mark.parametrize("n_threads", [2, 3, 16, None])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_threads_give_the_same_bits(kind: type[np.floating], n_threads: int | None) -> None:
    inputs = air(kind, ROWS)
    alone = echocal.distance(kind(0.01), *inputs, n_threads=1)
    np.testing.assert_array_equal(echocal.distance(kind(0.01), *inputs, n_threads=n_threads), alone)


def test_releases_the_gil() -> None:
    """While one thread computes, another one must get to run Python code."""
    inputs = air(np.float64, 4_000_000)
    started, stop = threading.Event(), threading.Event()
    turns: list[float] = []

    def count() -> None:
        started.set()
        while not stop.is_set():
            turns.append(time.perf_counter())

    counter = threading.Thread(target=count)
    counter.start()
    started.wait()
    begin = time.perf_counter()
    echocal.distance(0.01, *inputs, law="virial", frequency=40e3, n_threads=1)
    end = time.perf_counter()
    stop.set()
    counter.join()
    inside = [turn for turn in turns if begin + 0.2 * (end - begin) < turn < end - 0.2 * (end - begin)]
    assert len(inside) > 10


def forked(queue: "multiprocessing.Queue[float]") -> None:
    queue.put(float(echocal.distance(0.01, *air(np.float64, ROWS), n_threads=4).sum()))


def test_a_forked_child_computes_with_threads() -> None:
    expected = float(echocal.distance(0.01, *air(np.float64, ROWS), n_threads=4).sum())
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=forked, args=(queue,))
    child.start()
    assert queue.get(timeout=60) == expected
    child.join()
