"""Errors and warnings; each error has its exit code of the command line."""

import traceback
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import Any

__all__ = [
    "AbsentError",
    "BoundError",
    "DataError",
    "DataWarning",
    "DisagreementWarning",
    "DomainWarning",
    "EchocalError",
    "ModelError",
    "OutputError",
    "UsageError",
    "among",
    "unexpected",
    "writing",
]

_LONGEST = 80  # letters of a name that is compared with others: the time goes with their square


class EchocalError(Exception):
    """Any error that a user can correct; its text says how."""

    exit_code = 1


class UsageError(EchocalError, ValueError):
    """A request that cannot be understood: an unknown name, an impossible combination."""

    exit_code = 2


class OutputError(UsageError):
    """A file that cannot be written: a full disk, a missing permission."""

    number: int | None = None
    """The operating system's number of the reason, where it has one."""


class ModelError(UsageError):
    """A model that cannot be built or read."""


class DataError(EchocalError, ValueError):
    """Data that cannot be used; the text names the column and the row."""

    exit_code = 3


class AbsentError(DataError):
    """A model needs a quantity that the data does not have.

    Parameters
    ----------
    quantity : str
        Its name: ``"temperature"``.
    """

    def __init__(self, message: str, quantity: str = "") -> None:
        super().__init__(message)
        self.quantity = quantity


class BoundError(EchocalError, ValueError):
    """A bound that cannot be met; the text gives the best that can be reached."""

    exit_code = 4
    best: Any = None  # what reaches it, where there is such a thing


def among(name: str, known: Collection[str], have: str = "it has") -> str:
    """What to say behind a name that is not known: the nearest one that is, and all of them.

    Examples
    --------
    >>> among("sensorid", ["time", "sensor_id"]), among("b", ["time"])
    ("; did you mean 'sensor_id'? It has time, sensor_id", '; it has time')
    """
    listed = f"{have} {', '.join(known)}"
    names = {own.lower(): own for own in known if max(len(own), len(name)) <= _LONGEST}
    near = get_close_matches(name.lower(), names, n=1, cutoff=0.5)
    return f"; did you mean '{names[near[0]]}'? {listed[0].upper()}{listed[1:]}" if near else f"; {listed}"


class DataWarning(UserWarning):
    """Rows of a table cannot be used; the text gives counts, reasons and first rows."""


class DisagreementWarning(UserWarning):
    """The possible hypotheses predict different values for the requested conditions."""


class DomainWarning(UserWarning):
    """A law or effect is used outside the domain that its source states."""


@contextmanager
def writing(path: str | Path) -> Iterator[None]:
    """Raise an operating system's refusal to write as `UsageError`, because the data are not wrong.

    Examples
    --------
    >>> from echocal.errors import writing
    >>> with writing("absent/a.txt"), open("absent/a.txt", "w") as file:
    ...     file.write("never")
    Traceback (most recent call last):
    ...
    echocal.errors.OutputError: absent/a.txt cannot be written: No such file or directory
    """
    try:
        yield
    except OSError as error:
        message = f"{path} cannot be written: {error.strerror or error}"
        refused = OutputError(message)
        refused.number = error.errno
        raise refused from None


@contextmanager
def reading(path: str | Path) -> Iterator[None]:
    """Raise an operating system's refusal to read as `DataError`."""
    try:
        yield
    except FileNotFoundError:
        raise DataError(f"no file {path}") from None
    except IsADirectoryError:
        raise DataError(f"{path} is a folder; name one file of it") from None
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a NUL byte, a lone surrogate
        raise DataError(f"{str(path)!r} cannot be the name of a file: {error}") from None


def unexpected(error: BaseException) -> str:
    """Say what nobody foresaw, for the file or the sensor that it concerns; the others go on.

    A panic of a library in Rust is no `Exception`, so whoever calls this catches `BaseException`.

    Raises
    ------
    BaseException
        The error itself, if it is a request to stop.
    """
    if isinstance(error, KeyboardInterrupt | SystemExit | GeneratorExit):
        raise error
    place = traceback.extract_tb(error.__traceback__)[-1:]
    where = "".join(f" ({Path(step.filename).name}, line {step.lineno})" for step in place)
    reason = next(iter(str(error).split("\n")), "")
    return f"unexpected {type(error).__name__}: {reason}{where}; please report it with the file"
