"""MicroPython for the BBC micro:bit on a Cortex-M0 that QEMU plays, spoken to over its serial port."""

import subprocess
from pathlib import Path
from typing import IO

HEX = Path("/usr/share/firmware-microbit-micropython/firmware.hex")
QUIET = ("-display", "none", "-monitor", "none", "-serial", "stdio")
BUFFER = 16  # bytes; the board loses what comes while its 64 are full
PASTE, RUN, PROMPT, NEXT = b"\x05", b"\x04", b">>> ", b"=== "


def until(port: IO[bytes], mark: bytes) -> str:
    """What the board says up to a mark."""
    said = b""
    while not said.endswith(mark):
        letter = port.read(1)
        assert letter, f"the board fell silent after {said[-200:]!r}"
        said += letter
    return said.removesuffix(mark).decode().replace("\r", "")


def execute(*programs: str) -> list[str]:
    """What each program prints, run one after the other in one session."""
    machine = ("qemu-system-arm", "-M", "microbit", "-device", f"loader,file={HEX}", *QUIET)
    with subprocess.Popen(machine, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as board:
        assert board.stdin is not None
        assert board.stdout is not None
        try:
            until(board.stdout, PROMPT)
            return [answer(board.stdin, board.stdout, program) for program in programs]
        finally:
            board.kill()


def answer(to: IO[bytes], back: IO[bytes], program: str) -> str:
    """What one program prints; each piece of it waits for its echo, so that none is lost."""
    to.write(PASTE)
    until(back, NEXT)
    for line in program.encode().split(b"\n"):
        for start in range(0, len(line), BUFFER):
            piece = line[start : start + BUFFER]
            to.write(piece)
            until(back, piece)
        to.write(b"\r")
        until(back, NEXT)
    to.write(RUN)
    said = until(back, PROMPT)
    assert "Traceback" not in said, said
    return said.strip()
