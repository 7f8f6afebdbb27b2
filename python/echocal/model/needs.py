"""Conditions that a model needs, and whether it is used inside its domain."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from numbers import Real

from numpy.typing import ArrayLike

from echocal import _core
from echocal.domain import warn_outside
from echocal.errors import AbsentError, DataError, ModelError
from echocal.keywords import by_caller, keyword
from echocal.quantities import AIR, DEFAULTS, FROM_THERMOMETERS, QUANTITIES
from echocal.registry import find_effect


@dataclass(frozen=True)
class Needs:
    """Influence quantities that a model requires or excludes, each with the law or effect that does so."""

    required: Mapping[str, str]
    """Quantities that must be given, with the law or effect that needs them."""
    excluded: Mapping[str, str]
    """Quantities that must not be given, with the effect that replaces them."""
    arithmetic: frozenset[str]
    """Required quantities that only the arithmetic of the device reads, after the echo time."""
    laws: Mapping[str, str | None]
    """Laws whose domain counts, with the effect that calls them (None: the model's own)."""

    def check(self, conditions: Mapping[str, ArrayLike], *, times: bool = False) -> None:
        """Raise `DataError` where what is given does not fit the model, or its echo times alone."""
        for name, who in self.required.items():
            if name not in conditions and not (times and name in self.arithmetic):
                source = QUANTITIES[name].derived_from
                if name in FROM_THERMOMETERS:
                    way = by_caller(
                        f"say which of a table's further thermometers it is, Model(columns={{'{name}': "
                        f"'temperature_box_C'}}), or pass {name}=...",
                        "the file of a model says under columns which further thermometer it is",
                    )
                    raise DataError(f"{who} needs {name} [degC], which is not given; {way}")
                record = f"record {source} (read_observations derives it)" if source else "record it"
                message = f"{who} needs {name} [{QUANTITIES[name].unit}], which is not given; "
                message += by_caller(
                    f"{record}, pass {name}=..., or assume a value with Model(air={{'{name}': ...}})"
                    f"{_of_a_table() if name == 'temperature' else ''}",
                    _for_a_command(name, source),
                )
                raise AbsentError(message, name)
        for name, who in self.excluded.items():
            if name in conditions:
                raise DataError(
                    f"{who} replaces a {name} that was not recorded, but {name} is given and would "
                    f"count twice; drop the effect, or do not give {name}"
                )

    def warn_outside(
        self, conditions: Mapping[str, ArrayLike], effects: Mapping[str, Mapping[str, float]]
    ) -> None:
        """Warn once where a law is used outside its domain."""
        for law, effect in self.laws.items():
            # a parameter named as a quantity stands for it
            air = {**conditions, **(effects[effect] if effect else {})}
            values = [air[name] if name in air else DEFAULTS[name] for name in AIR]
            row = [value for value in values if isinstance(value, float | int)]
            if len(row) == len(AIR) and _core.departure(law, [*row, 0.0]) is None:
                continue  # numbers alone, inside: the common case is fast
            warn_outside(*values, law=law, stacklevel=5)


def assumed(air: Mapping[str, float]) -> dict[str, float]:
    """Return the assumed air, checked: known quantities, possible values."""
    for name, value in air.items():
        if name not in QUANTITIES:
            raise ModelError(f"air has unknown quantity '{name}'; known: {', '.join(QUANTITIES)}")
        unit = QUANTITIES[name].unit
        if not isinstance(value, Real) or not isfinite(value):
            raise ModelError(f"air.{name} is {value!r}; give a finite number [{unit}]")
        low, high = QUANTITIES[name].possible
        if not low <= value <= high:
            raise ModelError(f"air.{name} is {value:g}, outside {low:g} .. {high:g} [{unit}]")
    return {name: float(value) for name, value in air.items()}


def of_thermometers(columns: Mapping[str, str]) -> dict[str, str]:
    """Return the columns that quantities are read from, checked: the quantity may be in several columns."""
    if not isinstance(columns, Mapping):
        raise ModelError(f"columns maps quantities to names of columns; got {columns!r}")
    for quantity, column in columns.items():
        if quantity not in FROM_THERMOMETERS or not isinstance(column, str) or not column:
            raise ModelError(
                f"columns has '{quantity}': {column!r}; give the name of a column for "
                f"{' or '.join(FROM_THERMOMETERS)}"
            )
    return dict(columns)


def of(model: _core.Model) -> Needs:
    """Gather the needs of a law and its effects from the facts."""
    return _of(model.law, tuple(model.law_reads), tuple(id_ for id_, _ in model.terms))


@lru_cache
def _of(law: str, reads: tuple[str, ...], effects: tuple[str, ...]) -> Needs:
    required: dict[str, str] = {}
    excluded: dict[str, str] = {}
    laws: dict[str, str | None] = {law: None} if "temperature" in reads else {}
    for name in reads:
        if QUANTITIES[name].default is None:
            required[name] = f"law '{law}'"
    acting = [find_effect(id_) for id_ in effects]
    for effect in acting:
        id_ = effect.id
        without_default = (name for name in effect.reads if QUANTITIES[name].default is None)
        for name in (*effect.requires, *without_default):
            required.setdefault(name, f"effect '{id_}'")
        excluded.update({name: f"effect '{id_}'" for name in effect.excludes if name in reads})
        if effect.calls:
            laws.setdefault(effect.calls, id_)
    before = {name for effect in acting if effect.stage != "firmware" for name in effect.reads}
    return Needs(required, excluded, frozenset(required) - before - {*reads}, laws)


def _for_a_command(name: str, source: str | None) -> str:
    """How the user of a command gives a quantity."""
    if source:
        return f"it is derived from {source}: record that"
    column = QUANTITIES[name].forms[0].names[0]
    return (
        f"map a column, {keyword('columns', {'NAME': column})}, or state it for the whole table, "
        f"{keyword('at', {column: '20+-2' if name == 'temperature' else 'VALUE'})}"
    )


def _of_a_table() -> str:
    return f"; of a whole table: {keyword('at', {'temperature': '20+-2'})}"
