"""Names, values and units in a line: ``distance:101.99<TAB>temp:12.0``, ``Dist 12.3 cm, Temp = 20 °C``."""

import re
from collections.abc import Iterator

from echocal.observations.numbers import SILENT
from echocal.observations.units import WRITTEN, symbol_of

Pair = tuple[str, str, str]
"""Name, value and unit; the value is ``nan`` where the line says that there is none."""

_NUMBER = r"[-+]?(?:\d++(?:[.,]\d++)?|\.\d++)(?:[eE][-+]?\d+)?(?![.:]?\d|x[\da-fA-F])"
_NO_NAME = r"(?!\s*(?:[:=]|is\b))"  # a word before a colon is the name of the next value
_KNOWN = rf"\s*(?P<{{0}}>(?i:{'|'.join(map(re.escape, WRITTEN))}))(?![\w°%]|/\w){_NO_NAME}"
_ANY = rf"(?:{_KNOWN.format('unit')}|(?P<odd>[A-Za-zµμ]++(?:/\w++)?){_NO_NAME})"
_VALUE = (
    rf"(?:(?P<value>{_NUMBER})(?:{_ANY})?|(?P<none>(?i:nan|inf|none|null|-{{2,}}|(?:{SILENT})[!.]*))(?!\w))"
)
_NAME = r"(?<![\w.])(?P<name>(?:[A-Za-zÀ-ÿ°µ]|#\d)[\w °µ./%()\[\]#-]*?)"
_PAIR = re.compile(
    rf"{_NAME}\s*(?::+|=+>?|->|\bis\b)\s*{_VALUE}"
    rf"|{_NAME.replace('name', 'before')}\s+(?P<bare>{_NUMBER}){_KNOWN.format('of_bare')}"
)
_NEXT = re.compile(rf"[\s,;/|(]*(?P<value>{_NUMBER}){_KNOWN.format('unit')}")
_INDEX = re.compile(r"#?\d+[:.)]\s+(?=[-+\d.])")
_CHANGED = re.compile(r".*?'(?P<name>[^']+)' (?:changed from .*? to|updated to) (?P<rest>.*)")
_LEVEL = re.compile(r"^(?:INFO|DEBUG|WARN(?:ING)?|TRACE|NOTICE|I|D)\b[ :-]+(?=\w)")
_FILLER = re.compile(r"^(?:and|with|the|at)\s+", re.IGNORECASE)
_KINDS = {
    "m": "distance", "cm": "distance", "mm": "distance", "inch": "distance", "ft": "distance", "us": "echo",
    "ms": "echo", "C": "temperature", "F": "temperature", "percent": "humidity",
}  # fmt: skip
"""What a value without a name is, by its unit."""


def pairs_of(text: str) -> list[Pair]:
    r"""Names, values and units in a line.

    A word after a value is its unit where it is one and no colon follows: else it begins the next name.
    Further values with units of their own behind a value are the same in other units.

    Examples
    --------
    >>> pairs_of("distance:101.99\ttemp:12.0"), pairs_of("d: 12 cm: 13")
    ([('distance', '101.99', ''), ('temp', '12.0', '')], [('d', '12', ''), ('cm', '13', '')])
    >>> pairs_of("Temperature: 20.0 *C 68.0 *F")
    [('Temperature', '20.0', '*C'), ('Temperature (*F)', '68.0', '*F')]
    >>> pairs_of("Distance = Out of range"), pairs_of("12in, 30cm")
    ([('Distance', 'nan', '')], [('distance (in)', '12', 'in'), ('distance (cm)', '30', 'cm')])
    """
    if match := _CHANGED.fullmatch(text):
        text = f"{match['name']}: {match['rest']}"
    return list(_named(text)) or _nameless(text)


def _named(text: str) -> Iterator[Pair]:
    place = 0
    while match := _PAIR.search(text, place):
        place = match.end()
        name = _name(match["name"] or match["before"])
        if not name or re.fullmatch(r"https?|\d*", name):
            continue
        unit = match["unit"] or match["of_bare"] or match["odd"] or ""
        yield name, match["value"] or match["bare"] or "nan", unit
        while further := _NEXT.match(text, place):
            place = further.end()
            kind, own = (_KINDS.get(symbol_of(u)) for u in (unit, further["unit"]))
            named = own if own and own != kind else f"{name} ({further['unit']})"
            yield named, further["value"], further["unit"]


def _nameless(text: str) -> list[Pair]:
    """Values with units and without names, where a line has nothing else."""
    found, place = [], len(index[0]) if (index := _INDEX.match(text)) else 0
    while match := _NEXT.match(text, place):
        place = match.end()
        kind = _KINDS.get(symbol_of(match["unit"]))
        if kind is None:
            return []
        found.append((kind, match["value"], match["unit"]))
    if text[place:].strip(" \t,;.)|"):
        return []
    one = len(found) == 1
    return [(kind if one else f"{kind} ({unit})", value, unit) for kind, value, unit in found]


def _name(written: str) -> str:
    words = written if "[" in written else written.rpartition("]")[2]
    return _FILLER.sub("", _LEVEL.sub("", " ".join(words.strip(" -,;|").split())))
