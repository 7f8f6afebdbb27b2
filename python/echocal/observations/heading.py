"""Where the rows of a delimited text begin, and what the lines above say."""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.layout import Head, Layout
from echocal.observations.limits import refuse_names
from echocal.observations.scanner import Scanner
from echocal.observations.units import is_unit_row

SEPARATORS = ",;\t|"
FIRST = 200  # lines that are looked at for the header
_NUMBER = re.compile(r"[-+]?(?:\d[\d.,']*|[.,]\d+)(?:[eE][-+]?\d+)?")
_TIME = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}(?:[T ].*)?|\d{1,2}:\d{2}(?::\d{2}.*)?(?: ?[AP]M)?")
_SEP_LINE = re.compile(r'"?sep=([^"])"?', re.IGNORECASE)
_COMMA = re.compile(r"[-+]?\d*,\d+")
_POINT = re.compile(r"[-+]?\d*\.\d+(?:[eE][-+]?\d+)?")
_LOOK = 20  # lines that show how many fields a row has
_NUL = "\0"


def is_value(text: str) -> bool:
    """Whether a field is a number or a time, as rows have them and headers do not."""
    plain = text.strip().strip('"').strip()
    return bool(_NUMBER.fullmatch(plain) or _TIME.fullmatch(plain))


def fields_of(line: str, separator: str) -> list[str]:
    """Fields of a line."""
    try:
        return next(csv.reader([line.replace(_NUL, "")], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        raise too_long(line) from None


def too_long(line: str) -> DataError:
    """An error for a line that is no row of a table."""
    message = (
        f"a line of {len(line):,} characters ('{line[:40]}...') has a field of more than "
        f"{csv.field_size_limit():,} characters, which no table of measurements has; remove it"
    )
    return DataError(message)


def head_in(lines: list[str], layout: Layout, path: str) -> Head:
    """Find the header in the first lines below those that are skipped.

    Raises `DataError` if there is none.
    """
    skip, before, lines = _first_lines(lines, layout.skip_lines, path)
    head = find_head(lines, skip, before)
    if layout.decimal is not None:
        head = replace(head, decimal=layout.decimal)
    first = lines[0]
    if (
        not head.nameless
        and head.separator not in first
        and head.above == skip + 1
        and any(s in "".join(lines[1:2]) for s in SEPARATORS)
    ):
        raise DataError(
            f"{path}: line {skip + 1} ('{first[:40]}') is one field and the next line has more; "
            f"if it is a logger's own line, skip it: {keyword('skip_lines', skip + 1)}"
        )
    if not head.nameless and head.above > skip:
        header = lines[head.above - skip - 1]
        Scanner(path, replace(head, comments=False, repeated=frozenset())).refuse_open(header, head.above)
    return head


def _first_lines(lines: list[str], skip: int, path: str) -> tuple[int, str, list[str]]:
    """Lines above the first that is no comment, the last of those, and that line with some after it."""
    before = ""
    while lines and (lines[0].startswith("#") or not lines[0].strip()):
        skip += 1
        before = lines.pop(0).strip()
    if not lines:
        raise DataError(f"{path} has no header" + (f" after {skip} skipped lines" if skip else ""))
    if "\0" in lines[0]:
        wide = {0: "utf-16-be", 1: "utf-16-le"}.get(lines[0].find("\0"), "utf-16")
        raise DataError(
            f"{path} is not text: its first line has NUL bytes; a binary file, or name the encoding: "
            f"{keyword('encoding', wide)}"
        )
    return skip, before, [line.rstrip("\r\n") for line in lines]


def find_head(lines: Sequence[str], skipped: int, before: str) -> Head:
    """Find the header in the first lines of a text, without their ends, the first not blank and no comment.

    So many lines above them are skipped, and `before` is the comment right above them, or empty.
    """
    given = _SEP_LINE.fullmatch(lines[0].strip())
    if given and not given[1].isascii():
        raise DataError(f"'{lines[0].strip()}' names a separator that is no sign of ASCII; write another one")
    if given and len(lines) > 1:
        return _table(lines, 1, skipped, given[1])
    if lines[0].startswith(('"TOA5"', "TOA5,", '"TOACI1"', "TOACI1,")) and len(lines) > 1:
        long = "TOA5" in lines[0][:8]
        kind = "TOA5 of a Campbell logger" if long else "TOACI1"
        return _table(lines, 1, skipped, ",", 2 if long else 0, kind)
    ends = [n for n, line in enumerate(lines) if line.startswith("***End_of_Header***")]
    if ends:
        return _labview(lines, ends[-1] + 1, skipped)
    return _plain_head(lines, skipped, before)


def _plain_head(lines: Sequence[str], skipped: int, before: str) -> Head:
    """Header of a text that says nothing of its kind."""
    separator = max(SEPARATORS, key=lines[0].count)
    own = len(fields_of(lines[0], separator))
    usual = _usual(lines[1:], separator)
    names = fields_of(lines[0], separator)
    if _all_values(lines[0], separator) or _rows_alike(lines, separator):
        return _nameless(lines, skipped, separator, before)
    if len(set(names)) < len(names) and (place := _last_names(lines, separator)):
        return _table(lines, place, skipped, separator)
    if own < usual or (own == 1 and any(s in line for line in lines[1:3] for s in SEPARATORS)):
        place = _search(lines)
        if place is not None:
            return _table(lines, place, skipped, max(SEPARATORS, key=lines[place].count))
        for place in range(1, min(len(lines), _LOOK) if own == 1 else 0):
            own_separator = max(SEPARATORS, key=lines[place].count)
            if len(fields_of(lines[place], own_separator)) > 1 and _all_values(lines[place], own_separator):
                return _nameless(lines[place:], skipped + place, own_separator, "")
    return _table(lines, 0, skipped, separator)


def _labview(lines: Sequence[str], begin: int, skipped: int) -> Head:
    while begin < len(lines) - 1 and not lines[begin].strip():
        begin += 1
    head = _table(lines, begin, skipped, "\t", kind="LabVIEW measurement")
    units = next((line for line in lines if line.startswith("Y_Unit_Label")), "")
    given = fields_of(units, "\t")[1:] if units else []
    names = head.names[1:]
    found = {name: unit for name, unit in zip(names, given, strict=False) if unit.strip()}
    return Head(**{**vars(head), "units": found})


def _table(
    lines: Sequence[str], place: int, skipped: int, separator: str, below: int | None = None, kind: str = ""
) -> Head:
    names = names_of(fields_of(lines[place], separator))
    rest = lines[place + 1 :]
    if below is None:
        below = 0
        while below < min(2, len(rest)) and _says_units(rest[below], separator, names):
            below += 1
    units: dict[str, str] = {}
    for line in rest[:below]:
        for name, unit in zip(names, fields_of(line, separator), strict=False):
            units.setdefault(name, unit.strip().strip("()[]"))
    header = frozenset(line for line in lines[: place + 1 + below] if line.strip())
    rows = [line for line in rest[below:] if line.strip()]
    return Head(
        above=skipped + place + 1,
        separator=separator,
        names=names,
        below=below,
        units={name: unit for name, unit in units.items() if unit},
        decimal=decimal_of(rows, separator) or ".",
        comments=not (rows and rows[0].startswith("#")),
        repeated=header,
        kind=kind or "delimited text",
    )


def _nameless(lines: Sequence[str], skipped: int, separator: str, before: str) -> Head:
    """Rows from the first line on; the comment above them may have the names."""
    width = len(fields_of(lines[0], separator))
    names = names_of(fields_of(before.lstrip("#%/ "), separator)) if before else []
    if len(names) == width and not any(map(is_value, names)):
        named = _table([before, *lines], 0, skipped - 1, separator)
        return Head(**{**vars(named), "names": names})
    names = [f"column {place}" for place in range(1, width + 1)]
    decimal = decimal_of(lines, separator) or "."
    return Head(skipped, separator, names, decimal=decimal, kind="text without a header", nameless=True)


def _search(lines: Sequence[str]) -> int | None:
    """Place of the first line of names, below lines of a logger's own."""
    for place in range(1, len(lines) - 1):
        separator = max(SEPARATORS, key=lines[place].count)
        names = fields_of(lines[place], separator)
        rows = [line for line in lines[place + 1 : place + 1 + _LOOK] if line.strip()]
        below = 0
        while below < min(2, len(rows) - 1) and _says_units(rows[below], separator, names):
            below += 1
        if not rows or len(names) < 2 or any(map(is_value, names)):
            continue
        same = sum(len(fields_of(line, separator)) == len(names) for line in rows[below:])
        if 2 * same > len(rows[below:]) and any(map(is_value, fields_of(rows[below], separator))):
            return place
    return None


def _rows_alike(lines: Sequence[str], separator: str) -> bool:
    """Whether the first lines have values and texts in the same places: none of them has names."""
    kinds = [[is_value(field) for field in fields_of(line, separator)] for line in lines[:4]]
    return len(kinds) > 2 and len(kinds[0]) > 1 and any(kinds[0]) and all(own == kinds[0] for own in kinds)


def _last_names(lines: Sequence[str], separator: str) -> int | None:
    """Place of the last line without values above the rows, where several lines have names."""
    for place in range(1, min(len(lines), 6)):
        fields = fields_of(lines[place], separator)
        if any(map(is_value, fields)):
            return place - 1 if place > 1 else None
    return None


def _says_units(line: str, separator: str, names: Sequence[str]) -> bool:
    if line.count('"') % 2:  # a field goes on in the next line: a row
        return False
    fields = fields_of(line, separator)
    return len(fields) <= len(names) and not any(map(is_value, fields)) and is_unit_row(fields)


def _all_values(line: str, separator: str) -> bool:
    fields = [field for field in fields_of(line, separator) if field.strip()]
    return bool(fields) and all(map(is_value, fields))


def _usual(lines: Sequence[str], separator: str) -> int:
    counts = Counter(len(fields_of(line, separator)) for line in lines[:_LOOK] if line.strip())
    return counts.most_common(1)[0][0] if counts else 0


def decimal_of(rows: Sequence[str], separator: str) -> str:
    """A comma, where fields are numbers with one and none has a point; empty where none has either."""
    if separator == ",":
        return "."
    fields = [field.strip() for line in rows for field in fields_of(line, separator)]
    if any(map(_POINT.fullmatch, fields)):
        return "."
    return "," if any(map(_COMMA.fullmatch, fields)) else ""


def names_of(fields: Sequence[str]) -> list[str]:
    """Names of columns; one without a name has one by its place."""
    refuse_names(fields, "the header")
    names = [field.strip() or f"Unnamed {position + 1}" for position, field in enumerate(fields)]
    return [names[0].removeprefix("% "), *names[1:]] if names else names
