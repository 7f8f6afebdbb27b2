"""The study's experiment on an emulated Arduino UNO, once for each suspect."""

import re
import zlib
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from echocal import silicon
from echocal.errors import DataError
from echocal.study.question.suspects import Suspect
from echocal.study.tables import DISTANCE

__all__ = ["Readings", "run", "run_all"]

Column = NDArray[np.float64]
Progress = Callable[[int, int], object]

_SILENCE = (450e-6, 450e-6 + 1024e-6)  # s: over a period of the interrupt of millis()
_ROW = re.compile(r"(-?\d+),(-?\d+\.\d+|inf|nan|ovf),(-?\d+\.\d+)$")
_BOARDS = 2  # at a time


@dataclass(frozen=True)
class Readings:
    """What the board printed."""

    suspect: str  # name of the suspect
    reading: Column  # readings [m]; shape (tables, n)
    duration: Column  # echo times as the program counted them [us]; shape (tables, n)


def run(
    suspect: Suspect, temperature: Column, distance: float = DISTANCE, tables: int | None = None
) -> Readings:
    """Run the experiment with one suspect.

    Raises `UsageError` if a tool is not installed, and `DataError` if a line is not as the program prints it.

    Parameters
    ----------
    temperature : ndarray, shape (n,)
        Temperatures of the rows [degC].
    distance : float
        Distance of the target [m].
    tables : int, optional
        How often all rows are measured.
    """
    # one generator for a suspect, whatever else runs
    random = np.random.default_rng([zlib.crc32(suspect.id.encode()), round(distance * 1e3)])
    count = tables or suspect.tables
    rows = [suspect.scene(temperature, distance, random) for _ in range(count)]
    echo = np.concatenate([one.echo for one in rows])
    drawn = random.uniform(*_SILENCE, echo.shape)
    options = [f"-D{name}={text}" for name, text in suspect.macros.items()]
    with resources.as_file(resources.files("echocal.study") / "data" / "tinkercad.ino") as path:
        sketch = silicon.compile_sketch(Path(path), options=options)
    played = silicon.play(
        sketch,
        echo,
        silence=drawn if suspect.silence is None else suspect.silence,
        voltages=np.concatenate([one.voltage for one in rows]),
    )
    numbers = np.array([_numbers(lines, suspect) for lines in played.rows])
    shape = (count, len(temperature))
    return Readings(suspect.id, numbers[:, 1].reshape(shape), numbers[:, 0].reshape(shape))


def run_all(
    jobs: Sequence[tuple[Suspect, float, int | None]],
    temperature: Column,
    *,
    progress: Progress | None = None,
) -> list[Readings]:
    """Run the experiment several times.

    Raises `UsageError` if a tool is not installed.

    Parameters
    ----------
    jobs : sequence of (Suspect, float, int or None)
        Suspect, distance [m] and number of tables, as of `run`.
    temperature : ndarray, shape (n,)
        Temperatures of the rows [degC].
    progress : callable, optional
        Called with the number of runs done, and that of all.
    """
    silicon.refuse_missing()
    with ThreadPoolExecutor(_BOARDS) as pool:
        found = pool.map(lambda job: run(job[0], temperature, *job[1:]), jobs)
        return list(_counted(found, len(jobs), progress))


def _counted(found: Iterable[Readings], count: int, progress: Progress | None) -> Iterable[Readings]:
    for done, one in enumerate(found, 1):
        if progress is not None:
            progress(done, count)
        yield one


def _numbers(lines: Sequence[str], suspect: Suspect) -> list[float]:
    """Return duration, reading and temperature of a row."""
    match = _ROW.search(lines[0]) if lines else None
    if match is None:
        message = (
            f"the board printed {lines} for a row of suspect '{suspect.id}', not echo, reading, temperature"
        )
        raise DataError(message)
    return [float(text) for text in match.groups()]
