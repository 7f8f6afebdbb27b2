"""Files of a task, wherever they lie: an object is copied to this machine for the time of the work."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from echocal.errors import DataError, writing
from echocal.outputs import WriteError, replacing
from echocal.places import Place

__all__ = ["fetched", "replaced"]


@contextmanager
def fetched(place: Place) -> Iterator[Path]:
    """Give a file of this machine with the content."""
    if isinstance(place, Path):
        yield place
        return
    with _scratch() as folder:
        place.fetch(folder / place.name)
        yield folder / place.name


@contextmanager
def replaced(place: Place, last: Callable[[], None] = lambda: None) -> Iterator[Path]:
    """Give a file of this machine to write to, and put it in place when it is complete.

    `last` is called right before; what it raises keeps what was there. What is written by
    `echocal.outputs.opened_output` tells errors of its own: any other is of what is read meanwhile.

    Raises
    ------
    OutputError
        If the output cannot be written.
    DataError
        If an input cannot be read.
    """
    if isinstance(place, Path):
        with writing(place.parent):
            place.parent.mkdir(parents=True, exist_ok=True)
        with replacing(place, last) as unfinished, _reading():
            yield unfinished
        return
    with _scratch() as folder:
        with writing(folder), _reading():
            yield folder / "unfinished"
        last()
        place.put(folder / "unfinished")


@contextmanager
def _reading() -> Iterator[None]:
    """Tell errors of inputs from those of the output, which pass."""
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        message = f"{error.filename or 'the file'} cannot be read: {error.strerror or error}"
        raise DataError(message) from None


@contextmanager
def _scratch() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="echocal-") as folder:
        yield Path(folder)
