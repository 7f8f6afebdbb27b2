"""An emulated Arduino UNO with a virtual HC-SR04: echo times and voltages in, serial lines out."""

import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.arrays import Column
from echocal.errors import DataError, EchocalError, UsageError
from echocal.silicon.arduino import SIMULATOR_WAY_OUT, Sketch, simulated_uno
from echocal.silicon.events import CLOCK, Habit, Log, codes_of, habit_of, rows_of, told_late

SILENCE = 450e-6
"""From the end of the trigger to ECHO's rise [s]: eight periods of 40 kHz and what the module does before."""

Progress = Callable[[int, int], object]

_PINS, _ANALOG = 20, 2
_SHORTEST, _LONGEST = 1e-6, 10.0  # s, of one echo
_TYPICAL = 10e-3  # s
_MOST_PATIENCE = 3600.0  # s
_LEAST_REFERENCE = 1.8  # V, the lowest supply of the chip by its data sheet
_REHEARSED = 3  # rows
_SHORTER = 0.7  # the last echo of a second rehearsal, over the others
_NOT_LOADED = 127  # exit code of the loader where a library is missing


@dataclass(frozen=True)
class Played:
    """What a sketch sent, row by row.

    Attributes
    ----------
    before : tuple of str
        Lines before the first row, such as a header.
    rows : list of tuple of str
        Lines of each row.
    codes : ndarray of int, shape (n, 2)
        What the converter gave in each row for A0 and A1; -1 where the sketch did not read it.
    seconds : float
        Time that passed on the board [s].
    """

    before: tuple[str, ...]
    rows: list[tuple[str, ...]]
    codes: NDArray[np.int64]
    seconds: float

    @property
    def lines(self) -> list[str]:
        """All lines in the order in which they were sent."""
        return [*self.before, *(line for row in self.rows for line in row)]


def play(
    sketch: Sketch,
    echo: ArrayLike,
    *,
    silence: ArrayLike = SILENCE,
    voltages: ArrayLike = 0.0,
    reference_voltage: float = 5.0,
    time_out: float | None = None,
    trigger_pin: int = 7,
    echo_pin: int = 8,
    patience: float = 5.0,
    progress: Progress | None = None,
) -> Played:
    """Run a sketch on an emulated UNO, one echo after each of its trigger pulses.

    A sketch is first run for three rows, to see in what order it reads the thermometer, triggers and prints.

    Parameters
    ----------
    sketch : Sketch
        From `compile_sketch`.
    echo : array_like of float, shape (n,)
        Length of each pulse of ECHO [s], to a cycle of 1/16 us; NaN for a missed echo.
    silence : array_like of float, shape () or (n,)
        From the end of the trigger pulse until ECHO rises [s].
    voltages : array_like of float, shape (), (n,) or (n, 2)
        Voltage at A0, or at A0 and A1 [V]. Other analog pins have 0 V.
    reference_voltage : float
        Supply of the converter, AVCC, and voltage at AREF [V]. The internal reference has 1.1 V.
    time_out : float, optional
        Length of the pulse for a missed echo [s], such as `TIME_OUT`; default: no pulse.
    trigger_pin, echo_pin : int
        Pins of the board; 14 is A0.
    patience : float
        Time on the board without a trigger after which the run ends [s].
    progress : callable, optional
        Called with the number of rows begun, and that of all.

    Returns
    -------
    Played

    Raises
    ------
    UsageError
        If a tool is not installed, or an argument is impossible.
    DataError
        If the sketch never triggers, stops before the last row, or sends nothing.

    Examples
    --------
    >>> from echocal import silicon
    >>> sketch = silicon.compile_sketch("timer_capture")
    >>> played = silicon.play(sketch, [5_800e-6, 11_661.8e-6], voltages=0.7)
    >>> [line.split(",")[1] for line, in played.rows], played.codes[:, 0].tolist()
    (['0.995', '2.000'], [143, 143])
    """
    refuse_impossible(reference_voltage, trigger_pin, echo_pin, time_out, patience)
    rows = _rows(echo, silence, voltages, time_out)
    board = _Board(sketch, trigger_pin, echo_pin, reference_voltage * 1e3, patience)
    if not len(rows):
        log = board.run(rows, Habit(), None)
        return Played(tuple(line.text for line in log.lines), [], np.empty((0, 2), np.int64), log.end / CLOCK)
    heard = rows[rows[:, 1] > 0.0]
    if len(heard):  # a sketch may not see an echo that is very short or very long
        typical = heard[[np.abs(np.log(heard[:, 1] * 1e-6 / _TYPICAL)).argmin()]]
    else:
        typical = np.array([[SILENCE * 1e6, _TYPICAL * 1e6, 0.0, 0.0]])
    rehearsed = board.run(np.repeat(typical, _REHEARSED, axis=0), Habit(), None)
    _refuse_silent(rehearsed, board, min(_REHEARSED, len(rows)))
    habit = habit_of(rehearsed)
    if habit.lines_before:
        shorter = np.repeat(typical, _REHEARSED, axis=0)
        shorter[-1, 1] *= _SHORTER
        habit = told_late(habit, rehearsed, board.run(shorter, Habit(), None))
    log = board.run(rows, habit, progress)
    _refuse_silent(log, board, len(rows))
    before, lines = rows_of(log, habit, len(rows))
    return Played(before, lines, codes_of(log, len(rows), _ANALOG), log.end / CLOCK)


