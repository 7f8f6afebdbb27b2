"""A diagnosis leaves the threads of the BLAS as it finds them."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest
import scipy.linalg  # noqa: F401  # loads a BLAS
from threadpoolctl import threadpool_info, threadpool_limits

from echocal.diagnose.blas import one_thread


def threads() -> set[int]:
    return {own["num_threads"] for own in threadpool_info() if own["user_api"] == "blas"}


def test_it_is_one_inside_and_as_before_outside() -> None:
    with threadpool_limits(2, user_api="blas"):
        before = threads()
        with one_thread():
            assert threads() == {1}
        assert threads() == before
        with pytest.raises(ValueError, match="anything"), one_thread():
            raise ValueError("anything")
        assert threads() == before


def test_diagnoses_side_by_side_end_with_the_threads_of_the_beginning() -> None:
    """Each begins before another ends; the first ends before the second."""
    both, first_ended = Barrier(2), Barrier(2)

    def work(place: int) -> None:
        with one_thread():
            both.wait()
            if place:
                first_ended.wait()
        if not place:
            first_ended.wait()

    with threadpool_limits(2, user_api="blas"):
        before = threads()
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(work, (0, 1)))
        assert threads() == before
