"""Every core that can be played, and which stand for a target."""

from echocal.silicon.avr import Avr
from echocal.silicon.board import Board
from echocal.silicon.qemu import Qemu

__all__ = ["CORES", "cores_of"]


def cortex(name: str, machine: str, tick: float, *flags: str) -> Board:
    """Return a Cortex-M; `tick` is the instructions between two ticks of its clock."""
    core = name.rstrip("f") if flags else name
    return Qemu(
        name,
        "arm-none-eabi-gcc",
        (f"-mcpu={core}", "-mthumb", *flags),
        ("qemu-system-arm", "-M", machine),
        tick=tick,
    )


def riscv(name: str, architecture: str, binary_interface: str) -> Board:
    """Return a RISC-V core of 32 bits."""
    return Qemu(
        name,
        "riscv64-unknown-elf-gcc",
        (f"-march={architecture}", f"-mabi={binary_interface}"),
        ("qemu-system-riscv32", "-M", "virt", "-bios", "none"),
        flash="0x80000000",
        ram="0x80100000",
        start="start_riscv.S",
    )


_STANDARD = "c99"
CORES = {
    board.name: board
    for board in (
        Avr("avr", "avr-gcc", ("-mmcu=atmega328p",)),
        cortex("cortex-m0", "microbit", 62.5),  # 16 MHz
        cortex("cortex-m3", "mps2-an385", 40.0),  # 25 MHz
        cortex("cortex-m4f", "mps2-an386", 40.0, "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
        riscv("rv32", "rv32imac", "ilp32"),
        riscv("rv32e", "rv32ec", "ilp32e"),  # no multiplier
    )
}
"""Cores by name."""


def cores_of(target: str) -> list[str]:
    """Return the cores that a target is for: its own, all where the target is only a standard, or none.

    Parameters
    ----------
    target : str
        Name of a target.

    Returns
    -------
    list of str
        Names in `CORES`.

    Examples
    --------
    >>> cores_of("avr")
    ['avr']
    """
    return list(CORES) if target == _STANDARD else [target] if target in CORES else []
