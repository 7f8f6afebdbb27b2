"""Influence quantities: one entry of `table` each."""

from echocal import _core
from echocal.quantities.facts import Form, QuantityFacts, Shown
from echocal.quantities.table import ENTRIES
from echocal.quantities.units import Unit

__all__ = [
    "AIR", "BY_COLUMN", "DEFAULTS", "FROM_THERMOMETERS", "QUANTITIES", "Form", "QuantityFacts", "Shown",
    "Unit",
]  # fmt: skip


_BY_NAME = {facts.id: facts for facts in ENTRIES}


def _entry(name: str) -> QuantityFacts:
    try:
        return _BY_NAME[name]
    except KeyError:
        raise ImportError(
            f"the core has a quantity '{name}' (rust/core/src/conditions.rs) that has no entry in "
            "python/echocal/quantities/table.py; write this entry"
        ) from None


QUANTITIES: dict[str, QuantityFacts] = {facts["name"]: _entry(facts["name"]) for facts in _core.quantities()}
"""Every influence quantity by name, in the order in which the core takes them."""

DEFAULTS: dict[str, float] = {name: q.default for name, q in QUANTITIES.items() if q.default is not None}
"""Values that are assumed where none is recorded."""

_READ_BY_LAWS = {name for law in _core.laws() for name in law["reads"]}
AIR: tuple[str, ...] = tuple(name for name in QUANTITIES if name in _READ_BY_LAWS)
"""Quantities of the air that laws read, in the order in which the core takes them."""

FROM_THERMOMETERS: tuple[str, ...] = tuple(
    name for name, q in QUANTITIES.items() if q.derived_from == "a further thermometer"
)
"""Quantities that any further thermometer of a table may hold: a model says which (`Model.columns`)."""

BY_COLUMN: dict[str, QuantityFacts] = {q.column: q for q in QUANTITIES.values()}
"""Quantities by the name of the column that an error is a function of."""
