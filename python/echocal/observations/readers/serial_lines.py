"""Lines of a serial monitor: ``14:00:00.199 -> Distance: 12.3 cm``, or the same without a time."""

import csv
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from echocal.observations.heading import find_head, is_value
from echocal.observations.readers.log import Log
from echocal.observations.units_said import symbol_of

__all__ = ["NAME", "pairs_of", "read", "recognizes"]

NAME = "lines of a serial monitor"

_PREFIX = re.compile(
    r"\s*[\[(]?(?P<time>(?:\d{4}-\d\d-\d\d[T ]|\d{1,2}[./]\d{1,2}[./]\d{2,4},? )?"
    r"\d{1,2}:\d\d:\d\d(?:[.,:]\d+)?Z?)"
    r"[\])]?\s*(?P<arrow>->|=>|>|\||;|:|-)?\s+(?P<rest>.*)"
)
_STAMP = re.compile(r"\s*\[\s*(?P<time>\d+(?:\.\d+)?)\s*\]\s*(?P<rest>.*)")
_PAIR = re.compile(
    r"(?<![\w.])(?P<name>[A-Za-zÀ-ÿ°µ][\w °µ./%()\[\]#-]*?)\s*(?::|=|\bis\b)\s*"
    r"(?P<value>[-+]?(?:\d++(?:[.,]\d++)?|\.\d++)(?:[eE][-+]?\d+)?(?!:)|nan|inf|NaN|--+)"
    r"\s*(?P<unit>°\s?[CF]|[*º]C|deg[ _]?[CF]?|%(?: ?RH)?|[A-Za-zµμ]+(?:/\w+)?)?"
)
_SYSLOG = re.compile(r"(?P<time>[A-Z][a-z]{2} [ \d]\d \d\d:\d\d:\d\d) \S+ \S+?: (?P<rest>.*)")
_SINGLE = re.compile(r"[-+]?\d+(?:[.,]\d+)?\s*(?:cm|mm|m|in|inch|us|µs)")
_LEVEL = re.compile(r"^(?:INFO|DEBUG|WARN(?:ING)?|TRACE|NOTICE|I|D)\b[ :-]*")
_NUMBER = re.compile(r"[-+]?\d+(?:[.,]\d+)?")
_LOOK = 100


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines have a time and an arrow, or names with values."""
    look = lines[:_LOOK]
    arrows = sum(bool((m := _PREFIX.fullmatch(line)) and m["arrow"] in {"->", "=>"}) for line in look)
    if 2 * arrows > len(look):
        return True
    if 2 * sum(bool(_SINGLE.fullmatch(_split(line)[1])) for line in look) > len(look):
        return True
    named = sum(bool(pairs_of(_split(line)[1])) for line in look)
    return 2 * named > len(look) or (3 * named > len(look) and not any(_delimited(line) for line in look))


def read(lines: Sequence[str], path: str) -> Log:
    """Read the lines; a line without values below the first is a row with a reason."""
    split = [_split(line) for line in lines if line.strip()]
    rests = [rest for _, rest in split]
    named = sum(bool(pairs_of(rest) or _SINGLE.fullmatch(rest)) for rest in rests)
    if 2 * named >= len(rests) or (named >= 3 and not any(_delimited(r) for r in rests)):
        return _named(split)
    return _delimited_rests(split)


def pairs_of(text: str) -> list[tuple[str, str, str]]:
    """Names, values and units in a line."""
    found = []
    for match in _PAIR.finditer(text):
        words = match["name"] if "[" in match["name"] else match["name"].rpartition("]")[2]
        name = _LEVEL.sub("", " ".join(words.strip(" -,;|").split()))
        if name and not re.fullmatch(r"https?|\d*", name):
            found.append((name, match["value"], match["unit"] or ""))
    return found


def _split(line: str) -> tuple[str, str]:
    """Time and rest of a line."""
    match = _PREFIX.fullmatch(line) or _STAMP.fullmatch(line) or _SYSLOG.fullmatch(line)
    return (match["time"], match["rest"].strip()) if match else ("", line.strip())


def _named(split: Sequence[tuple[str, str]]) -> Log:
    log = Log([])
    records: list[dict[str, Any]] = []
    units: dict[str, set[str]] = {}
    for time, rest in split:
        pairs = pairs_of(rest)
        if not pairs and _SINGLE.fullmatch(rest):
            pairs = pairs_of(f"{'echo' if rest.endswith('s') else 'distance'}: {rest}")
        if not pairs:
            if records and re.search(r"\w", rest):
                log.corrupt[len(records)] = rest
                records.append(_at(time))
            continue
        names = [name for name, _, _ in pairs]
        fresh = not records or len(records) - 1 in log.corrupt or set(names) & set(records[-1])
        if fresh:
            records.append(_at(time))
        for name, value, unit in pairs:
            records[-1][name] = value.replace(",", ".")
            units.setdefault(name, set()).add(symbol_of(unit) and unit)
    log.records = records
    for name, said in units.items():
        said.discard("")
        if len(said) == 1:
            log.units[name] = said.pop()
        elif said:
            log.notes.append(f"'{name}' comes in several units: {', '.join(sorted(said))}")
    return log


def _at(time: str) -> dict[str, Any]:
    if not time:
        return {}
    if time.replace(".", "").isdigit():
        return {"time_s": time}
    if time[:1].isalpha():  # a date without a year
        instant = datetime.strptime(f"2000 {time}", "%Y %b %d %H:%M:%S").replace(tzinfo=UTC)
        return {"time_s": instant.timestamp()}
    return {"time": re.sub(r"(?<=\d),(?=\d)", ".", time)}


def _delimited(rest: str) -> bool:
    return any(rest.count(s) for s in ",;\t|") and any(map(is_value, re.split(r"[,;\t|]", rest)))


def _delimited_rests(split: Sequence[tuple[str, str]]) -> Log:
    """Numbers with separators, or one number a line, behind the times."""
    first = next((n for n, (_, rest) in enumerate(split) if _delimited(rest) or _NUMBER.match(rest)), 0)
    begin = max(first - 1, 0)
    head = find_head([rest for _, rest in split[begin:]], 0, "")
    rows = split[begin + head.start :]
    log = Log([], notes=[] if not head.nameless else ["the values have no names"])
    records = []
    for time, rest in rows:
        fields = next(csv.reader([rest], delimiter=head.separator, skipinitialspace=True), [])
        if len(fields) == len(head.names) and any(map(is_value, map(_bare, fields))):
            records.append({**_at(time), **dict(zip(head.names, fields, strict=True))})
        else:
            log.corrupt[len(records)] = rest
            records.append(_at(time))
    log.records, log.units = records, dict(head.units)
    return log


def _bare(field: str) -> str:
    return re.sub(r"[^\d.,+-]+$", "", field.strip())
