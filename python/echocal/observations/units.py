"""The names that a table's columns may have: those of readings, of influence quantities and of labels."""

import re

from echocal.quantities import QUANTITIES, Form, Unit
from echocal.quantities.units import LENGTH, ONE_WAY_TIME, TEMPERATURE, TIME, TWO_WAY_LENGTH, Units

_ECHO = (0.0, 0.5)  # 86 m out and back: beyond any ranger in air
_ECHOES = (5e-5, 0.5)  # 9 mm: below any ranger's blanking distance
_RANGE = (0.0, 100.0)
_RANGES = (5e-3, 100.0)
_MORE = {
    "degc": "C", "deg c": "C", "deg_c": "C", "°c": "C", "c": "C", "ºc": "C", "*c": "C", "grad c": "C",
    "celsius": "C", "degrees c": "C", "degree celsius": "C", "degrees celsius": "C", "oc": "C",
    "degf": "F", "deg f": "F", "deg_f": "F", "°f": "F", "f": "F", "ºf": "F", "fahrenheit": "F", "*f": "F",
    "kelvin": "K", "k": "K",
    "m": "m", "metre": "m", "cm": "cm", "cms": "cm", "mm": "mm", "in": "inch", "inch": "inch",
    "us": "us", "usec": "us", "µs": "us", "μs": "us", "microsec": "us", "ms": "ms", "msec": "ms",
    "millis": "ms", "s": "s", "sec": "s", "secs": "s",
    "%": "percent", "%rh": "percent", "% rh": "percent", "rh%": "percent", "pct": "percent",
    "percent": "percent", "hpa": "hPa", "mbar": "mbar", "mb": "mbar", "millibar": "mbar", "pa": "Pa",
    "kpa": "kPa", "ppm": "ppm", "v": "V", "volt": "V", "volts": "V", "mv": "mV",
    "m/s": "m_s", "m s-1": "m_s", "meters/second": "m_s", "km/h": "km_h", "kph": "km_h",
    "w/m2": "W_m2", "w/m^2": "W_m2", "w/m²": "W_m2", "w m-2": "W_m2", "lux": "lux", "lx": "lux",
    "deg": "deg", "°": "deg", "degrees": "deg", "min": "min", "h": "h",
}  # fmt: skip


def _echo(role: str, units: Units, *words: str, holds: str) -> Form:
    return Form(role, "echo_time", units, words, _ECHO, _ECHOES, positive=True, holds=holds)


def _length(role: str, quantity: str, units: Units, *words: str, holds: str, level: bool = False) -> Form:
    return Form(role, quantity, units, words, _RANGE, _RANGES, positive=True, level=level, holds=holds)


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
    _length(
        "level",
        "reading",
        LENGTH,
        holds="what the device indicates, counted upward: with a [mount height](logs.md#levels)",
        level=True,
    ),
    _length("reference_level", "reference_distance", LENGTH, holds="reference of a level", level=True),
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


for _symbol, _words in UNIT_WORDS.items():
    for _word in (*_words, _symbol.lower()):
        if _word:
            _MORE.setdefault(_word, _symbol)

WRITTEN = tuple(sorted(_MORE, key=len, reverse=True))
"""Ways to write a unit, in lower case, the longest first."""

_LOGGERS = {
    "ts", "rn", "avg", "smp", "min", "max", "tot", "std", "wvc", "tmx", "tmn", "smm", "time", "date",
    "yyyy-mm-dd", "hh:mm:ss", "dd.mm.yyyy", "iso8601", "utc", "unix", "-", "--", "n/a", "none", "string",
    "text", "bool", "unitless", "1", "count", "counts", "id", "quality", "raw", "a", "ma", "w", "hz",
    "db", "dbm", "min.", "max.",
}  # fmt: skip
"""What stands in a row of units beside units: how a logger made a value, and kinds of columns."""

_BRACKET = re.compile(r"(?P<words>.*?)\s*[\[(]\s*(?P<unit>[^\])]*?)\s*[\])](?P<rest>.*)")
_BEFORE = re.compile(r"(?P<unit>°[CF]|%|mm|cm|hPa|kPa|mbar)\s+(?P<words>\w.*)")
_AFTER = re.compile(
    r"(?P<words>.+?)(?:\s+in\s+|\s*/\s*|\s*,\s*|_|\s+|\.|-)(?P<unit>[^\s_,./-]+(?:/\S+)?|deg[_ ][cf])",
    re.IGNORECASE,
)


def symbol_of(written: str) -> str:
    """Symbol of a unit as somebody writes it; empty for what is no unit.

    Examples
    --------
    >>> symbol_of("°C"), symbol_of("Deg C"), symbol_of("meters"), symbol_of("apples")
    ('C', 'C', 'm', '')
    """
    return _MORE.get(" ".join(written.replace("�", "°").split()).lower(), "")


def split_unit(name: str) -> tuple[str, str]:
    """Words and unit of a column's name; the unit is empty where there is none.

    Examples
    --------
    >>> split_unit("Distance (cm)"), split_unit("temp_C"), split_unit("Abstand / mm"), split_unit("level")
    (('Distance', 'cm'), ('temp', 'C'), ('Abstand', 'mm'), ('level', ''))
    """
    bracket = _BRACKET.fullmatch(name)
    if bracket and (unit := symbol_of(bracket["unit"])):
        return f"{bracket['words']} {bracket['rest']}".strip(), unit
    plain = bracket["words"] if bracket else name
    before = _BEFORE.fullmatch(plain.strip())
    if before and (unit := symbol_of(before["unit"])):
        return before["words"], unit
    after = _AFTER.fullmatch(plain.strip())
    if after and (unit := symbol_of(after["unit"])):
        return after["words"].strip(), unit
    return name, ""


def has_foreign_unit(name: str) -> bool:
    """Whether a name has something in brackets that is no unit of ours: ``Range (yd)``."""
    bracket = _BRACKET.fullmatch(name)
    return bool(
        bracket and re.fullmatch(r"[A-Za-zµ°/%²³^-]{1,8}", bracket["unit"]) and not symbol_of(bracket["unit"])
    )


def is_unit_row(fields: list[str]) -> bool:
    """Whether the fields of a line are units, or say how a logger made its values."""
    filled = [field.strip().strip("()[]").strip() for field in fields if field.strip()]
    return bool(filled) and all(symbol_of(text) or text.lower() in _LOGGERS for text in filled)
