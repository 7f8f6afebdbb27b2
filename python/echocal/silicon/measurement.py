"""Measure what a generated function costs: flash, memory, stack, and cycles or instructions."""

import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from echocal.errors import UsageError
from echocal.silicon.board import Board, Generated, called, function
from echocal.silicon.cores import CORES


@dataclass(frozen=True)
class Measurement:
    """What one call costs on one core; its return is counted.

    Attributes
    ----------
    core, compiler, options, simulator : str
        What it was measured with, versions included.
    flash_bytes : int
        Flash, with what the function takes from the compiler's library [byte].
    own_flash_bytes : int
        Flash of the function and its tables alone [byte].
    ram_bytes : int
        Variables of static storage duration [byte].
    stack_bytes : int
        Stack, with the return address where it is kept there [byte].
    cycles, fewest_cycles : int or None
        Most and fewest cycles of the calls sampled, where the simulator counts them.
    instructions, fewest_instructions : int or None
        Most and fewest instructions, where it counts those.
    """

    core: str
    compiler: str
    options: str
    simulator: str
    flash_bytes: int
    own_flash_bytes: int
    ram_bytes: int
    stack_bytes: int
    cycles: int | None = None
    fewest_cycles: int | None = None
    instructions: int | None = None
    fewest_instructions: int | None = None

    @property
    def steps(self) -> int:
        """Most cycles, or instructions where cycles are not counted."""
        return self.cycles if self.cycles is not None else self.instructions or 0

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def board_of(core: str) -> Board:
    """Return the board of a core."""
    if core not in CORES:
        raise UsageError(f"unknown core '{core}'; this version has {', '.join(CORES)}")
    return CORES[core]


def missing(core: str) -> list[str]:
    """Return what is not installed of what measuring on a core needs.

    Commands and packages. Raises `UsageError` if there is no such core.
    """
    return board_of(core).missing()


def measure(
    made: Generated,
    core: str,
    options: str = "-Os",
    *,
    library: tuple[str, ...] = (),
    strict: bool = True,
) -> Measurement | None:
    """Compile a generated function for a core, call it in a simulator, and count.

    Parameters
    ----------
    made : Firmware
        What was generated, of a packaging that holds C.
    core : str
        Name in `CORES`.
    options : str
        Options of the compiler.
    library : tuple of str
        Libraries that the function takes from, such as ``-lm``; generated ones take from none.
    strict : bool
        Whether a warning of the compiler is an error.

    Returns
    -------
    Measurement or None
        What was counted; None if a tool is missing, for nothing is ever estimated.

    Raises
    ------
    UsageError
        If there is no such core.
    EchocalError
        If a tool fails.
    """
    board = board_of(core)
    if board.missing():
        return None
    with tempfile.TemporaryDirectory(prefix="echocal-") as name:
        thing = board.compile(made, Path(name), options, strict=strict)
        linked = board.link(thing, function(made), *library)
        whole, own, ram = board.sizes(linked), board.own(linked, called(made)), board.variables(linked)
        calls = board.calls(thing, made, *library)
    counted = "cycles" if board.counts_cycles else "instructions"
    steps: Mapping[str, int] = {counted: calls.most, f"fewest_{counted}": calls.fewest}
    return Measurement(
        core,
        f"{board.compiler} {board.version}",
        options,
        board.simulator,
        flash_bytes=whole["text"] + whole["data"],
        own_flash_bytes=own,
        ram_bytes=ram,
        stack_bytes=calls.stack,
        **steps,
    )


def output_hash(made: Generated, core: str, options: str = "-Os") -> str | None:
    """Hash over the outputs for every accepted input, computed on a simulated core.

    Parameters
    ----------
    made : Firmware
        What was generated, of a packaging that holds C.
    core : str
        Name in `CORES`.
    options : str
        Options of the compiler.

    Returns
    -------
    str or None
        The hash, ``report["output_hash"]`` if every bit is as proven; None if a tool is missing.

    Raises
    ------
    UsageError
        If there is no such core.
    EchocalError
        If a tool fails, or calls of constant time are none.
    """
    board = board_of(core)
    if board.missing():
        return None
    with tempfile.TemporaryDirectory(prefix="echocal-") as name:
        return board.output_hash(board.compile(made, Path(name), options), made)
