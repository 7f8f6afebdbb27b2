"""A source of uncertainty: what is known of one input quantity besides its value."""

from dataclasses import dataclass
from math import inf

import numpy as np

from echocal.arrays import Column
from echocal.budget.instruments import TAPES, Limits

ECHOES = ("echo_time", "reading")
LAW = "speed_of_sound"
TAPE = "reference_distance"

_RECTANGULAR = 3.0**0.5


@dataclass(frozen=True)
class Source:
    """Something that makes an input quantity uncertain."""

    quantity: str
    """The input quantity: an influence quantity, ``echo_time``, ``reading``, ``speed_of_sound`` or
    ``reference_distance``."""
    words: str
    """What a person reads."""
    distribution: str
    """``normal`` or ``rectangular``."""
    size: float = 0.0
    """Standard uncertainty, or half-width of the limits [SI; of the speed of sound relative]."""
    limits: Limits | None = None
    """Half-width that depends on the value."""
    tape: str = ""
    """Class of a tape; empty for none."""
    origin: str = "stated"
    """Where the number is from."""
    degrees_of_freedom: float = inf
    rounding: bool = False
    """Whether it is the rounding of an indication to steps, which rows of a model show, too."""

    def standard_uncertainty(self, values: Column) -> Column:
        """Standard uncertainty at some values of the quantity, shape (n,) [SI]."""
        size: Column | float = self.size
        if self.limits is not None:
            size = self.limits.half_width(values)
        elif self.tape:
            constant, slope = TAPES[self.tape]
            size = constant + slope * np.ceil(values)
        return np.broadcast_to(
            size / (_RECTANGULAR if self.distribution == "rectangular" else 1.0), values.shape
        )


def of_instrument(limits: Limits) -> list[Source]:
    """Sources of an instrument: its limits of error and the step of its indication."""
    words = {"relative_humidity": "hygrometer", "pressure": "barometer"}.get(limits.quantity, "thermometer")
    own = Source(
        limits.quantity, f"{words} {limits.name}, limits of error", "rectangular", limits=limits,
        origin=limits.source,
    )  # fmt: skip
    step = of_step(limits.quantity, f"{words} {limits.name}, resolution", limits.resolution, limits.source)
    return [own, step] if limits.resolution else [own]


def of_step(quantity: str, words: str, step: float, origin: str = "stated") -> Source:
    """Source of an indication in steps: half a step to either side (JCGM 100:2008, F.2.2.1)."""
    return Source(quantity, words, "rectangular", 0.5 * step, origin=origin, rounding=True)


def of_tape(class_: str) -> Source:
    """Source of a tape of an accuracy class."""
    origin = "Directive 2014/32/EU, annex X, chapter I; OIML R 35-1:2007"
    return Source(TAPE, f"tape of class {class_}", "rectangular", tape=class_, origin=origin)


def of_law(half_width: float, origin: str = "stated") -> Source:
    """Source of a law of the speed of sound: relative limits of its error."""
    return Source(LAW, "law of the speed of sound", "rectangular", half_width, origin=origin)
