"""A diagnosis leaves the garbage collector of its process as it was."""

import gc
from collections.abc import Iterator

import pytest

from echocal.diagnose.garbage import no_cycle_search


@pytest.fixture(autouse=True)
def enabled() -> Iterator[None]:
    """Enable the collector before and after each test."""
    gc.enable()
    yield
    gc.enable()


def test_it_is_off_until_the_last_of_several_ends() -> None:
    first, second = no_cycle_search(), no_cycle_search()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert not gc.isenabled()
    second.__exit__(None, None, None)
    assert gc.isenabled()


def test_it_is_on_again_after_an_error() -> None:
    with pytest.raises(ValueError, match="of the table"), no_cycle_search():
        raise ValueError("of the table")
    assert gc.isenabled()


def test_what_the_caller_switched_off_stays_off() -> None:
    gc.disable()
    with no_cycle_search():
        pass
    assert not gc.isenabled()
