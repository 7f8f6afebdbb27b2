"""From a column's name, or what the user says about it, to a quantity and its unit."""

import re
from dataclasses import replace

from echocal.errors import DataError, UsageError, among
from echocal.keywords import command_line, keyword
from echocal.observations.units import FORMS, NAMES, THERMOMETER, UNIT_WORDS, symbol_of
from echocal.quantities import Form

EXTRA = "extra"
BELOW = " below "
"""Between a level and the height of the sensor above its zero: ``level_cm below 2.6 m``."""
INSPECT = (
    f"{command_line('inspect', 'LOG', '-o', 'log.toml')} proposes all columns, "
    f"{command_line('diagnose', 'LOG', options='log.toml')} takes them"
)
IGNORE = "ignore"

_ROLES = sorted((form.role for form in FORMS), key=len, reverse=True)
_FORM_BY_ROLE = {form.role: form for form in FORMS}
_FORM_BY_WORDS = {words: form for form in FORMS for words in (*form.words, form.role.replace("_", " "))}
_FURTHER = re.compile(rf"(?i)temperature_.+_({'|'.join(THERMOMETER.units)})")
_PHRASE = re.compile(r"(?P<words>.+?)(?:\s+in\s+(?P<unit>.+)|\s*[\[(](?P<bracket>.*)[\])])?")


def by_name(column: str) -> tuple[Form, str] | None:
    """Form and unit of a column that is named in echocal's way, None for any other name.

    Raises `DataError` if the name begins like one of echocal's and its unit is missing or unknown.
    """
    found = _exact(column)
    if found and found[0].level:
        return None  # of what, and below which height, only its user can say
    if found and (found[1] or column == found[0].role):
        return found  # a bare name in another case ("Time") is somebody's own
    if further := _FURTHER.fullmatch(column):
        return THERMOMETER, further[1].upper()
    role = next((role for role in _ROLES if column == role or column.startswith(f"{role}_")), None)
    if role is None:
        return None
    form, unit = _FORM_BY_ROLE[role], column[len(role) + 1 :]
    weak = form.label or form.several or form.stand_in or form.level  # asks for no unit
    if weak or "_" in unit:  # a longer name is somebody's own: wind_direction_deg
        return None
    what = f"unknown unit '{unit}'" if unit else "no unit"
    raise DataError(
        f"column '{column}' has {what}; accepted: {', '.join(form.names)}. Rename it, or say what it is: "
        f"{keyword('columns', {column: form.names[0]})}, or {keyword('columns', {column: EXTRA})} for a "
        f"column of another kind; {INSPECT}"
    )


def is_level_name(column: str) -> bool:
    """Whether a column is called as echocal calls levels: of what, and below which height, it does not say.

    Examples
    --------
    >>> is_level_name("level_m"), is_level_name("reference_level_cm"), is_level_name("battery level")
    (True, True, False)
    """
    found = _exact(column)
    return found is not None and found[0].level


def by_request(column: str, request: str) -> tuple[Form, str] | None:
    """Form and unit that the user asks for, None for `EXTRA`.

    Raises `UsageError` if the request is neither a name (``reading_m``) nor a phrase (``distance reading in
    m``).
    """
    request = request.strip()
    if request == EXTRA:
        return None
    meaning, _, above = request.partition(BELOW)
    if found := _exact(meaning) or phrase(meaning):
        return (_below(found[0], column, above), found[1]) if above else found
    form = _form_of(meaning)
    if form is not None:
        raise UsageError(f"'{column}' = '{request}' has no known unit; accepted: {', '.join(form.names)}")
    known = among(request, [*NAMES, EXTRA, IGNORE], "accepted:")
    raise UsageError(f"'{column}' = '{request}' names no quantity{known}")


def _below(form: Form, column: str, height: str) -> Form:
    """A level that is counted down from the height of the sensor."""
    match = re.fullmatch(r"(?P<height>[-+.\de]+) m", height)
    if match is None or not form.level:
        raise UsageError(
            f"'{column}': a level is written like 'level_cm below 2.6 m', got '... below {height}'"
        )
    meters = float(match["height"])
    units = {name: unit.below(meters) for name, unit in form.units.items()}
    return replace(form, units=units, mount_height=meters)


def looks_like(column: str, form: Form) -> bool:
    """Whether a foreign name may well mean this quantity; for hints, never to decide."""
    stems = {form.role[:4], *(word[:4] for words in form.words for word in words.split())} - {"two-"}
    return any(stem in column.lower() for stem in stems)


def _exact(name: str) -> tuple[Form, str] | None:
    """Match names in any case of the quantity; the unit may be written as people and loggers write it."""
    for role in _ROLES:
        if name.lower() == role or name.lower().startswith(f"{role}_"):
            written = name[len(role) + 1 :]
            exact = NAMES.get(role + name[len(role) :])
            return exact or (NAMES.get(f"{role}_{symbol_of(written)}") if symbol_of(written) else None)
    return None


def phrase(request: str) -> tuple[Form, str] | None:
    """Form and unit of ``distance reading in m``, None where the words or the unit are unknown."""
    form, unit = _form_of(request), unit_of(request)
    return (form, unit) if form is not None and unit in form.units else None


def _form_of(request: str) -> Form | None:
    match = _PHRASE.fullmatch(request)
    words = match["words"].strip().lower() if match else request
    role = next((role for role in _ROLES if words == role or words.startswith(f"{role}_")), "")
    return _FORM_BY_WORDS.get(words) or _FORM_BY_ROLE.get(role)


def unit_of(request: str) -> str:
    """Unit that a name or a phrase ends with, in brackets or after "in"; empty without one."""
    match = _PHRASE.fullmatch(request)
    written = ((match["unit"] or match["bracket"] or "") if match else "").strip()
    known = (unit for unit, words in UNIT_WORDS.items() if written.lower() in words)
    return next(known, written)
