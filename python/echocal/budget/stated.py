"""Uncertainties that a user states: numbers, instruments by their datasheets, tapes by their class."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from echocal.budget.instruments import INSTRUMENTS, TAPES
from echocal.budget.sources import LAW, Source, of_instrument, of_law, of_step, of_tape
from echocal.errors import UsageError, among
from echocal.keywords import keyword
from echocal.observations.units import NAMES

PUBLISHED = {"law": "published"}
"""What stands for the published uncertainty of the model's law."""

_STEPS = {
    "timer_us": ("echo_time", "timer, resolution", 1e-6),
    "timer_ms": ("echo_time", "timer, resolution", 1e-3),
}
_STEPS |= {
    f"resolution_{unit}": ("reading", "reading, resolution", size)
    for unit, size in (("mm", 1e-3), ("cm", 1e-2), ("m", 1.0))
}
_LAW = "law_ppm"
_OTHERS = (*INSTRUMENTS, "tape", *_STEPS, _LAW, "law")


@dataclass(frozen=True)
class Uncertainties:
    """What the user states of the uncertainty of recorded or assumed values."""

    stated: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainties by name of the quantity, or ``echo_time`` [s] or ``reading`` [m]; in SI
    units, temperatures in K. They are independent of each other and of the parameters of the model."""
    instruments: Mapping[str, str] = field(default_factory=dict)
    """Instruments by their names: ``{"thermometer": "DHT22", "tape": "II", "timer_us": "4"}``."""

    @classmethod
    def of(cls, texts: Sequence[str] | Mapping[str, Any]) -> "Uncertainties":
        """From texts such as ``temperature_C=0.5`` or ``thermometer=DHT22``, or the same as a mapping.

        Raises `UsageError` if a name or a number cannot be understood, or one uncertainty would count twice.

        Examples
        --------
        >>> Uncertainties.of(["temperature_F=0.9", "reading_mm=3"]).stated
        {'temperature': 0.5, 'reading': 0.003}
        >>> dict(Uncertainties.of({"thermometer": "dht22", "timer_us": 4}).instruments)
        {'thermometer': 'DHT22', 'timer_us': '4'}
        """
        pairs = texts.items() if isinstance(texts, Mapping) else [_pair(text) for text in texts]
        stated: dict[str, float] = {}
        instruments: dict[str, str] = {}
        for name, value in pairs:
            if name in _OTHERS:
                if name in instruments:
                    raise UsageError(f"{keyword('uncertainties')} states {name} twice; state it once")
                instruments[name] = _known(name, value)
                continue
            quantity, size = _number(name, value)
            if quantity in stated:
                twice = quantity.replace("_", " ")
                raise UsageError(f"{keyword('uncertainties')} states {twice} twice; state it once")
            stated[quantity] = size
        _refuse_twice(stated, instruments)
        return cls(stated, instruments)

    @classmethod
    def from_plain(cls, plain: Mapping[str, float | str]) -> "Uncertainties":
        """From what `plain` returned."""
        numbers = {name: own for name, own in plain.items() if not isinstance(own, str)}
        return cls(numbers, {name: own for name, own in plain.items() if isinstance(own, str)})

    @classmethod
    def with_conditions(cls, own: Any, conditions: Mapping[str, float]) -> "Uncertainties":
        """What is stated, and standard uncertainties [SI] of stated conditions where it says nothing else.

        Raises `UsageError` if a condition is stated, and an instrument as well that would have measured it.

        Examples
        --------
        >>> Uncertainties.with_conditions({"tape": "II"}, {"temperature": 1.0}).plain()
        {'temperature': 1.0, 'tape': 'II'}
        """
        found = own if isinstance(own, cls) else cls.of(own)
        _refuse_twice(conditions, found.instruments)
        return cls({**conditions, **found.stated}, found.instruments)

    def plain(self) -> dict[str, float | str]:
        """As plain data: numbers are standard uncertainties, texts are names of instruments."""
        return {**self.stated, **self.instruments}

    def __bool__(self) -> bool:
        return bool(self.stated or self.instruments)

    @property
    def sources(self) -> list[Source]:
        """The sources of uncertainty; the published one of a law depends on the model and is not here."""
        found = [
            Source(quantity, f"{quantity.replace('_', ' ')}, stated", "normal", size)
            for quantity, size in self.stated.items()
        ]
        for name, value in self.instruments.items():
            if name in INSTRUMENTS:
                found += of_instrument(INSTRUMENTS[name][value])
            elif name == "tape":
                found.append(of_tape(value))
            elif name in _STEPS:
                quantity, words, unit = _STEPS[name]
                found.append(of_step(quantity, words, float(value) * unit))
            elif name == _LAW:
                found.append(of_law(float(value) * 1e-6))
        return found


def _refuse_twice(stated: Mapping[str, float], instruments: Mapping[str, str]) -> None:
    """Refuse a number and an instrument for the error of one quantity: both would count."""
    told = {quantity: f"{quantity.replace('_', ' ')} as a number" for quantity in stated}
    for name, value in instruments.items():
        own, what = f"{name}={value}", _limited(name, value)
        if what and told.setdefault(what, own) != own:
            raise UsageError(
                f"{keyword('uncertainties')} has the error of the {what.replace('_', ' ')} twice, by "
                f"{told[what]} and by {own}, and both would count; leave one of them out"
            )


def _limited(name: str, value: str) -> str:
    """The quantity whose whole error an instrument limits; empty where it is a part of the error alone."""
    if name in INSTRUMENTS:
        return INSTRUMENTS[name][value].quantity
    return LAW if name in ("law", _LAW) else ""


def _known(name: str, value: Any) -> str:
    """The value of an instrument as it is kept."""
    text = str(value).strip()
    names = INSTRUMENTS.get(name, TAPES if name == "tape" else {"published": None} if name == "law" else None)
    stating = keyword("uncertainties", {name: value})
    if names is None:
        try:
            if 0.0 <= float(text) < np.inf:
                return text
        except ValueError:
            pass
        raise UsageError(f"{stating} is no size; give a number >= 0")
    found = {own.upper(): own for own in names}.get(text.upper())
    if found is None:
        raise UsageError(f"{stating}: no such {name}{among(text.upper(), list(names), 'there are')}")
    return found


def _number(name: str, value: Any) -> tuple[str, float]:
    """Quantity and standard uncertainty [SI]."""
    names = [
        own for own, (form, _) in NAMES.items() if not form.label and form.quantity != "reference_distance"
    ]
    if name not in names:
        known = among(name, [*_OTHERS, *names], "there are")
        raise UsageError(f"{keyword('uncertainties', {name: value})} names no quantity with its unit{known}")
    form, symbol = NAMES[name]
    unit = form.units[symbol]
    stating = keyword("uncertainties", {name: value})
    try:
        size = float(value) * unit.numerator / unit.denominator
    except ValueError:
        raise _no_pair(f"{name}={value}") from None
    if not 0.0 <= size < np.inf:
        raise UsageError(f"{stating} is no standard uncertainty; give a number >= 0")
    return form.quantity, size


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise _no_pair(text)
    return name.strip(), value


def _no_pair(text: str) -> UsageError:
    told = keyword("uncertainties", [text])
    return UsageError(f"{told} is not of the form NAME=VALUE; e.g. temperature_C=0.5")
