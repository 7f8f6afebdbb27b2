"""Lines of a serial monitor: ``14:00:00.199 -> Distance: 12.3 cm``, or the same without a time."""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from echocal.observations.fields import shown
from echocal.observations.heading import find_head, is_value
from echocal.observations.numbers import says_no_echo
from echocal.observations.readers.events import Event, ranger_names, rows_of
from echocal.observations.readers.log import Log
from echocal.observations.readers.pairs import Pair, pairs_of
from echocal.observations.readers.stamps import Stamped, stamped
from echocal.observations.units import FORMS, symbol_of

NAME = "lines of a serial monitor"

_NUMBER = re.compile(r"[-+]?\d+(?:[.,]\d+)?")
_LOOK = 100
_NAME = 4  # words that a name has at most
_WIDE = 300  # characters that tell of what kind a line is
_MANY = 10  # lines with values: a name that comes once among them is that of no column

Told = tuple[Stamped, list[Pair]]
"""A line, and the values in it."""


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines have a time and an arrow, or names with values, or values where others have none."""
    look = [stamped(line[:_WIDE]) for line in lines[:_LOOK]]
    if 2 * sum(line.arrow for line in look) > len(look):
        return True
    named = sum(bool(pairs_of(line.rest)) for line in look)
    silent = sum(says_no_echo(line.rest) for line in look)
    bare = sum(_is_bare(line.rest) for line in look)
    noisy = bool(silent) or _is_sentence(look[0].rest)
    if 2 * named > len(look) or (bare and noisy and bare + silent > 0.9 * len(look)):
        return True
    return (
        3 * (named + silent) > len(look) and bool(named) and not any(_delimited(line.rest) for line in look)
    )


def read(lines: Sequence[str], path: str) -> Log:
    """Read the lines; one that says that no echo came is a row with a reason."""
    split = [stamped(line) for line in lines]
    filled = [line for line in split if line.rest]
    named = sum(bool(pairs_of(line.rest)) for line in filled)
    if 2 * named >= len(filled) or (named >= 3 and not any(_delimited(line.rest) for line in filled)):
        return _named(split)
    return _delimited_rests(filled)


def _named(split: Sequence[Stamped]) -> Log:
    log = Log()
    told = _in_one_unit(_without_rare([(line, pairs_of(line.rest)) for line in split], log), log)
    named = [{name for name, _, _ in pairs} for _, pairs in told if pairs]
    ranger = ranger_names(list(dict.fromkeys(name for _, pairs in told for name, _, _ in pairs)), log.units)
    if ranger and all(set(ranger) & own for own in named):
        return _line_by_line(told, log)
    _note_others(told, log)
    return rows_of(_events(told), ranger, log)


def _line_by_line(told: Sequence[Told], log: Log) -> Log:
    """Each line is a row, or a part of one where no name comes again; others are rows without values."""
    records = log.records
    for line, pairs in told:
        values = _event(line, pairs).holds
        if not values:
            if says_no_echo(line.rest) or (records and re.search(r"\w", line.rest)):
                log.lose(line.rest, line.time)
            continue
        if not records or len(records) - 1 in log.corrupt or set(values) & set(records[-1]):
            records.append(dict(line.time))
        records[-1] |= values
    return log


def _events(told: Sequence[Told]) -> list[Event]:
    """Values of the lines, and where blank lines end a row."""
    blocks, ended = _blocks(told), False
    events: list[Event] = []
    for line, pairs in told:
        ended = ended or (blocks and not line.rest)
        if pairs or says_no_echo(line.rest):
            events.append(replace(_event(line, pairs), ends=ended and bool(events)))
            ended = False
    return events


def _blocks(told: Sequence[Told]) -> bool:
    """Whether blank lines are between blocks of several values, most of which have the same names."""
    blocks: list[tuple[str, ...]] = [()]
    for line, pairs in told:
        if not line.rest:
            blocks.append(())
        else:
            blocks[-1] += tuple(name for name, _, _ in pairs)
    filled = Counter(block for block in blocks if block)
    if not filled or len(filled) == filled.total() == 1:
        return False
    usual, count = filled.most_common(1)[0]
    return len(usual) > 1 and len(set(usual)) == len(usual) and 2 * count > filled.total()


def _event(line: Stamped, pairs: Sequence[Pair]) -> Event:
    return Event(line.time, {name: value.replace(",", ".") for name, value, _ in pairs}, line.rest)


def _without_rare(told: Sequence[Told], log: Log) -> list[Told]:
    """Values whose name comes once among many lines belong to a message, or to a line that is damaged.

    A name that never has a number begins a message, as ``ERROR: out of range``.
    """
    numbers = {name for _, pairs in told for name, value, _ in pairs if value != "nan"}
    told = [(line, [pair for pair in pairs if pair[0] in numbers]) for line, pairs in told]
    counts = Counter(name for _, pairs in told for name, _, _ in pairs)
    if sum(bool(pairs) for _, pairs in told) < _MANY:
        return list(told)
    rare = [f"{name}: {value}" for _, pairs in told for name, value, _ in pairs if counts[name] == 1]
    if rare:
        log.notes.append(f"{len(rare)} values whose name comes once are left out, as '{shown(rare[0])}'")
    return [(line, [pair for pair in pairs if counts[pair[0]] > 1]) for line, pairs in told]


def _in_one_unit(told: Sequence[Told], log: Log) -> list[Told]:
    """Values of a name in the unit that it mostly has."""
    units: dict[str, Counter[str]] = {}
    for name, _, unit in (pair for _, pairs in told for pair in pairs):
        if symbol_of(unit):
            units.setdefault(name, Counter())[unit] += 1
    log.units |= {name: own.most_common(1)[0][0] for name, own in units.items()}
    mixed = {name for name, own in units.items() if len(set(map(symbol_of, own))) > 1}
    log.notes += [
        f"'{name}' comes in several units ({', '.join(units[name])}) and is read in {log.units[name]}"
        for name in sorted(mixed)
    ]
    if not mixed:
        return list(told)
    return [
        (line, [(n, _converted(v, u, log.units[n]) if n in mixed else v, u) for n, v, u in pairs])
        for line, pairs in told
    ]


def _converted(value: str, unit: str, wanted: str) -> str:
    """A value in another unit of the same quantity; none where there is no such."""
    own, other = symbol_of(unit), symbol_of(wanted)
    if own == other or not own:
        return value
    form = next((form for form in FORMS if own in form.units and other in form.units), None)
    number = float(value.replace(",", "."))
    return "nan" if form is None else repr(form.units[other].from_si(form.units[own].to_si(number)))


def _note_others(told: Sequence[Told], log: Log) -> None:
    others = [
        line.rest
        for line, pairs in told
        if re.search(r"\w", line.rest) and not (pairs or says_no_echo(line.rest))
    ]
    if others:
        log.notes.append(f"{len(others)} lines have no values and are no rows, first '{shown(others[0])}'")


def _delimited(rest: str) -> bool:
    return any(rest.count(s) for s in ",;\t|") and any(map(is_value, re.split(r"[,;\t|]", rest)))


def _is_sentence(rest: str) -> bool:
    """Whether a line above values is a message, and no name of a column."""
    return rest.endswith((":", ".", "!")) or (
        len(rest.split()) > _NAME and not any(s in rest for s in ",;\t|")
    )


def _is_bare(rest: str) -> bool:
    """Whether a line is one number, or numbers with separators."""
    return bool(rest) and all(_NUMBER.fullmatch(part.strip()) for part in re.split(r"[,;\t|]", rest))


def _delimited_rests(split: Sequence[Stamped]) -> Log:
    """Numbers with separators, or one number a line, behind the times."""
    tells = (n for n, line in enumerate(split) if _delimited(line.rest) or _NUMBER.match(line.rest))
    first = next(tells, 0)
    silent = [n for n in range(first) if says_no_echo(split[n].rest)]
    before = [n for n in range(first) if n not in silent][-1:]
    begin = first if not before or _is_sentence(split[before[0]].rest) else before[0]
    spoken = [n for n in range(begin, len(split)) if not says_no_echo(split[n].rest)]
    head = find_head([split[n].rest for n in spoken], 0, "")
    names, kept = set(spoken[: head.start]), min([begin, *silent])
    rows = [line for n, line in enumerate(split) if n >= kept and n not in names]
    log = Log(units=dict(head.units), notes=[] if not head.nameless else ["the values have no names"])
    for line in rows:
        fields = next(csv.reader([line.rest], delimiter=head.separator, skipinitialspace=True), [])
        if len(fields) == len(head.names) and any(map(is_value, map(_bare, fields))):
            log.records.append({**line.time, **dict(zip(head.names, fields, strict=True))})
        else:
            log.lose(line.rest, line.time)
    return log


def _bare(field: str) -> str:
    return re.sub(r"[^\d.,+-]+$", "", field.strip())
