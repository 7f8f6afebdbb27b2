"""Claims, verdicts and findings."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from echocal.study.tables import Printed, Tables


class Verdict(StrEnum):
    """What became of a claim."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCED = "not reproduced"
    PHYSICALLY_WRONG = "physically wrong"


@dataclass(frozen=True)
class Claim:
    """Something that the study states with a number."""

    id: str  # short name
    group: str  # heading in the report
    where: str  # section or table of the study
    claim: str  # what it states, in few words
    printed: str  # the number as printed
    unit: str  # its unit
    check: str  # name of the function that recomputes it
    options: dict[str, Any] = field(default_factory=dict)  # arguments of that function

    @property
    def number(self) -> Printed:
        """The printed number, for comparison."""
        return Printed(self.printed)

    def found(self, verdict: Verdict | bool, recomputed: str, because: str, **more: Any) -> "Finding":
        """Return the finding; True means reproduced and False means not reproduced."""
        if not isinstance(verdict, Verdict):
            verdict = Verdict.REPRODUCED if verdict else Verdict.NOT_REPRODUCED
        numbers = {name: float(value) for name, value in more.pop("numbers", {}).items()}
        return Finding(self, verdict, recomputed, because, numbers=numbers, **more)


@dataclass(frozen=True)
class Cell:
    """One cell of a table."""

    row: int
    temperature: float
    printed: str
    recomputed: float
    verdict: Verdict
    physical: float | None = None


@dataclass(frozen=True)
class Finding:
    """What the project's own tools say about a claim."""

    claim: Claim
    verdict: Verdict  # what became of it
    recomputed: str  # the number that comes out, in the unit of the claim
    because: str  # one sentence with the numbers that decide
    physical: str = ""  # the value in true air, where it differs; empty otherwise
    cells: tuple[Cell, ...] = ()  # row by row, for a claim about a table
    numbers: dict[str, float] = field(default_factory=dict)  # the numbers behind the sentence, unrounded

    def to_dict(self) -> dict[str, Any]:
        """Return the finding for JSON."""
        entry = asdict(self)
        claim: dict[str, Any] = entry.pop("claim")
        return claim | entry


CHECKS: dict[str, Callable[..., Finding]] = {}
"""How a claim is recomputed, by name: ``check(tables, claim, **options)``."""


def check(function: Callable[..., Finding]) -> Callable[[Tables, Claim], Finding]:
    """Register a check under its own name."""
    CHECKS[function.__name__] = function
    return function
