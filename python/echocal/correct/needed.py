"""Which columns of a table a correction reads; no other column is parsed."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal import _core
from echocal.arrays import Column
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.model.indicated_speed import speed_of
from echocal.observations import Observations
from echocal.observations.marks import MARKS, RowRule, marked, rules_from
from echocal.observations.mount import mounted_as
from echocal.observations.names import IGNORE
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.plan import EVERYTHING, make
from echocal.quantities import AIR, DEFAULTS, FROM_THERMOMETERS, QUANTITIES
from echocal.registry import find_effect

_ECHOES = ("echo_time", "reading")
_SOURCES = {"time": "elapsed_time", "times": "elapsed_time"}  # words of `derived_from`
NOT_CHECKED = "not checked"
"""Begin of a note on faults that a diagnosis repaired and a correction does not look for."""


@dataclass(frozen=True)
class Needed:
    """What a model reads of a table."""

    columns: tuple[str, ...]
    """Columns to parse, in the order of the table."""
    requests: Mapping[str, str]
    """Meaning of these columns."""
    reference: Mapping[str, str]
    """Those of them that only rules for rows read, with their meaning; empty where the name says it."""
    assumed: tuple[str, ...]
    """Quantities of the air that the model reads, and that the table does not have."""
    remembers: tuple[str, ...]
    """What of the model depends on other rows of the log; empty if every row can be corrected by itself."""
    rows_around: int
    """Rows before and after a row that its marks depend on."""


def needed(
    names: Collection[str],
    model: Model,
    requests: Mapping[str, str],
    *,
    reading_speed: str | float | None = None,
    trust: Collection[str] = (),
    mark_rows: bool = True,
    ordered: bool = False,
) -> Needed:
    """Find the columns that a model reads among those of a table.

    Where a log may have several files (`ordered`), marks that look at rows around need the times, too: only
    they tell which file is the next. Raises `UsageError` or `DataError` as `echocal.read_observations`, if a
    request or the name of a column cannot be understood.
    """
    refuse_repeated(names)
    requests = mounted_as(requests, model)
    plan = make(list(names), requests, trust)
    rules = rules_of(model) if mark_rows and MARKS in model.provenance else ()
    reads = {
        *_ECHOES,
        *model.reads,
        *_law_reads(speed_of(model, reading_speed)),
        *(_SOURCES.get(r.quantity, r.quantity) for r in rules),
    }
    around = context_of(model) if rules else 0
    if ordered and around:
        reads.add("elapsed_time")
    stands_for = {name for id_ in model.effects for name in find_effect(id_).excludes}
    reads |= stands_for
    reads |= set(() if model.shape is None else model.shape.columns)
    sources = {word for name in reads for word in _derived_from(name)}
    wanted = reads | sources
    held = {source.column: quantity for quantity, source in plan.assignments.items()}
    thermometers, extra = set(model.columns.values()), wanted - set(QUANTITIES)
    used = {
        name for name, quantity in held.items() if quantity in wanted and quantity != "reference_distance"
    }
    used |= {name for name in plan.several if name in thermometers}
    if thermometers - set(plan.several):  # for the message on it
        used |= {*plan.several, *(thermometers & set(plan.others))}
    used |= {name for name in (*plan.others, *plan.several) if name in extra}
    if not {*_ECHOES} & {*plan.assignments}:
        used = {*names}  # for the message on it
    reference: set[str] = set()
    if any("reference" in rule.kind + rule.quantity for rule in rules):
        reference = {name for name, quantity in held.items() if quantity == "reference_distance"}
    columns = tuple(name for name in names if name in used | reference)
    asked = {name: request for name, request in requests.items() if name in columns}
    recorded = {*plan.assignments, *model.air}
    return Needed(
        columns,
        asked | dict.fromkeys(reference, IGNORE),
        {name: requests.get(name, "") for name in columns if name in reference},
        tuple(n for n in AIR if n in model.reads and n in DEFAULTS and n not in recorded | stands_for),
        remembered(model),
        around,
    )


def remembered(model: Model) -> tuple[str, ...]:
    """What of a model depends on other rows of the log: effects and terms, by their names."""

    def depends(name: str) -> bool:
        return name == "elapsed_time" or is_derived(name)

    effects = [id_ for id_ in model.effects if any(map(depends, find_effect(id_).reads))]
    shape = () if model.shape is None else model.shape.columns
    return (*effects, *(f"the term against {name}" for name in shape if depends(name)))


def is_derived(name: str) -> bool:
    """Whether a quantity is derived from several rows of a log; the hour angle is not."""
    return name != "hour_angle" and bool(_derived_from(name))


def refuse_repeated(names: Collection[str]) -> None:
    """Refuse a table that has two columns of one name."""
    listed = list(names)
    repeated = next((name for name in listed if listed.count(name) > 1), None)
    if repeated is not None:
        raise DataError(f"the table has more than one column '{repeated}'; rename all but one")


def trusted(trust: Collection[str], columns: Collection[str]) -> list[str]:
    """Trusted columns among those that are read."""
    return [name for name in trust if name in columns or name == EVERYTHING]


def _law_reads(law: str) -> list[str]:
    by_id = {facts["id"]: facts["reads"] for facts in _core.laws()}
    return list(by_id.get(law, ["temperature"]))


def _derived_from(name: str) -> list[str]:
    """Quantities and labels that a derived quantity is made of; empty for one that is recorded."""
    if name not in QUANTITIES or name in FROM_THERMOMETERS:
        return []
    words = (QUANTITIES[name].derived_from or "").split()
    known = {*QUANTITIES, "group", "order"}
    return [source for word in words if (source := _SOURCES.get(word, word)) in known]


def refuse_no_model(model: object) -> None:
    """Refuse what is given for a model and is none: a path, the name of a law, a diagnosis."""
    if not isinstance(model, Model):
        given = repr(model) if isinstance(model, str | Path) else f"a {type(model).__name__}"
        message = f"correct needs a Model, got {given}; Model('cramer'), Model.load(path) or diagnosis.model"
        raise UsageError(message)


def rules_of(model: Model) -> tuple[RowRule, ...]:
    """Rules by which the diagnosis that made a model left rows out.

    Raises `ModelError` if the model has something else in their place.
    """
    return rules_from(_kept(model).get("rules", ()))


def context_of(model: Model) -> int:
    """Rows before and after a part of a table that the marks of its rows depend on.

    Whoever corrects a table in parts and gives each part so many rows more on both sides gets the same
    marks as for the whole table.
    """
    return max((rule.context for rule in rules_of(model)), default=0)


def with_marks(
    observations: Observations, distance: Column, reference: Column | None, model: Model
) -> tuple[Column, NDArray[np.str_], tuple[str, ...]]:
    """Corrected distances without those of marked rows, the marks, and sentences for the user.

    Only usable rows are marked: what cannot be as it was read is that, and no outlier.
    """
    rules, notes = rules_of(model), []
    found, unchecked = marked(observations, distance, reference, rules)
    if unchecked:
        notes.append(
            f"{NOT_CHECKED}: {', '.join(unchecked)}; the diagnosis of the model found such rows by a column "
            "(reading, echo time or reference distance) that this table does not have"
        )
    if other := _kept(model).get("without_rule", ()):
        notes.append(
            f"{NOT_CHECKED}: {', '.join(map(str, other))}; the diagnosis of the model found that in its "
            "table, and a correction repairs nothing: if this table has it, repair it before"
        )
    return np.where(found == "", distance, np.nan), found, tuple(notes)


def reference_of(
    table: pd.DataFrame, requests: Mapping[str, str], missing: Any, model: Model
) -> Column | None:
    """Reference distances [m], shape (n,), for rules that need them; None where there are none."""
    if not any("reference" in rule.kind + rule.quantity for rule in rules_of(model)):
        return None
    source = make(list(table.columns), dict(requests)).assignments.get("reference_distance")
    if source is None:
        return None
    try:
        values = to_numbers(table[source.column], source.column, Missing(missing))
    except DataError:  # text; a correction does not need it
        return None
    return np.asarray(source.unit.to_si(values))


def _kept(model: Model) -> Mapping[str, Any]:
    kept = model.provenance.get(MARKS, {})
    return kept if isinstance(kept, Mapping) else {"rules": kept}
