"""``echocal bench``: a ruler experiment, placement by placement."""

import io
import math
import shlex
import sys
import warnings
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from echocal.bench.lines import Port, block
from echocal.bench.places import Span, decides_nothing_more, next_place, places_of
from echocal.bench.readings import Placement, Ruler
from echocal.cli._console import Console
from echocal.cli._outputs import Force, Output, check_outputs
from echocal.cli._tables import AS_IT_IS, Given, reading_options, reading_words
from echocal.cli.diagnose import Base, base_of
from echocal.diagnose import Diagnosis, diagnose
from echocal.diagnose.preprocess.reference import refuse_distance
from echocal.diagnose.results.brief import brief
from echocal.errors import DataError, UsageError
from echocal.keywords import command_line, keyword
from echocal.observations.at import parsed
from echocal.outputs import csv_text, replace_text

_Answer = TypeVar("_Answer")

_FEWEST = 3  # placements before a diagnosis
_TRIES = 5  # times as many lines as readings, after which a placement is told to have no echo
_DONE = ("done", "q", "quit", "end")
_YES = ("", "y", "yes")
_NAMES = "echo_us,temperature_C"
_MARK = "# how to read: a ruler experiment, written by echocal bench"


@reading_options("sheet", "reference", "reference_join", "mount_height")
def command(
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE.csv", help="The table, for `echocal FILE.csv`.")
    ] = Path("ruler.csv"),
    port: Annotated[
        str | None,
        typer.Option(metavar="PORT", help="Serial port of the board (/dev/ttyUSB0, COM3); default: stdin."),
    ] = None,
    baud: Annotated[int, typer.Option(min=1, help="Rate of the port, in bits per second.")] = 9600,
    span: Annotated[
        str, typer.Option(metavar="NEAR:FAR", help="Nearest and farthest place of the target, in m.")
    ] = "0.3:3",
    readings: Annotated[
        int, typer.Option("--readings", "-n", min=3, help="Readings at each placement.")
    ] = 20,
    names: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="What bare numbers are: echo_us,temperature_C.",
        ),
    ] = None,
    base: Base = "linear",
    reading: Given = AS_IT_IS,
    force: Force = False,
) -> None:
    """Walk through a ruler experiment: where the target goes, what is known so far, and when it is enough.

    Readings come from a serial port, or from stdin: typed, pasted or piped, an empty line after a placement.
    """
    ends = _span(span)
    if out.suffix.lower() != ".csv":
        raise UsageError(f"--out {out} must end in .csv")
    # the rows of an earlier experiment are measured data: no existing table may be replaced unasked
    check_outputs(Output("--out", out, lambda _: False), inputs=[*reading.files], force=force)
    with ExitStack() as at_end:
        source = None if port is None else Port(port, baud)
        if source is not None:
            at_end.callback(source.close)
        walk = _Walk(out, ends, readings, base, Ruler(reading, names or ""), source)
        walk.run()
    if walk.ruler.table.empty:
        raise DataError(f"no placement was measured, so {out} is not written")
    given = reading_words(Given(**walk.ruler.reading()))
    folder = None if out.parent == Path() else out.parent
    again = command_line(str(out), base=None if base == "linear" else base, **given, out=folder)
    walk.say(f"\n{again}")
    from echocal.cli import app  # which imports this file when the command runs

    app(shlex.split(again)[1:], prog_name="echocal", standalone_mode=False)


