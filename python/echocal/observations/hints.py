"""What a column holds by its name and its unit, where both leave one reading only."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.found import Found
from echocal.observations.names import IGNORE, by_name, by_request, is_level_name
from echocal.observations.units import NAMES, split_unit, symbol_of
from echocal.observations.vocabulary import (
    CLOCK_UNITS,
    CLOCKS,
    COUNTERS,
    ELAPSED,
    LETTERS,
    NEVER,
    NO_CLOCK,
    NOT,
    OF_QUALITY,
    QUALITY,
    SINCE,
    STATISTIC,
    TIMES,
    TOKEN,
    WORDS,
)

_SHORT = 4  # letters of a word in a compound
_KNOWN = frozenset().union(*(words for _, words in WORDS.values()), *NOT.values())


@dataclass(frozen=True)
class Hint:
    """What a foreign name and its unit say."""

    name: str  # the column in echocal's way: ``reading_cm``
    sure: bool = True  # whether this cannot be another quantity


def hint(column: str, unit: str = "") -> Hint | None:
    """What a column may hold by its name, and the unit beside it; None where they say nothing, or too little.

    Examples
    --------
    >>> hint("Distance (cm)"), hint("AirTC_Avg", "Deg C"), hint("level [m]")
    (Hint(name='reading_cm', sure=False), Hint(name='temperature_C', sure=True), None)
    >>> hint("Quality number"), hint("quality_flag"), hint("Air quality")
    (Hint(name='echo_quality', sure=True), None, None)
    """
    if is_level_name(column):
        return None
    if column.strip().lower() in TIMES or column.strip().lower().startswith(("date time,", "date-time")):
        return Hint("time")
    if column.strip().lower() in COUNTERS:
        return Hint(COUNTERS[column.strip().lower()])
    if role := role_of_unit(column):
        # a length may be the reference, a time a clock, a percentage a charge; one letter, or "in", says too
        # little
        unclear = role in {"echo", "humidity"} or len(column.strip()) < 2 or column.strip().lower() == "in"
        return None if unclear else Hint(f"{role}_{symbol_of(column)}", role != "reading")
    words, own = split_unit(STATISTIC.sub("", column))
    symbol = symbol_of(unit) or own
    if not symbol:
        return Hint("echo_quality") if _of_echo(words) else None
    listed = _listed(words)
    tokens = _tokens(words) | {"".join(pair) for pair in pairwise(listed)}
    if tokens & NEVER:
        return None
    since = SINCE - {"time", "zeit"} if symbol == "us" else SINCE  # a time in us may be that of the echo
    if symbol in CLOCK_UNITS and tokens & since and not tokens & NO_CLOCK:
        return Hint(f"time_{symbol}")
    for role, (units, known) in WORDS.items():
        if symbol in units and tokens & known and not tokens & NOT.get(role, set()):
            name = f"{role}_{symbol}" if f"{role}_{symbol}" in NAMES else role
            return Hint(name, role != "reading" or not tokens & {"distance", "dist", "abstand"})
    return None


def of_ranger(column: str, unit: str = "") -> str:
    """What a column holds that somebody calls a ranger: by its name, else by its unit; empty without one.

    Examples
    --------
    >>> of_ranger("left_cm"), of_ranger("left_us"), of_ranger("sonar (mm)"), of_ranger("left")
    ('reading_cm', 'echo_us', 'reading_mm', '')
    """
    said = hint(column, unit)
    symbol = symbol_of(unit) or split_unit(column)[1]
    units = (f"{role}_{symbol}" for role in ("reading", "echo") if symbol in WORDS[role][0])
    return said.name if said is not None else next(units, "")


def role_of_unit(column: str) -> str:
    """Which quantity a column holds that is called by its unit alone; empty for any other name.

    Examples
    --------
    >>> role_of_unit("inches"), role_of_unit("degF"), role_of_unit("us"), role_of_unit("Distance (cm)")
    ('reading', 'temperature', 'echo', '')
    """
    symbol = symbol_of(column)
    roles = ("reading", "echo", "temperature", "humidity", "pressure")
    return next((role for role in roles if symbol and symbol in WORDS[role][0]), "")


def is_time_name(column: str) -> bool:
    """Whether a column is called as columns of times are."""
    tokens = {token.lower() for token in TOKEN.findall(column)} | {column.strip().lower()}
    never = {"flight", "echo", "pulse", "tof", "diff", "transit", "delta", "interval", "response", "duration"}
    return not tokens & never and bool(tokens & CLOCKS or column.strip().lower() in TIMES)


def completed(
    columns: Collection[str],
    requests: Mapping[str, str],
    found: Found | None = None,
    doubtful: Mapping[str, str] | None = None,
) -> tuple[dict[str, str], list[str]]:
    """Requests, with those that names and units add, and a sentence on these.

    Columns in `doubtful` are not used for a quantity that is not needed, for the reason that stands there.
    What echocal's own names and the requests hold stays as it is; where two columns may hold the same, none
    is taken.
    """
    beside = found or Found()
    requests = {**{c: r for c, r in beside.requests.items() if c in columns}, **requests}
    held = _held(columns, requests)
    notes: list[str] = []
    hints: dict[str, list[tuple[str, Hint]]] = {}
    for column in columns:
        unit = beside.units.get(column, "")
        if column in requests or _is_ours(column, unit):
            continue
        said = hint(column, unit)
        why = (doubtful or {}).get(column)
        if said and why and NAMES[said.name][0].quantity not in {"echo_time", "reading"}:
            use = f" and is not used; to use it: {keyword('columns', {column: said.name})}"
            notes.append(f"'{column}' {why}{'' if said.name == 'time' else use}")
        elif said:
            hints.setdefault(NAMES[said.name][0].quantity, []).append((column, said))
    _drop_unsure(hints, held, notes)
    taken: dict[str, str] = {}
    for quantity, listed in hints.items():
        if quantity in held:
            continue
        if len(listed) > 1:
            notes.append(_several(listed))
            continue
        (column, said), *_ = listed
        taken[column] = said.name
    if taken:
        listed_ = ", ".join(f"'{column}' as {name}" for column, name in taken.items())
        first = next(iter(taken))
        notes.insert(
            0,
            f"read by name and unit: {listed_}; if one is something else: "
            f"{keyword('columns', {first: 'extra'})}",
        )
    return {**taken, **requests}, notes


def _drop_unsure(found: dict[str, list[tuple[str, Hint]]], held: set[str], notes: list[str]) -> None:
    """Leave out a distance that, beside an echo time or a reading, may as well be the reference."""
    readings = found.get("reading", [])
    unsure = [(column, said) for column, said in readings if not said.sure]
    if not unsure or (
        len(readings) == 1 and not {"echo_time", "reading"} & (held | set(found) - {"reading"})
    ):
        return
    if len(unsure) == len(readings) and not {"echo_time", "reading"} & (held | set(found) - {"reading"}):
        return  # several distances and nothing else: `_several` asks
    for column, said in unsure:
        reference = said.name.replace("reading", "distance")
        given = ", or ".join(keyword("columns", {column: name}) for name in (reference, said.name))
        notes.append(f"'{column}' is not used, it may be the reference or a reading; to use it: {given}")
    found["reading"] = [pair for pair in readings if pair[1].sure]
    if not found["reading"]:
        del found["reading"]


def _several(listed: list[tuple[str, Hint]]) -> str:
    names = " and ".join(f"'{column}'" for column, _ in listed)
    column, said = listed[0]
    way = keyword("columns", {column: said.name})
    each = ""
    if NAMES[said.name][0].quantity in {"reading", "echo_time"}:
        each = f"; if each is a ranger: {keyword('by', ','.join(column for column, _ in listed))}"
    return f"{names} may both hold {said.name}, and neither is used; say which: {way}{each}"


def _tokens(words: str) -> set[str]:
    """Words of a name; a single letter is one where it is the first."""
    first, *rest = [*_listed(words), ""]
    found = {first, *(word for word in rest if word not in LETTERS)}
    return found | {part for word in found for part in _parts(word)}


@cache
def _parts(word: str) -> tuple[str, ...]:
    """Both words of a compound, as "sollabstand" and "wassertemperatur" are; nothing of another word."""
    cuts = range(_SHORT, len(word) - _SHORT + 1)
    both = ((word[:cut], word[cut:]) for cut in cuts)
    return () if word in _KNOWN else next((own for own in both if _KNOWN.issuperset(own)), ())


def _of_echo(words: str) -> bool:
    """Whether a name is that of a quality number of an echo, and of nothing else."""
    tokens = set(_listed(words))
    return bool(tokens & QUALITY) and tokens <= QUALITY | OF_QUALITY


def _listed(words: str) -> list[str]:
    return [token.lower() for token in TOKEN.findall(words)]


def _is_ours(column: str, unit: str) -> bool:
    """Whether a name is one of echocal's; one that lacks its unit is none where the log gives the unit."""
    try:
        return by_name(column) is not None
    except DataError:
        return not symbol_of(unit)


