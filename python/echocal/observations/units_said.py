"""Units as people and loggers write them."""

import re

from echocal.observations.units import UNIT_WORDS

__all__ = ["WRITTEN", "has_foreign_unit", "is_unit_row", "split_unit", "symbol_of"]

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
