"""How a column of a table may hold a quantity: its names, its units, its limits."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

from echocal.quantities.units import Unit

__all__ = ["Form"]


@dataclass(frozen=True)
class Form:
    """A quantity that a column may hold, and how it may be written."""

    role: str
    """First part of the column's name; the unit follows after an underscore."""
    quantity: str
    """Where the values go: an influence quantity, or a field of `Observations`."""
    units: Mapping[str, Unit]
    words: tuple[str, ...]
    """What people call it: ``"distance reading in m"``."""
    physical: tuple[float, float] = (-inf, inf)
    """Rows outside cannot be used [SI]."""
    typical: tuple[float, float] | None = None
    """A median outside looks like another unit [SI]; None: as `physical`."""
    positive: bool = False
    """Whether the lower bound itself is impossible."""
    also: tuple[str, ...] = field(default=(), kw_only=True)
    """Names of other forms that a column of this one may be by mistake."""
    label: bool = field(default=False, kw_only=True)
    """Whether values are labels rather than measurements."""
    holds: str = field(default="", kw_only=True)
    """What the column holds, for the table in the documentation; empty: the first of `words`."""
    stand_in: bool = field(default=False, kw_only=True)
    """Whether it is a further column, no quantity, where another form holds the quantity."""
    several: bool = field(default=False, kw_only=True)
    """Whether a table may have several such columns; each keeps its name."""
    level: bool = field(default=False, kw_only=True)
    """Whether it rises where the distance falls: distance = mount height - level."""
    mount_height: float | None = field(default=None, kw_only=True)
    """Of a level: height of the sensor above its zero [m]; None where it is not known yet."""
    error_codes: Mapping[str, tuple[float, ...]] = field(default_factory=dict, kw_only=True)
    """Values that sensors write where they have none, by unit of the column."""

    @property
    def names(self) -> tuple[str, ...]:
        """Every accepted column name."""
        return tuple(f"{self.role}_{unit}" if unit else self.role for unit in self.units)

    @property
    def meaning(self) -> str:
        """What the column holds."""
        return self.holds or self.words[0]
