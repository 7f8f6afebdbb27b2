"""What columns of a log may hold, for a person to accept: by name and unit, else by their values."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import EchocalError
from echocal.keywords import command_line
from echocal.observations.alike import follows
from echocal.observations.by_values import guesses, usual
from echocal.observations.checks import CODES
from echocal.observations.doubtful import doubtful_in
from echocal.observations.fields import is_empty, shown
from echocal.observations.found import Found
from echocal.observations.hints import completed, hint, is_time_name, role_of, role_of_unit
from echocal.observations.mount import is_level
from echocal.observations.names import EXTRA, IGNORE, by_name, by_request, is_level_name
from echocal.observations.units import NAMES, has_foreign_unit, split_unit, symbol_of
from echocal.observations.vocabulary import LENGTH, LEVELS, TOKEN


@dataclass(frozen=True)
class Proposal:
    """What a column may hold."""

    request: str  # as in `columns`; empty for a column that is no quantity
    reason: str
    guess: bool = False  # whether it may be wrong: only the values say it

    @property
    def quantity(self) -> str:
        """Quantity that the request names; empty where it names none, or several."""
        return _quantity(self.request)


def propose(table: pd.DataFrame, found: Found, given: Mapping[str, str]) -> dict[str, Proposal]:
    """A proposal for each column; what the user says goes first."""
    columns = [str(name) for name in table.columns]
    doubtful = doubtful_in(table, {**found.requests, **given})
    sure, _ = completed(columns, given, found, doubtful)
    proposals = {name: _of_name(name, sure, given, found) for name in columns}
    told = {n: why.partition(";")[0].partition(" and is not")[0] for n, why in doubtful.items()}
    proposals |= {n: Proposal("", why) for n, why in told.items() if not proposals[n].request}
    held = {quantity for p in proposals.values() if (quantity := p.quantity)}
    for name in (n for n in columns if is_level_name(n) and not proposals[n].request):
        if name not in given and (quantity := _quantity(name)) not in held:
            proposals[name] = Proposal(
                name, "its name: a level, which rises as the distance falls", guess=True
            )
            held.add(quantity)
    roles = {name: role_of(name) or _by_unit(name, table, held) for name in columns}
    bare = {name: role for name, role in roles.items() if role and not proposals[name].request}
    for name, role in sorted(bare.items(), key=lambda pair: pair[1] == "distance"):
        numbers = _numbers(table[name])
        if (
            numbers is None
            or name in doubtful
            or has_foreign_unit(name)
            or given.get(name) in {EXTRA, IGNORE}
        ):
            continue
        own = role
        unit = (
            symbol_of(found.units.get(name, ""))
            or split_unit(name)[1]
            or symbol_of(name)
            or usual(own, numbers)
        )
        request = _request(own, unit)
        if request and _quantity(request) not in held:
            values = "of a quality number" if own == "echo_quality" else f"as usual in {unit or 'a fraction'}"
            why = f"its name, and values {values}"
            proposals[name] = Proposal(request, why, guess=True)
            held.add(_quantity(request))
        elif request and own in ("reading", "echo"):
            _tell_rival(name, _quantity(request), proposals)
    if not {"reading", "echo_time"} & held or "temperature" not in held:
        _by_values(table, found, proposals, held, {name for name in roles if roles[name]})
    if "reading" not in held:
        _distance_as_reading(table, proposals, given)
    return proposals


def _tell_rival(name: str, quantity: str, proposals: dict[str, Proposal]) -> None:
    """Say of a guess that another column may hold the same: a ranger beside it."""
    for first, own in proposals.items():
        if own.guess and own.quantity == quantity:
            each = command_line("diagnose", "LOG", by=f"{first},{name}")
            why = f"{own.reason}, and so '{name}': for both, {each}"
            proposals[first] = replace(own, reason=why)
            return


def unfit(table: pd.DataFrame, names: Sequence[str]) -> str:
    """Why columns that are called like an echo cannot be one; empty where one may be."""
    for name in table.columns:
        if has_foreign_unit(name) and role_of(name.partition("(")[0].partition("[")[0]) in {
            "reading",
            "echo",
        }:
            return f"'{name}' has a unit that echocal does not convert: convert it to m, cm, mm, inch or ft"
    for name in names:
        if _numbers(table[name]) is None:
            text = next((str(value) for value in table[name] if not is_empty(value)), "")
            return f"'{name}' has text ('{shown(text)}'): write plain numbers, 2495 or 2495.5"
    if not names and all(_numbers(table[name]) is None for name in table.columns):
        return "No column has numbers"
    return ""


def codes_in(values: pd.Series[Any]) -> list[float]:
    """Values that loggers write where they have none, and that lie far from all others."""
    numbers = _numbers(values)
    if numbers is None:
        return []
    finite = numbers[np.isfinite(numbers)]
    usual = finite[~np.isin(finite, CODES)]
    if not len(usual):
        return []
    low, high = np.quantile(usual, [0.01, 0.99])
    width = max(high - low, 0.01 * abs(high), 1e-9)
    return [code for code in CODES if code in finite and not low - 3 * width <= code <= high + 3 * width]


def _of_name(name: str, sure: Mapping[str, str], given: Mapping[str, str], found: Found) -> Proposal:
    if name in given:
        return Proposal(given[name], "as you say")
    if name in found.requests:
        ways = {IGNORE: "part of time, time_s", EXTRA: "another column has the same"}
        why = ways.get(found.requests[name], "its values are times")
        return Proposal(found.requests[name], "the log says so" if name in found.sure else why)
    try:
        if ours := by_name(name):
            form, unit = ours
            return Proposal(f"{form.role}_{unit}" if unit else form.role, "its name")
    except EchocalError:
        if name not in sure:
            return Proposal("", "its name has no unit")
    if name in sure:
        return Proposal(sure[name], "its name and its unit")
    said = hint(name, found.units.get(name, ""))
    if said is not None:
        return Proposal("", f"may be {said.name}, as another column may be")
    return Proposal("", "")


def _by_unit(name: str, table: pd.DataFrame, held: set[str]) -> str:
    """Which quantity a column may hold that is called by its unit: a time that runs on is a clock."""
    role, numbers = role_of_unit(name), _numbers(table[name])
    if not role or numbers is None or not usual(role, numbers):
        return ""
    return "" if role == "echo" and (np.diff(numbers[np.isfinite(numbers)]) >= 0).all() else role


def _by_values(
    table: pd.DataFrame, found: Found, proposals: dict[str, Proposal], held: set[str], named: Collection[str]
) -> None:
    """Guesses and questions for the columns whose names say nothing."""
    free, units, level = {}, {}, ""
    for name in map(str, table.columns):
        numbers = None if is_time_name(name) else _numbers(table[name])
        if name in named or proposals[name].request or numbers is None or has_foreign_unit(name):
            continue
        words = {token.lower() for token in TOKEN.findall(name)}
        if LEVELS & words and "sensor" not in words:  # a sensor of levels measures the distance to them
            level = level or (name if split_unit(name)[1] in LENGTH else "")
            continue
        free[name] = numbers
        units[name] = symbol_of(found.units.get(name, "")) or split_unit(name)[1]
    known = bool({"reading", "echo_time"} & held)
    for name, guess in guesses(free, units, held, _reference(table, proposals)).items():
        if level and guess.request.startswith("reading"):  # the device indicates the level
            proposals[name] = Proposal("", f"a length beside '{level}', which is a level: say what it is")
            continue
        if (
            known and guess.request
        ):  # a table whose names say something: no other column is taken by its values
            proposals[name] = Proposal("", f"may be {guess.request}, by its values: say so")
            continue
        proposals[name] = Proposal(guess.request, guess.reason, guess=bool(guess.request))
        held.add(_quantity(guess.request))


def _reference(table: pd.DataFrame, proposals: Mapping[str, Proposal]) -> tuple[str, Column] | None:
    """The column that is the reference distance by its name, and its values [m]; None without one."""
    for name, own in proposals.items():
        if own.quantity == "reference_distance" and not own.guess and not is_level(name, own.request):
            values = _si(table, name, proposals)
            if values is not None:
                return name, values
    return None


def _distance_as_reading(
    table: pd.DataFrame, proposals: dict[str, Proposal], given: Mapping[str, str]
) -> None:
    """The distance of a log, and no ruler by its name, as what the sensor reads.

    It is where the log has no echo, where a ruler stands beside it, or where it follows from the echo time in
    every row: the device computes it, nobody measured it. A reference agrees with an echo only as well as
    both were measured; what is computed, as well as it is written.
    """
    held = {own.quantity: name for name, own in proposals.items()}
    names = [name for name, own in proposals.items() if own.quantity == "reference_distance"]
    if len(names) != 1 or names[0] in given or role_of(names[0]) == "distance":
        return
    name, echo, air = names[0], held.get("echo_time", ""), held.get("temperature", "")
    reading = f"reading_{proposals[name].request.rpartition('_')[2]}"
    d, t, celsius = (_si(table, own, proposals) if own else None for own in (name, echo, air))
    if d is None or reading not in NAMES:
        return
    ruler, request = _ruler(table, proposals, given)
    if not echo:
        why = "the only distance, and the log has no echo"
    elif request:
        why = f"a distance beside the echo, and '{ruler}'"
    elif t is not None and follows(d, t, celsius):
        why = f"it follows from '{echo}': the device computes it"
    else:
        return
    proposals[name] = Proposal(reading, why, guess=True)
    if request:
        proposals[ruler] = Proposal(request, "its name: the reference beside the reading", guess=True)


def _ruler(
    table: pd.DataFrame, proposals: Mapping[str, Proposal], given: Mapping[str, str]
) -> tuple[str, str]:
    """The only column that is a ruler by its name, and what it may be; empty without one."""
    rulers = [n for n, own in proposals.items() if role_of(n) == "distance" and not own.request]
    numbers = _numbers(table[rulers[0]]) if len(rulers) == 1 and rulers[0] not in given else None
    if numbers is None:
        return "", ""
    return rulers[0], _request("distance", split_unit(rulers[0])[1] or usual("distance", numbers))


def _si(table: pd.DataFrame, name: str, proposals: Mapping[str, Proposal]) -> Column | None:
    """Values of a column as its proposal has them [SI]; None where they are no numbers."""
    found, numbers = by_request(name, proposals[name].request), _numbers(table[name])
    return None if found is None or numbers is None else found[0].units[found[1]].to_si(numbers)


def _request(role: str, unit: str) -> str:
    name = f"{role}_{unit}" if unit else role
    return name if name in NAMES else ""


def _quantity(request: str) -> str:
    if not request or request in {EXTRA, IGNORE}:
        return ""
    try:
        found = by_request("", request)
    except EchocalError:
        return ""
    return "" if found is None or found[0].several else found[0].quantity


def _numbers(values: pd.Series[Any]) -> Column | None:
    if not pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values):
        numbers = pd.to_numeric(values, errors="coerce")
        if numbers.notna().sum() * 2 < len(values):
            return None
        values = numbers
    return values.to_numpy(dtype=np.float64, na_value=np.nan)