@dataclass
class _Walk:
    """The experiment as a conversation."""

    out: Path
    span: Span
    readings: int
    base: str
    ruler: Ruler
    port: Port | None
    visited: list[float] = field(default_factory=list)
    diagnosis: Diagnosis | None = None
    met: bool = False
    """Whether it is known what the lines hold."""

    def __post_init__(self) -> None:
        self.console = Console(stderr=True, highlight=False)
        self.typed = self.port is None
        self.person = sys.stdin.isatty() or not self.typed
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(errors="replace")  # as the lines of a port

    def say(self, text: str) -> None:
        """Say something beside the result."""
        self.console.print(text, markup=False, soft_wrap=True)

    def run(self) -> None:
        """Take placements until there are no more."""
        if self.port is not None:
            self._meet(self.port.first)
        while (distance := self._distance()) is not None:
            lines = self._lines(distance)
            if not lines:
                self.say("  no line came: this placement is left out")
                continue
            placement = self._placement(lines, distance)
            self.say(f"  at {distance:g} m {placement.usable} of {placement.lines} lines have an echo")
            self.ruler.add(placement, distance)
            replace_text(self.out, f"{_MARK}\n{csv_text(self.ruler.table)}", newline="")
            if not placement.usable:
                self.say("  turn the target so that it faces the sensor, and measure this place again")
                continue
            places = places_of(self.span)
            self.visited.append(min(places, key=lambda place: abs(math.log(place / distance))))
            self._tell()

    def _distance(self) -> float | None:
        place = next_place(self.span, self.visited, self.diagnosis)
        enough = decides_nothing_more(self.span, self.visited, self.diagnosis)
        first = f"placement {len(self.visited) + 1}: put the target at {place:g} m"
        if enough:
            first = "this is enough: each place was measured twice, and more rows promise nothing"
        enter = "ends" if enough and self.person else f"{place:g}"
        text = f"{first}. Distance by the ruler, in m (Enter: {enter}; done ends): "
        found = self._asked(text, _meters)
        if found is None or (found == 0.0 and enough and self.person):
            return None
        return found or place

    def _lines(self, distance: float) -> list[str]:
        if self.port is None:
            if self.person:
                self.say(f"  type or paste {self.readings} lines of readings or more, then an empty line:")
            return block(sys.stdin.readline, self._cut)
        lines = self.port.take(self.readings)
        while (missing := self.readings - self._placement(lines, distance).usable) > 0:
            if len(lines) >= _TRIES * self.readings:
                break
            lines += self.port.more(missing)
        return lines

    def _cut(self, line: str) -> None:
        self.say(f"  the input ends within the line {line!r}: it is left out; end each line with a line feed")

    def _placement(self, lines: list[str], distance: float) -> Placement:
        self._meet(lines)
        return self.ruler.placement(lines, distance)

    def _meet(self, lines: list[str]) -> None:
        """Learn what the lines hold; ask what they do not say."""
        found = None if self.met else self.ruler.first_looked_at(lines)
        if found is None:
            return
        if self.ruler.has_no_names(found):
            text = f"The lines are numbers such as {lines[-1]!r}: what are they? ({_NAMES}): "
            self.ruler.heading = self._answer(text, _heading, f"{keyword('names', _NAMES)}")
            found = self.ruler.first_looked_at(lines)
            assert found is not None
        guesses = [c for c in found.columns if c.proposal.guess]
        for column in guesses:
            text = f"Is {column.name!r} {column.proposal.request}? {column.proposal.reason} (yes or a name): "
            answer = self._answer(text, str, keyword("columns", {column.name: column.proposal.request}))
            request = column.proposal.request if answer.lower() in _YES else answer
            self.ruler.say_of(column.name, request)
        self.ruler.keep_heading(found, lines)
        if not self.ruler.knows("temperature", found):
            text = "What temperature has the air, in degC? Its uncertainty after +-, such as 20+-2: "
            flag = keyword("at", {"temperature": "20+-2"})
            self.ruler.state("temperature", self._answer(text, _temperature, flag))
        self.met = True

    def _answer(self, text: str, convert: Callable[[str], _Answer], flag: str) -> _Answer:
        """An answer that nothing can be measured without."""
        if not self.person:
            raise DataError(
                f"the lines do not say it, and nobody is at the terminal to ask: {text.strip()} {flag}"
            )
        found = self._asked(text, convert)
        if found is None:
            raise DataError(f"no answer came: {flag}")
        return found

    def _asked(self, text: str, convert: Callable[[str], _Answer]) -> _Answer | None:
        """An answer that makes sense; None at the end of stdin, or where the answer ends the experiment."""
        while True:
            if self.person:
                sys.stderr.write(text)
                sys.stderr.flush()
            line = sys.stdin.readline()
            if not line or line.strip().lower() in _DONE:
                return None
            try:
                return convert(line.strip())
            except UsageError as error:
                if not sys.stdin.isatty():
                    raise
                self.say(f"  {error}")

    def _tell(self) -> None:
        """Say what is known so far."""
        if len(self.visited) < _FEWEST:
            return
        try:
            with warnings.catch_warnings(action="ignore"):
                self.diagnosis = diagnose(
                    self.ruler.table,
                    base=base_of(self.base),
                    can_vary={"distance": self.span},
                    **self.ruler.reading(),
                )
        except DataError as error:
            self.diagnosis = None
            self.say(f"  so far: {error}")
            return
        short = brief(self.diagnosis)
        word = "good enough" if self.diagnosis.good_enough else self.diagnosis.verdict
        self.say(f"  so far {word}: {short.wrong}\n  {short.size} {short.sure}")


def _span(text: str) -> Span:
    near, _, far = text.partition(":")
    try:
        ends = float(near), float(far)
    except ValueError:
        raise UsageError(f"--span '{text}' is not two distances in m, such as 0.3:3") from None
    for one in ends:
        refuse_distance(one)
    if not ends[0] < ends[1]:
        raise UsageError(f"--span '{text}': the nearer place comes first, such as 0.3:3")
    return ends


def _meters(text: str) -> float:
    """A distance; 0 for an empty answer."""
    if not text:
        return 0.0
    try:
        found = float(text.removesuffix("m").strip())
    except ValueError:
        raise UsageError(f"'{text}' is no distance: a number of meters such as 1.2, Enter, or done") from None
    refuse_distance(found)
    return found


def _heading(text: str) -> str:
    if not text:
        raise UsageError(f"names with units, a comma between two: {_NAMES}")
    return text


def _temperature(text: str) -> str:
    parsed({"temperature": text})
    return text
