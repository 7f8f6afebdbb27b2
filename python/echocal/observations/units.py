"""The names that a table's columns may have: those of readings, of influence quantities and of labels."""

from echocal.quantities import QUANTITIES, Form, Unit
from echocal.quantities.units import LENGTH, ONE_WAY_TIME, TEMPERATURE, TIME, TWO_WAY_LENGTH, Units

__all__ = ["FORMS", "NAMES", "THERMOMETER", "UNIT_WORDS", "Form", "Unit"]

_ECHO = (0.0, 0.5)  # 86 m out and back: beyond any ranger in air
_ECHOES = (5e-5, 0.5)  # 9 mm: below any ranger's blanking distance
_RANGE = (0.0, 100.0)
_RANGES = (5e-3, 100.0)


def _echo(role: str, units: Units, *words: str, holds: str) -> Form:
    return Form(role, "echo_time", units, words, _ECHO, _ECHOES, positive=True, holds=holds)


def _length(role: str, quantity: str, units: Units, *words: str, holds: str) -> Form:
    return Form(role, quantity, units, words, _RANGE, _RANGES, positive=True, holds=holds)


def _label(role: str, *words: str, holds: str, quantity: str = "") -> Form:
    return Form(role, quantity or role, {"": Unit()}, words, label=True, holds=holds)


THERMOMETER = Form(
    "thermometer",
    "thermometer",
    TEMPERATURE,
    ("further thermometer",),
    (-95.0, 150.0),  # a box in the sun may be warmer than air
    holds="a further thermometer, also as `temperature_NAME_C`; a table may have several",
    several=True,
)
"""A thermometer beside that of the air: of the box, of a second logger, of the water."""

FORMS: tuple[Form, ...] = (
    _echo("echo", TIME, "echo time", "time of flight", holds="recorded echo time, out and back"),
    _echo("time_of_flight", TIME, holds="the same as `echo`"),
    _echo("transit", ONE_WAY_TIME, "transit time", "one-way time", holds="one-way time"),
    _length(
        "reading", "reading", LENGTH, "distance reading", "indication", holds="what the device indicates"
    ),
    _length(
        "two_way_reading",
        "reading",
        TWO_WAY_LENGTH,
        "two-way reading",
        holds="what a device indicates that does not halve the path",
    ),
    _length("distance", "reference_distance", LENGTH, "reference distance", holds="reference distance"),
    _length(
        "two_way_distance",
        "reference_distance",
        TWO_WAY_LENGTH,
        "two-way distance",
        holds="reference distance, out and back",
    ),
    Form(
        "level",
        "reading",
        LENGTH,
        (),
        _RANGE,
        _RANGES,
        positive=True,
        level=True,
        holds="what the device indicates, counted upward: with a [mount height](logs.md#levels)",
    ),
    Form(
        "reference_level",
        "reference_distance",
        LENGTH,
        (),
        _RANGE,
        _RANGES,
        positive=True,
        level=True,
        holds="reference of a level",
    ),
    *(form for quantity in QUANTITIES.values() for form in quantity.forms),
    THERMOMETER,
    _label("stand", holds="placement of the target that a row belongs to"),
    _label("station", holds="another name of `stand`", quantity="stand"),
    _label("group", "burst", holds="burst that a row belongs to"),
    _label("order", holds="position of a row in its burst"),
)
"""Every quantity that a table may hold."""

NAMES: dict[str, tuple[Form, str]] = {
    name: (form, unit) for form in FORMS for name, unit in zip(form.names, form.units, strict=True)
}
"""Form and unit by column name."""

UNIT_WORDS: dict[str, set[str]] = {}
"""Other ways to write a unit, in lower case, by its symbol."""
for _form in FORMS:
    for _symbol, _unit in _form.units.items():
        UNIT_WORDS.setdefault(_symbol, set()).update(_unit.words)
