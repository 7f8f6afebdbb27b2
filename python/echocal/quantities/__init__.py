"""Influence quantities: one file each.

The core lists the quantities and holds what physics reads of them (`rust/core/src/conditions.rs`,
one line each). A file here, named as the quantity, holds the rest. Every other place asks these entries.
"""

from importlib import import_module

from echocal import _core
from echocal.quantities.facts import QuantityFacts, Shown
from echocal.quantities.form import Form
from echocal.quantities.units import Unit

__all__ = [
    "AIR",
    "BY_COLUMN",
    "DEFAULTS",
    "FROM_THERMOMETERS",
    "QUANTITIES",
    "Form",
    "QuantityFacts",
    "Shown",
    "Unit",
]


def _entry(name: str) -> QuantityFacts:
    """Entry of a quantity of the core; `temperature_later_1` and the like share a file."""
    file = name.rstrip("_0123456789")
    try:
        module = import_module(f"echocal.quantities.{file}")
    except ModuleNotFoundError:
        message = (
            f"the core has a quantity '{name}' (rust/core/src/conditions.rs), and "
            f"python/echocal/quantities/{file}.py is missing; write that file"
        )
        raise ImportError(message) from None
    facts: QuantityFacts | dict[str, QuantityFacts] = module.FACTS
    return facts[name] if isinstance(facts, dict) else facts


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
