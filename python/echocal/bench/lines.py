"""Lines of a ranger: from a serial port, or typed, pasted and piped by a person."""

from collections.abc import Callable, Iterator
from typing import Any

from echocal.errors import DataError, UsageError

_SILENCE = 10.0  # s without a line, after which a port is told silent
_FIRST = 5  # lines in which a program tells the names of its columns


def block(line: Callable[[], str], cut: Callable[[str], None]) -> list[str]:
    """Lines up to an empty one, or the end; a last line without its end may be cut, and is left out.

    `line` gives the next line with its end, an empty text where there is none; `cut` is told the line that
    is left out.
    """
    lines = []
    while (text := line()).strip():
        if not text.endswith("\n"):
            cut(text)
            break
        lines.append(text.rstrip("\r\n"))
    return lines


class Port:
    """A serial port, by the library pyserial.

    Its `name` is ``/dev/ttyUSB0``, ``COM3``, or an address as pyserial has them; `rate` is in bits per
    second, and `wait` is the longest wait for a line [s]. `first` has the lines that came first, in which a
    program tells the names of its columns. They are no readings: nobody knows where the target was.

    Raises `UsageError` if the library is absent, and `DataError` if the port cannot be opened, or no line
    comes.
    """

    def __init__(self, name: str, rate: int, wait: float = _SILENCE) -> None:
        try:
            import serial
        except ImportError:
            message = "a serial port needs the library pyserial: pip install 'echocal[serial]'"
            raise UsageError(message) from None
        self.name, self.rate, self.wait = name, rate, wait
        try:
            self._port: Any = serial.serial_for_url(name, baudrate=rate, timeout=wait)
        except (OSError, ValueError) as error:  # pyserial's own errors are OSErrors
            raise DataError(f"the port {name} cannot be opened: {error}") from None
        self.first = [line for line, _ in zip(self._lines(), range(_FIRST), strict=False)]

    def take(self, count: int) -> list[str]:
        """The next lines that come from now on; what came before is left out, and so is a part of a line."""
        self._port.reset_input_buffer()
        self._read()
        return [line for line, _ in zip(self._lines(), range(count), strict=False)]

    def more(self, count: int) -> list[str]:
        """The lines that follow."""
        return [line for line, _ in zip(self._lines(), range(count), strict=False)]

    def close(self) -> None:
        """Leave the port."""
        self._port.close()

    def _lines(self) -> Iterator[str]:
        while True:
            if text := self._read():
                yield text

    def _read(self) -> str:
        try:
            line = self._port.readline()
        except OSError as error:
            raise DataError(f"the port {self.name} does not answer any more: {error}") from None
        if not line.endswith(b"\n"):
            raise DataError(
                f"no line came from {self.name} in {self.wait:g} s at {self.rate} baud: does the sketch "
                "print lines, and at this rate?"
            )
        return str(line.decode("utf-8", errors="replace")).strip()