@dataclass(frozen=True)
class _Board:
    sketch: Sketch
    trigger: int
    echo: int
    reference: float  # mV
    patience: float

    def run(self, rows: Column, habit: Habit, progress: Progress | None) -> Log:
        with tempfile.TemporaryDirectory(prefix="echocal-") as name:
            program, table = Path(name) / "sketch.elf", Path(name) / "rows"
            program.write_bytes(self.sketch.elf)
            table.write_text(
                "".join(f"{' '.join(map(repr, row))}\n" for row in rows.tolist()), encoding="ascii"
            )
            words = [simulated_uno(), program, self.trigger, self.echo, self.reference, int(habit.early)]
            words += [self.patience, self.sketch.serial]
            with table.open("rb") as given:
                return _listened([str(word) for word in words], given.fileno(), len(rows), progress)


def _listened(words: Sequence[str], given: int, count: int, progress: Progress | None) -> Log:
    log, begun = Log(), 0
    with tempfile.TemporaryFile("w+", errors="replace") as said, _started(words, given, said) as board:
        try:
            for line in board.stdout or ():
                begun += log.add(line)
                if progress is not None:
                    progress(begun, count)
        except BaseException:
            board.kill()
            raise
        said.seek(0)
        reason = said.read().strip().partition("\n")[0]
    if board.returncode == _NOT_LOADED:
        raise UsageError(f"the simulated UNO does not start: {reason}; {SIMULATOR_WAY_OUT}")
    if board.returncode != 0:
        told = f": {reason}" if reason else ""
        raise EchocalError(f"the simulated UNO ended with exit code {board.returncode}{told}")
    return log


def _started(words: Sequence[str], given: int, said: IO[str]) -> "subprocess.Popen[str]":
    try:
        return subprocess.Popen(
            words, stdin=given, stdout=subprocess.PIPE, stderr=said, text=True, errors="replace"
        )
    except OSError as error:
        raise UsageError(
            f"the simulated UNO cannot be started: {words[0]}: {error.strerror}; remove this folder and run "
            "again, or set ECHOCAL_CACHE to a folder in which programs may run"
        ) from None


