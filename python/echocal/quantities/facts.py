"""What echocal knows of one influence quantity."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any

from echocal import _core
from echocal.codes import HumidityCodes, TemperatureCodes
from echocal.quantities.units import Unit


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


_CORE: dict[str, dict[str, Any]] = {facts["name"]: facts for facts in _core.quantities()}


@dataclass(frozen=True)
class Shown:
    """Unit in which people read a quantity.

    Parameters
    ----------
    unit : str
        The unit as terminal and plots write it.
    factor : float
        What a value in SI is multiplied by.
    """

    unit: str
    factor: float = 1.0


_OWN_UNIT = Shown("")


@dataclass(frozen=True, kw_only=True)
class QuantityFacts:
    """An influence quantity (VIM 2.52): everything that is particular to it.

    Unit, default, source and range in the field come from the core
    (`rust/core/src/conditions.rs`); no entry repeats them.

    Parameters
    ----------
    id : str
        Name in Python, in model files and in the core.
    words : str
        Name in sentences, plots and pages.
    example : float
        A value to try effects at [unit].
    forms : tuple of Form
        How columns may hold it; empty where a table derives it from its rows.
    shown : Shown
        Unit in which people read it; default: its own unit.
    possible : (float, float)
        Range of the values that it can have [unit].
    dead : tuple of float
        Values of a sensor that is not there, besides the codes of loggers [unit].
    column : str
        Name of the column that an error is a function of; default: `id`.
    suspect : str
        What an error that is a smooth function of the quantity would point to; may be empty.
    standard_name : str
        Name in the CF conventions; empty where these have none.
    codes : type, optional
        Class of the integer codes by which a device measures it.
    why_no_codes : str
        Why no device measures it, where `codes` is None.
    workshop : (float, float), optional
        Range that anybody can vary on a bench [unit]; None: not without special means.
    judged_outside : bool
        Whether a diagnosis fits a model to the middle of its range and judges the model by the rows outside.
    runs_on : bool
        Whether it goes on by itself, so that later measurements have larger values.

    Attributes
    ----------
    unit : str
        SI unit, or degC, or 1.
    default : float or None
        Value that is assumed where none is recorded [unit]; None where it must be given.
    derived_from : str or None
        What a table must hold for it to be derived; None where it is recorded.
    field_range : (float, float)
        Range in the field [unit]; a firmware states the cost of not measuring the quantity over it.
    field_from : str or None
        Quantity that `field_range` is counted from; None where it is absolute.

    Examples
    --------
    >>> from echocal.quantities import QUANTITIES
    >>> humidity = QUANTITIES["relative_humidity"]
    >>> humidity.default, humidity.unit, humidity.columns
    (0.0, '1', ('humidity_percent', 'relative_humidity', 'relative_humidity_percent'))
    """

    id: str
    words: str
    example: float
    forms: tuple[Form, ...] = ()
    shown: Shown = _OWN_UNIT
    possible: tuple[float, float] = (-inf, inf)
    dead: tuple[float, ...] = ()
    column: str = ""
    suspect: str = ""
    standard_name: str = ""
    codes: type[TemperatureCodes | HumidityCodes] | None = None
    why_no_codes: str = ""
    workshop: tuple[float, float] | None = None
    judged_outside: bool = False
    runs_on: bool = False
    unit: str = field(init=False)
    default: float | None = field(init=False)
    derived_from: str | None = field(init=False)
    field_range: tuple[float, float] = field(init=False)
    field_from: str | None = field(init=False)

    def __post_init__(self) -> None:
        core = _CORE.get(self.id)
        if core is None:
            raise ImportError(
                f"the core has no quantity '{self.id}'; add it to rust/core/src/conditions.rs, "
                "then run: maturin develop --profile quick"
            )
        for name in ("unit", "default", "derived_from", "field_range", "field_from"):
            object.__setattr__(self, name, core[name])
        if not self.column:
            object.__setattr__(self, "column", self.id)
        if self.shown is _OWN_UNIT:
            object.__setattr__(self, "shown", Shown("" if self.unit == "1" else self.unit))

    @property
    def columns(self) -> tuple[str, ...]:
        """Every name that a column of it may have."""
        return tuple(name for form in self.forms for name in form.names)

    @property
    def si_column(self) -> str:
        """Name of a column that holds it in SI; its id where it is derived."""
        names = [
            name
            for form in self.forms
            for name, unit in zip(form.names, form.units.values(), strict=True)
            if unit.is_si
        ]
        return names[-1] if names else self.id  # of "time" and "time_s" the second holds numbers
