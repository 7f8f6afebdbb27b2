"""Everything that the emulated board measured for the question, as a file."""

import json
import re
import zlib
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from echocal import silicon
from echocal.arrays import Column
from echocal.errors import DataError
from echocal.keywords import command_line
from echocal.study.question import scenes
from echocal.study.question.laws import ALL, suspect
from echocal.study.question.suspects import Suspect
from echocal.study.tables import DISTANCE, Tables

Progress = Callable[[int, int], object]

SCHEMA = "echocal.study_question/1"
MADE_BY = command_line("study", emulate=True)
NEAR = 0.5
"""Second distance [m]."""

TOLD = ("pulse_in", "target", "module_factor", "law_332", "latency")
"""Suspects whose tables at both distances, with a potentiometer set by hand, are given to the diagnosis."""
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

    Raises `UsageError` if a tool is not installed, and `DataError` if a line is not as the program prints
    it. Temperatures are in degC, the distance in m; `tables` is how often all rows are measured.
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

    Raises `UsageError` if a tool is not installed. A job is a suspect, its distance [m] and its number of
    tables; `progress` is called with the number of runs done, and that of all.
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
        raise DataError(
            f"the board printed {lines} for a row of suspect '{suspect.id}', not echo, reading, temperature"
        )
    return [float(text) for text in match.groups()]


@dataclass(frozen=True)
class Investigation:
    """Readings of the emulated board."""

    temperature: Column
    """Temperatures of Table 2 [degC]; shape (n,)."""
    far: dict[str, Readings]
    """Of each suspect at 2 m."""
    near: dict[str, Readings]
    """Of each suspect that moves all rows, at `NEAR`."""
    told: dict[str, tuple[Readings, Readings]]
    """Of the suspects `TOLD` at 2 m and at `NEAR`, with a potentiometer that is set by hand."""

    def text(self) -> str:
        """Return the content of the file, a table in a line."""
        parts = {
            "far": {name: _lines(one) for name, one in self.far.items()},
            "near": {name: _lines(one) for name, one in self.near.items()},
            "told_far": {name: _lines(one) for name, (one, _) in self.told.items()},
            "told_near": {name: _lines(one) for name, (_, one) in self.told.items()},
        }
        head = {
            "schema": SCHEMA,
            "made_by": MADE_BY,
            "temperature_C": self.temperature.tolist(),
            "distance_m": {"far": DISTANCE, "near": NEAR},
        }
        tables = ",\n".join(f'"{part}": {{\n{_joined(lines)}\n}}' for part, lines in parts.items())
        return f"{json.dumps(head)[:-1]},\n{tables}\n}}\n"

    @classmethod
    def load(cls, path: Path) -> "Investigation":
        """Read a file that `text` made. Raises `DataError` if it is none."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if content["schema"] != SCHEMA:
                raise KeyError(SCHEMA)
            parts = {
                part: {name: _readings(name, lines) for name, lines in content[part].items()}
                for part in ("far", "near", "told_far", "told_near")
            }
            temperature = np.array(content["temperature_C"], dtype=np.float64)
        except (OSError, ValueError, KeyError, TypeError) as error:
            message = f"{path} holds no readings of the study's question: {error}; make them: {MADE_BY}"
            raise DataError(message) from None
        told = {name: (parts["told_far"][name], parts["told_near"][name]) for name in parts["told_far"]}
        return cls(temperature, parts["far"], parts["near"], told)


def investigate(tables: Tables | None = None, *, progress: Progress | None = None) -> Investigation:
    """Run the study's experiment on the emulated board, once for each suspect.

    Raises `UsageError` if a tool is not installed.
    """
    temperature = (tables or Tables.load()).table2.temperature
    moving = [one for one in ALL if one.place not in ("setting", "none") and not one.absent]
    told = [_by_hand(suspect(name)) for name in TOLD]
    jobs: list[tuple[Suspect, float, int | None]] = [(one, DISTANCE, None) for one in ALL]
    jobs += [(one, NEAR, 1) for one in moving]
    jobs += [(one, distance, 1) for distance in (DISTANCE, NEAR) for one in told]
    made = run_all(jobs, temperature, progress=progress)
    far, made = made[: len(ALL)], made[len(ALL) :]
    near, made = made[: len(moving)], made[len(moving) :]
    pairs = zip(made[: len(told)], made[len(told) :], strict=True)
    return Investigation(
        temperature,
        {one.suspect: one for one in far},
        {one.suspect: one for one in near},
        dict(zip(TOLD, pairs, strict=True)),
    )


def _by_hand(one: Suspect) -> Suspect:
    """Return the suspect with a potentiometer that is set by hand, as the scatter of Table 2 wants it."""
    return replace(one, id=f"{one.id} by hand", scene=scenes.echo_and_voltage(one.scene, scenes.hand(1.0)))


def _lines(readings: Readings) -> dict[str, list[list[int]]]:
    return {
        "reading_mm": np.round(readings.reading * 1e3).astype(int).tolist(),
        "duration_us": np.round(readings.duration).astype(int).tolist(),
    }


def _joined(tables: dict[str, Any]) -> str:
    return ",\n".join(
        f"{json.dumps(name)}: {json.dumps(one, separators=(',', ':'))}" for name, one in tables.items()
    )


def _readings(name: str, lines: dict[str, Sequence[Sequence[int]]]) -> Readings:
    # as the board prints it, in meters with three decimals
    reading = np.round(np.array(lines["reading_mm"], dtype=np.float64) / 1e3, 3)
    return Readings(name, reading, np.array(lines["duration_us"], dtype=np.float64))
