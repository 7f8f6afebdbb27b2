"""What columns without a telling name may hold: a guess if their values leave one answer, else a question."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.keywords import command_line
from echocal.observations.alike import echo_speed, line_between
from echocal.observations.units import NAMES
from echocal.observations.vocabulary import TOKEN

_RANGES: dict[str, tuple[tuple[str, float, float], ...]] = {
    "reading": (("m", 0.02, 10.0), ("cm", 10.0, 600.0), ("mm", 600.0, 12000.0)),
    "distance": (("m", 0.02, 10.0), ("cm", 10.0, 600.0), ("mm", 600.0, 12000.0)),
    "echo": (("s", 1e-4, 0.06), ("ms", 0.1, 60.0), ("us", 100.0, 60000.0)),
    "temperature": (("C", -40.0, 48.0), ("F", 48.0, 120.0), ("K", 230.0, 330.0)),
    "humidity": (("percent", 1.5, 100.0),),
    "echo_quality": (("", 0.0, 1000.0),),
    "pressure": (("kPa", 60.0, 110.0), ("hPa", 600.0, 1100.0), ("Pa", 60000.0, 110000.0)),
}
"""Usual medians of a column by its unit."""

_BATTERIES = (1.5, 15.5)  # V: two flat cells to a lead battery that is charged
_CHARGE = 1.6  # a full battery over a flat one, of any kind
_HPA = (850.0, 1090.0)
_TOGETHER = 0.9  # correlation of an echo time with its distance
_FEWEST = 8  # rows that show a trend
AGREES = "its values agree with"
"""Begin of the reason of a column that reads what the reference distance says."""
_NEAR, _STEP = 0.1, 0.01  # of the distance, and m: any speed that firmware uses, and whole centimeters
_MOST = 0.9  # of the rows: single wild ones aside
_ELSEWHERE = {
    "adc", "akku", "bat", "batt", "battery", "code", "count", "counter", "counts", "flag", "heap", "id",
    "index", "ma", "mah", "mode", "no", "nr", "pin", "raw", "rssi", "seq", "sequence", "snr", "soc",
    "status", "ticks", "uptime", "vbat", "vbatt", "vcc", "vdd", "volt", "voltage", "volts",
}  # fmt: skip
"""Words of a name with which a column is neither distance nor temperature."""

_QUESTIONS = {
    "volts": "a voltage in V",
    "percent": "a percentage",
    "temperature": "a temperature in degC",
    "pressure": "a pressure in hPa",
}


@dataclass(frozen=True)
class Guess:
    """What a column may hold; a question has no request."""

    request: str
    reason: str


def usual(role: str, numbers: Column) -> str:
    """Unit in which the median is usual; of lengths with decimals or without."""
    finite = numbers[np.isfinite(numbers)]
    if not len(finite):
        return ""
    middle = float(np.median(finite))
    return next((unit for unit, low, high in _RANGES.get(role, ()) if low <= middle < high), "")


def guesses(
    columns: Mapping[str, Column],
    units: Mapping[str, str],
    held: Collection[str],
    reference: tuple[str, Column] | None = None,
) -> dict[str, Guess]:
    """A guess or a question for columns that nothing claims.

    Parameters
    ----------
    columns : mapping of str to ndarray
        Their values, in their order.
    units : mapping of str to str
        Symbols of the units that the log gives.
    held : collection of str
        Quantities that other columns hold.
    reference : (str, ndarray), optional
        The column that holds the reference distance by its name, and its values [m].

    Examples
    --------
    >>> import numpy as np
    >>> hours = np.arange(12.0)
    >>> log = {"b": 4.12 - 0.01 * hours, "d": 190 + 10 * np.sin(hours), "p": 91.0 - 0.1 * hours}
    >>> for name, guess in guesses(log, {}, ()).items():
    ...     print(name, guess.request or "?", guess.reason, sep=": ")
    d: reading_cm: values as usual for a distance in cm
    b: ?: may be a temperature in degC or a voltage in V: say which
    """
    free = {n: v for n, v in columns.items() if not _is_elsewhere(n)}
    kinds = {name: _kinds(values, units.get(name, "")) for name, values in free.items()}
    found = _pair(free, units) if not {"reading", "echo_time"} & set(held) else {}
    if not found and reference is not None and not {"reading", "echo_time"} & set(held):
        found = _beside(free, units, *reference)
    settled = bool(found or {"reading", "echo_time"} & set(held))
    temperature = "" if "temperature" in held else _temperature(kinds, free, found, settled=settled)
    if not settled and (name := _reading(kinds, temperature)):
        unit = units.get(name) or usual("reading", free[name])
        found[name] = Guess(f"reading_{unit}", f"values as usual for a distance in {unit}")
    if temperature:
        unit = units.get(temperature) or "C"
        found[temperature] = Guess(f"temperature_{unit}", f"values as usual for a temperature in deg{unit}")
    has = {guess.request.partition("_")[0] for guess in found.values()} | set(held)
    wanted = {"temperature"} - has | (set() if has & {"reading", "echo", "echo_time"} else {"reading"})
    for name, own in kinds.items():
        question = _question(own, free[name], wanted)
        if name not in found and question:
            found[name] = Guess("", question)
    return found


def _kinds(values: Column, unit: str) -> set[str]:
    """What a column may be by its values alone."""
    finite = values[np.isfinite(values)]
    if not len(finite) or (_runs_on(finite) and not unit):
        return set()
    if unit:
        return {kind for kind in ("reading", "temperature") if f"{kind}_{unit}" in NAMES}
    low, high = np.quantile(finite, [0.02, 0.98])
    found = {"reading"} if usual("reading", values) else set()
    found |= {"temperature"} if usual("temperature", values) == "C" else set()
    found |= {"volts"} if _BATTERIES[0] <= low and high <= min(_BATTERIES[1], _CHARGE * low) else set()
    found |= {"percent"} if low >= 0.0 and high <= 100.0 and high > _BATTERIES[1] else set()
    found |= {"pressure"} if _HPA[0] <= low and high <= _HPA[1] else set()
    return found


def _pair(columns: Mapping[str, Column], units: Mapping[str, str]) -> dict[str, Guess]:
    """A time and a length that agree: echo and distance."""
    for time, seconds in columns.items():
        for unit in [units[time]] if units.get(time) else ["us", "ms"]:
            echo = NAMES.get(f"echo_{unit}")
            if echo is None or usual("echo", seconds) == "" or _runs_on(seconds):
                continue
            t = echo[0].units[unit].to_si(seconds)
            for length, values in columns.items():
                for own in [units[length]] if units.get(length) else ["cm", "mm", "m", "inch"]:
                    form = NAMES.get(f"reading_{own}")
                    if length == time or form is None:
                        continue
                    d = np.asarray(form[0].units[own].to_si(values))
                    if _rise_together(d, np.asarray(t)) and (speed := echo_speed(d, np.asarray(t))):
                        why = f"agrees with '{{}}' as a distance with its echo ({speed:.0f} m/s)"
                        return {
                            time: Guess(f"echo_{unit}", why.format(length)),
                            length: Guess(f"reading_{own}", why.format(time)),
                        }
    return {}


def _beside(
    columns: Mapping[str, Column], units: Mapping[str, str], name: str, reference: Column
) -> dict[str, Guess]:
    """The first column that reads what the reference says; its reason names the others."""
    found = {}
    for column, values in columns.items():
        for role in ("reading", "echo"):
            unit = units.get(column) or usual(role, values)
            form = NAMES.get(f"{role}_{unit}")
            if form is None:
                continue
            own = np.asarray(form[0].units[unit].to_si(values))
            if not _rise_together(own, reference):
                continue
            if role == "echo":
                agrees = bool(echo_speed(reference, own))
            else:
                known = np.isfinite(own) & np.isfinite(reference)
                near = np.abs(own - reference)[known] <= _NEAR * reference[known] + _STEP
                agrees = float(near.mean()) >= _MOST
            if agrees:
                found[column] = f"{role}_{unit}"
    if not found:
        return {}
    first = next(iter(found))
    others = "".join(f", and so '{other}'" for other in found if other != first)
    each = f": for each, {command_line('diagnose', 'LOG', by=','.join(found))}" if others else ""
    return {first: Guess(found[first], f"{AGREES} '{name}'{others}{each}")}


def _rise_together(length: Column, time: Column) -> bool:
    """Whether two columns are proportional: two that hardly change agree by chance."""
    if line_between(length, time) is not None:
        return True
    known = np.isfinite(length) & np.isfinite(time)
    if known.sum() < _FEWEST or not np.ptp(length[known]) or not np.ptp(time[known]):
        return False
    return bool(np.corrcoef(length[known], time[known])[0, 1] > _TOGETHER)


def _temperature(
    kinds: Mapping[str, set[str]], columns: Mapping[str, Column], found: Collection[str], *, settled: bool
) -> str:
    """The column that may be a temperature, but no voltage and no charge that runs down; empty for none.

    Where no other column can be the distance, it may as well be that.
    """
    likely = [
        name
        for name, own in kinds.items()
        if "temperature" in own and "volts" not in own and name not in found and not _runs_down(columns[name])
    ]
    distance = any("reading" in own and "temperature" not in own for own in kinds.values())
    sure = [name for name in likely if settled or distance or kinds[name] == {"temperature"}]
    return sure[0] if sure else ""


def _reading(kinds: Mapping[str, set[str]], temperature: str) -> str:
    """The column that can only be a distance, else the only one that may be; empty where several are left."""
    may = [name for name, own in kinds.items() if "reading" in own and name != temperature]
    clean = [name for name in may if kinds[name] == {"reading"}] or may
    return clean[0] if len(clean) == 1 else ""


def _question(kinds: set[str], values: Column, wanted: Collection[str]) -> str:
    """What to ask about a column, if an answer is wanted."""
    if not kinds & set(wanted):
        return ""
    unit = usual("reading", values)
    asked = [f"a distance in {unit}"] if "reading" in kinds and "reading" in wanted else []
    asked += [words for kind, words in reversed(_QUESTIONS.items()) if kind in kinds]
    return f"may be {' or '.join(asked)}: say which" if len(asked) > 1 else ""


def _runs_on(values: Column) -> bool:
    """Whether a column counts rows or the time: it rises by steps that are nearly even."""
    steps = np.diff(values[np.isfinite(values)])
    if len(steps) < 2 or not (steps > 0).all():
        return False
    low, middle, high = np.quantile(steps, [0.25, 0.5, 0.75])
    return bool(high - low <= 0.5 * middle)


def _runs_down(values: Column) -> bool:
    """Whether values only fall, or only rise, as a charge does and the air of no day."""
    steps = np.diff(values[np.isfinite(values)])
    return bool(len(steps) >= _FEWEST and ((steps <= 0).all() or (steps >= 0).all()))


def _is_elsewhere(name: str) -> bool:
    words = {word.lower() for word in TOKEN.findall(name)}
    return bool(words & _ELSEWHERE) and not re.fullmatch(r"column \d+", name)
