"""What a watch tells: events as data and as sentences."""

import json
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np

SCHEMA = "echocal.event/1"

_LONGEST = 80  # letters of an id that a person reads


@dataclass(frozen=True)
class Event:
    """One thing that a watch tells.

    Attributes
    ----------
    kind : {"learned", "change", "verdict", "clock", "ignored", "note"}
    sensor : str
        Its id; empty where there is one sensor only.
    time : float or None
        Time of the row at which it is told [s].
    row : int
        Number of that row among the rows of the sensor.
    sentence : str
    details : dict
        By kind, see docs/watch.md.
    """

    kind: str
    sensor: str
    time: float | None
    row: int
    sentence: str
    details: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """As in ``echocal.event/1``; not a number is None."""
        return {
            "schema": SCHEMA,
            "event": self.kind,
            "sensor": self.sensor,
            "time": None if self.time is None else instant(self.time),
            "row": self.row,
            "sentence": self.sentence,
            **finite(self.details),
        }

    def line_of_json(self) -> str:
        """The event for a program."""
        return json.dumps(self.to_dict(), allow_nan=False) + "\n"

    def line(self) -> str:
        """The event for a person."""
        when = "" if self.time is None else f"{instant(self.time)} "
        who = f"{self.sensor}: " if self.sensor else ""
        if len(who) > _LONGEST:
            who = f"{who[:_LONGEST]}...: "
        return f"{when}{who}{self.sentence}"


def instant(seconds: float, *, dated: bool = False) -> str | float:
    """ISO 8601 in UTC of seconds since 1970; seconds of a log's own clock stay what they are.

    With `dated` the clock is known to have dates.

    Examples
    --------
    >>> from echocal.watch.events import instant
    >>> instant(1.7e9), instant(600.0)
    ('2023-11-14T22:13:20Z', 600.0)
    """
    if not dated and not 1e8 <= seconds < 2.5e11:  # 1973 to 9892: else it counts from its own start
        return seconds
    text = datetime.fromtimestamp(round(seconds, 3), UTC).isoformat(timespec="milliseconds")
    return text.replace(".000", "").replace("+00:00", "Z")


def finite(value: Any) -> Any:
    """Plain data for JSON; not a number is None."""
    match value:
        case dict():
            return {name: finite(item) for name, item in value.items()}
        case list() | tuple():
            return [finite(item) for item in value]
        case np.generic():
            return finite(value.item())
        case float() if not np.isfinite(value):
            return None
    return value
