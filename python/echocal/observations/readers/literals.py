"""Tuples, lists and dicts as Python and MicroPython print them: ``(1234, 21.5)``, ``{'d': 12.3}``."""

import ast
import re
from collections.abc import Mapping, Sequence
from typing import Any

from echocal.observations.numbers import says_no_echo
from echocal.observations.readers.log import Log

NAME = "printed tuples"

_BEGIN = re.compile(r"\s*(?P<time>\d{1,2}:\d\d:\d\d(?:\.\d+)?\s*(?:->)?\s*)?(?P<rest>[\[({].*[\])}])\s*,?\s*")
_LOOK = 50


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are a tuple, a list or a dict."""
    look = lines[:_LOOK]
    good = sum(_value(line)[1] is not None for line in look)
    return good > 0 and 2 * (good + sum(map(says_no_echo, look))) > len(look)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the lines; values without a name are called after their place."""
    log = Log()
    for line in filter(str.strip, lines):
        time, value = _value(line)
        stamp = {"time": time} if time else {}
        if value is not None:
            log.records.append({**stamp, **value})
        elif log.records or says_no_echo(line):
            log.lose(line, stamp)
    return log


def _value(line: str) -> tuple[str, dict[str, Any] | None]:
    match = _BEGIN.fullmatch(line)
    if match is None:
        return "", None
    try:
        value = ast.literal_eval(re.sub(r"\bnan\b", "None", match["rest"]))
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return "", None
    time = (match["time"] or "").replace("->", "").strip()
    if isinstance(value, Mapping):
        return time, {str(name): own for name, own in value.items()}
    if isinstance(value, tuple | list) and value:
        return time, _placed(list(value))
    return "", None


def _placed(values: list[Any]) -> dict[str, Any]:
    if all(isinstance(own, tuple | list) and len(own) == 2 and isinstance(own[0], str) for own in values):
        return {own[0]: own[1] for own in values}
    return {f"column {place}": own for place, own in enumerate(values, 1)}
