"""Columns with blanks between them."""

import re
from collections.abc import Sequence

from echocal.observations.heading import is_value
from echocal.observations.readers.log import Log
from echocal.observations.units import is_unit_row

NAME = "columns with blanks between them"


_WORD = re.compile(r'"([^"]*)"|(\S+)')


def words_of(line: str) -> list[str]:
    """Words of a line; those in quotation marks may have blanks."""
    return [quoted or bare for quoted, bare in _WORD.findall(line)]


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines have the same number of values, two or more, with only blanks between."""
    rows = [words_of(line) for line in lines[-100:] if not line.startswith("#")]
    if any(s in line for line in lines[-20:] for s in ",;\t|"):
        return False
    good = [row for row in rows if len(row) > 1 and all(map(is_value, row))]
    widths = {len(row) for row in good}
    return 2 * len(good) > len(rows) and len(widths) == 1


def read(lines: Sequence[str], path: str) -> Log:
    """Read the rows; the line above them has the names if it has as many words."""
    filled = [line.strip() for line in lines if line.strip()]
    first = next(n for n, line in enumerate(filled) if _is_row(line))
    width = len(words_of(filled[first]))
    log = Log()
    names = [f"column {place}" for place in range(1, width + 1)]
    above = [line.lstrip("# ") for line in filled[max(first - 2, 0) : first]]
    for line in reversed(above):
        words = words_of(line)
        if len(words) not in {width, width - 1}:
            words = re.split(r"\s{2,}", line)
        if len(words) == width - 1 and not any(map(is_value, words)):
            names = ["row", *words]  # as R writes the numbers of rows
            break
        if len(words) == width and is_unit_row(words):
            log.units = dict(zip(names, words, strict=True))
        elif len(words) == width:
            log.units = dict(zip(words, log.units.values(), strict=False))
            names = words
            break
    for line in filled[first:]:
        if line.startswith("#"):
            continue
        if _is_row(line) and len(words_of(line)) == width:
            log.records.append(dict(zip(names, words_of(line), strict=True)))
        else:
            log.lose(line)
    return log


def _is_row(line: str) -> bool:
    words = words_of(line)
    return len(words) > 1 and sum(map(is_value, words)) * 2 > len(words) and is_value(words[-1])
