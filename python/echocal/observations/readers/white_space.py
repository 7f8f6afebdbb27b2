"""Columns with blanks between them."""

import re
from collections.abc import Sequence

from echocal.observations.heading import is_value
from echocal.observations.readers.log import Log
from echocal.observations.units_said import is_unit_row

__all__ = ["NAME", "read", "recognizes"]

NAME = "columns with blanks between them"


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines have the same number of values, two or more, with blanks and no separator between."""
    rows = [line.split() for line in lines[-100:] if not line.startswith("#")]
    if any(s in line for line in lines[-20:] for s in ",;\t|"):
        return False
    good = [row for row in rows if len(row) > 1 and all(map(is_value, row))]
    widths = {len(row) for row in good}
    return 2 * len(good) > len(rows) and len(widths) == 1


def read(lines: Sequence[str], path: str) -> Log:
    """Read the rows; the line above them has the names if it has as many words."""
    filled = [line.strip() for line in lines if line.strip()]
    first = next(n for n, line in enumerate(filled) if _is_row(line))
    width = len(filled[first].split())
    log = Log([])
    names = [f"column {place}" for place in range(1, width + 1)]
    above = [line.lstrip("# ") for line in filled[max(first - 2, 0) : first]]
    for line in reversed(above):
        words = re.split(r"\s{2,}", line) if len(line.split()) != width else line.split()
        if len(words) == width and is_unit_row(words):
            log.units = dict(zip(names, words, strict=True))
        elif len(words) == width:
            log.units = dict(zip(words, log.units.values(), strict=False))
            names = words
            break
    records = []
    for line in filled[first:]:
        if line.startswith("#"):
            continue
        if _is_row(line) and len(line.split()) == width:
            records.append(_joined(names, line.split()))
        else:
            log.corrupt[len(records)] = line
            records.append({})
    log.records = records
    return log


def _joined(names: list[str], values: list[str]) -> dict[str, str]:
    return dict(zip(names, values, strict=True))


def _is_row(line: str) -> bool:
    words = line.split()
    return len(words) > 1 and sum(map(is_value, words)) * 2 > len(words) and is_value(words[-1])
