"""Marks of rows in a correction: by the rules that the diagnosis wrote into the model."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.marks import MARKS, RowRule, marked, rules_from
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.plan import make

__all__ = ["NOT_CHECKED", "context_of", "reference_of", "rules_of", "with_marks"]

NOT_CHECKED = "not checked"
"""Begin of a note on faults that a diagnosis repaired and a correction does not look for."""

Column = NDArray[np.float64]


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
