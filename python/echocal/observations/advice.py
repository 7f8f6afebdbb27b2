"""What to say where a table lacks an echo or a temperature: which column may be it, and how to say so."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

from echocal.keywords import keyword
from echocal.observations.by_values import AGREES
from echocal.observations.found import found_in
from echocal.observations.hints import role_of
from echocal.observations.misspelled import meant as meant_by
from echocal.observations.names import INSPECT, looks_like, unit_of
from echocal.observations.plan import Assignment, Plan
from echocal.observations.proposals import Proposal, propose, unfit
from echocal.observations.units import FORMS, split_unit
from echocal.observations.vocabulary import LENGTH, LEVELS, TOKEN
from echocal.quantities import Form

if TYPE_CHECKING:
    import pandas as pd

_SAY = "Say which it is"


def no_echo(table: pd.DataFrame, plan: Plan) -> str:
    """Say that no column holds an echo time or a reading, and which may."""
    echo = [form for form in FORMS if form.quantity in ("echo_time", "reading")]
    names = ", ".join(name for form in echo[:1] + echo[3:4] for name in form.names)
    columns = ", ".join(str(name) for name in table.columns)
    return (
        f"no column holds an echo time or a distance reading; accepted: {names}. "
        f"The table has: {columns}. {_level(table) or _advice(table, plan, echo)}"
    )


def _level(table: pd.DataFrame) -> str:
    """How to say that a column which is called so holds a level; empty without one."""
    for column in map(str, table.columns):
        _, unit = split_unit(column)
        if unit in LENGTH and LEVELS & {token.lower() for token in TOKEN.findall(column)}:
            said = keyword("columns", {column: f"level_{unit}"})
            return f"If the device indicates a level: {said} {keyword('mount_height', 'METERS')}"
    return ""


def which_temperature(table: pd.DataFrame, plan: Plan) -> dict[str, str]:
    """How to say which column is the temperature, as `columns` takes it."""
    forms = [form for form in FORMS if form.quantity == "temperature"]
    if meant := meant_by(plan.others, forms):
        return meant
    given = {own.column: own.name for own in plan.assignments.values()}
    proposed = propose(table, found_in(table), given)
    asked = [name for name in plan.others if "temperature" in proposed[name].reason]
    sure = [name for name in plan.others if proposed[name].request.startswith("temperature")]
    name = next(iter([*sure, *asked]), "")
    return {name or "NAME": (name and proposed[name].request) or "temperature_C"}


def _advice(table: pd.DataFrame, plan: Plan, echo: Collection[Form]) -> str:
    """Which column may be the one, of those whose names say nothing: misspelled, alike, or the first."""
    others, reference = plan.others, plan.assignments.get("reference_distance")
    proposed = propose(table, found_in(table), {})
    likely = [
        {name: p.request}
        for name, p in proposed.items()
        if p.request.startswith(("reading", "echo")) and p.request != "echo_quality"
    ]
    if reference is not None:
        beside = [one for one in likely if {*one} <= {*others} and _is_named(one, proposed)]
        ruler = role_of(reference.column) == "distance"
        if len(beside) == 1:
            (name,) = beside[0]
            why = proposed[name].reason if proposed[name].reason.startswith(AGREES) else INSPECT
            return f"{_SAY}: {keyword('columns', beside[0])}; {why}"
        if not ruler and not meant_by(others, echo):
            request = keyword("columns", {reference.column: f"reading_{reference.unit_name}"})
            return f"Record one of them; if the sensor indicates '{reference.column}': {request}"
        if not others:
            return f"Record one of them beside '{reference.column}', which is the reference by its name"
    if not others:
        return "Record one of them"
    if meant := meant_by(others, echo):
        return f"Did you mean: {keyword('columns', meant)}"
    return _of_others(table, others, echo, likely, proposed)


def _of_others(
    table: pd.DataFrame,
    others: Collection[str],
    echo: Collection[Form],
    likely: list[dict[str, str]],
    proposed: Mapping[str, Proposal],
) -> str:
    alike = [(name, form) for name in others for form in echo if looks_like(name, form)]
    for name, form in alike:
        if unit_of(name) in form.units:
            return f"{_SAY}: {keyword('columns', {name: Assignment(name, form, unit_of(name)).name})}"
    if likely:
        return f"{_SAY}: {keyword('columns', likely[0])}; {INSPECT}"
    asked = [
        f"'{name}' {p.reason.partition(':')[0]}"
        for name, p in proposed.items()
        if "a distance in" in p.reason
    ]
    if told := unfit(table, [name for name, _ in alike]):
        return f"{told}; {INSPECT}"
    if asked:
        units = {name: p.reason for name, p in proposed.items() if "a distance in" in p.reason}
        name, reason = next(iter(units.items()))
        unit = reason.partition("a distance in ")[2].split(" ")[0]
        request = keyword("columns", {name: f"reading_{unit}"})
        return f"{'; '.join(asked)}. Say which is the distance: {request}; {INSPECT}"
    first = alike[0][0] if alike else next(iter(others))
    if told := unfit(table, [first]):
        return f"{told}; {INSPECT}"
    return f"{_SAY}: {keyword('columns', {first: 'reading_m'})}; {INSPECT}"


def _is_named(request: Mapping[str, str], proposed: Mapping[str, Proposal]) -> bool:
    """Whether the name of a column speaks of an echo or a reading, or its values agree with the reference."""
    return all(proposed[name].reason.startswith(("its name", AGREES)) for name in request)