def _held(columns: Collection[str], requests: Mapping[str, str]) -> set[str]:
    """Quantities that echocal's own names and the requests hold."""
    held = set()
    for column in columns:
        request = requests.get(column)
        if request is not None and request.strip() == IGNORE:
            continue
        try:
            found = by_name(column) if request is None else by_request(column, request)
        except (DataError, ValueError):
            continue
        if found is not None and not found[0].several:
            held.add(found[0].quantity)
    return held


def role_of(column: str) -> str:
    """Which quantity a name without a unit speaks of; empty for none.

    Examples
    --------
    >>> role_of("distance"), role_of("Temp"), role_of("battery")
    ('reading', 'temperature', '')
    >>> role_of("Measured Time Diff"), role_of("signal quality"), role_of("Air quality")
    ('echo', 'echo_quality', '')
    """
    words, _ = split_unit(STATISTIC.sub("", column))
    tokens = set() if is_level_name(column) else _tokens(words)
    if tokens & {"time", "zeit"} and tokens & ELAPSED:
        return "echo"
    if tokens & NEVER:
        return ""
    if tokens & QUALITY:
        return "" if tokens & {"air", "water"} else "echo_quality"
    roles = (
        role for role, (_, known) in WORDS.items() if tokens & known and not tokens & NOT.get(role, set())
    )
    return next(roles, "")
