"""How the values of a column came to rows that were recorded at other times."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from echocal.observations.fields import rows, span

__all__ = ["Join", "told"]


@dataclass(frozen=True)
class Join:
    """How a column came to the rows of a table: its values were recorded at other times."""

    how: Literal["interpolated", "nearest", "ordered"]
    """``ordered``: as the values follow each other in a log without a clock; one of {"interpolated",
    "nearest", "ordered"}."""
    interval_s: float
    """Usual time between two of its values [s]: half of the record lies in shorter ones."""
    limit_s: float
    """Longest time between two values that it was joined over [s]."""
    without: int
    """Rows that have no value, because no value is near enough."""

    def __str__(self) -> str:
        if self.how == "ordered":
            return "in the order of the log, which has no clock"
        way = "interpolated in time" if self.how == "interpolated" else "the nearest in time"
        apart = (
            f" (values {span(self.interval_s)} apart, up to {span(self.limit_s)})" if self.interval_s else ""
        )
        none = f", no value near enough for {rows(self.without)}" if self.without else ""
        return f"{way}{apart}{none}"


def told(joined: Mapping[str, Join]) -> list[str]:
    """A sentence for each way in which columns were joined."""
    ways: dict[str, list[str]] = {}
    for column, join in joined.items():
        ways.setdefault(str(join), []).append(f"'{column}'")
    return [
        f"{', '.join(names)} {'has' if len(names) == 1 else 'have'} other times than the rows: {way}"
        for way, names in ways.items()
    ]