def _rows(echo: ArrayLike, silence: ArrayLike, voltages: ArrayLike, time_out: float | None) -> Column:
    """Return silence [us], length of ECHO [us] and two voltages [mV] for each row."""
    lengths = np.asarray(echo, dtype=np.float64)
    if lengths.ndim != 1:
        raise UsageError(f"echo has shape {lengths.shape}; one echo time for each trigger is expected")
    impossible = np.flatnonzero((lengths < _SHORTEST) | (lengths > _LONGEST))
    if len(impossible):
        raise UsageError(
            f"echo {impossible[0] + 1} is {lengths[impossible[0]]:g} s; expected is {_SHORTEST:g} to "
            f"{_LONGEST:g} s, or NaN for a missed echo"
        )
    lengths = np.where(np.isnan(lengths), 0.0 if time_out is None else time_out, lengths)
    volts = np.asarray(voltages, dtype=np.float64)
    volts = volts[:, np.newaxis] if volts.ndim == 1 else volts
    try:
        first = np.broadcast_to(np.asarray(silence, dtype=np.float64), lengths.shape)
        both = np.zeros((len(lengths), _ANALOG))
        width = volts.shape[1] if volts.ndim == 2 else 1
        both[:, :width] = np.broadcast_to(volts, (len(lengths), width))
    except ValueError:
        raise UsageError(
            f"echo has shape {lengths.shape}, silence {np.shape(silence)} and voltages {np.shape(voltages)}: "
            "they must agree in the number of rows, and there are two analog pins"
        ) from None
    if not (np.isfinite(both).all() and np.isfinite(first).all() and (first >= 0.0).all()):
        raise UsageError("voltages and silence must be finite numbers, and silence must not be negative")
    return np.column_stack([first * 1e6, lengths * 1e6, both * 1e3])


def refuse_impossible(
    reference_voltage: float,
    trigger_pin: int,
    echo_pin: int,
    time_out: float | None = None,
    patience: float = 1.0,
) -> None:
    """Refuse what no board, module or run can have.

    Raises `UsageError` if a value is not a number or out of its range.
    """
    for name, value, most in (("time_out", time_out, _LONGEST), ("patience", patience, _MOST_PATIENCE)):
        if value is not None and not (isinstance(value, Real) and _SHORTEST <= value <= most):
            raise UsageError(f"{name} is {value!r} s; expected is {_SHORTEST:g} to {most:g} s")
    if not (isinstance(reference_voltage, Real) and _LEAST_REFERENCE <= reference_voltage <= 5.5):
        told = f"{reference_voltage:g} V" if isinstance(reference_voltage, Real) else repr(reference_voltage)
        raise UsageError(f"reference_voltage is {told}; an ATmega328P takes {_LEAST_REFERENCE} to 5.5 V")
    for name, pin in (("trigger_pin", trigger_pin), ("echo_pin", echo_pin)):
        if pin not in range(2, _PINS):
            message = f"{name} is {pin}; an UNO has 2 to 13, and 14 to 19 for A0 to A5 (0 and 1 are Serial)"
            raise UsageError(message)
    if trigger_pin == echo_pin:
        message = f"trigger_pin and echo_pin are both {trigger_pin}; a module with one pin is not emulated"
        raise UsageError(message)


def _refuse_silent(log: Log, board: _Board, count: int) -> None:
    if len(log.triggers) < count:
        raise DataError(_why_no_trigger(log, board, count))
    if not log.lines:
        raise DataError(
            f"the sketch prints nothing in {log.end / CLOCK:.1f} s on the board: it must use Serial.println"
        )


def _why_no_trigger(log: Log, board: _Board, count: int) -> str:
    begun = len(log.triggers)
    if log.reason in ("stopped", "crashed"):
        return f"the chip stopped after {log.end / CLOCK:.2f} s: it sleeps without interrupts, or has crashed"
    if begun:
        then = f"and then not for {board.patience:g} s on the board"
        return f"the sketch triggered {begun} of {count} times, {then}"
    told = f"the sketch does not trigger pin {board.trigger} within {board.patience:g} s on the board"
    number, longest = log.short_pulses
    if number:
        return (
            f"{told}: its {number} pulses there last {longest * 1e6 / CLOCK:.1f} us at most, and an HC-SR04 "
            "needs 10 us"
        )
    if log.other_pins:
        pin, number, longest = max(log.other_pins, key=lambda one: one[1])
        length = longest * 1e6 / CLOCK
        return f"{told}; pin {pin} has {number} pulses of up to {length:.1f} us: is it the trigger pin?"
    return told
