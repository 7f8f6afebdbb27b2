"""The integers that correct an echo code for a unit, and a bound of what they leave, over the whole box."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.per_unit.box import Box, Side

_TOP = 65_535  # of a uint16_t
_MOST_PLACES = 8
_FEW_PLACES = 2  # a shift of an AVR by one byte is free, by two bits takes four cycles, by more a loop


@dataclass(frozen=True)
class Echoes:
    """The echo codes of the function underneath, and how far one of them is."""

    tick: float  # echo time of one code [us]
    last: int  # last accepted code
    slopes: tuple[float, float]  # least and greatest distance of one code, over all conditions [um]


@dataclass(frozen=True)
class Layout:
    """The correction of an echo code: ``added = (code * rate >> 16) + delay``, ``code - (added >> places)``.

    What it corrects to is the code of the unit with the least parameters. A unit adds to that, in codes,
    ``code * (r - r0) / (1 - r0) + (d - d0) / (1 - r0) / tick``, with its delay ``d`` and its rate
    ``r = f / (1 + f)``.
    """

    box: Box
    echoes: Echoes
    places: int  # binary places of what is added
    center: int  # added to the delay, so that errors of both signs are equally large [2^-places codes]
    slope: int
    """Distance of a whole code [um], by which the fraction is taken off the output; 0 where it is not."""

    @classmethod
    def of(cls, box: Box, echoes: Echoes, *, fine: bool, bytewise: bool) -> "Layout":
        """Return the layout with most places.

        `fine`: the fraction of a code is taken off the output; `bytewise`: shifts are cheap by whole bytes
        alone. Raises `UsageError` if the box needs more than 16 bits.
        """
        slope = round(sum(echoes.slopes) / 2) if fine else 0
        few = bytewise and not fine
        for places in range(_MOST_PLACES, -1, -1):
            tried = cls(box, echoes, places, 0, slope)
            if tried._fits() and (places == _MOST_PLACES or not few or places <= _FEW_PLACES):
                low, high = tried._codes_off()
                return cls(box, echoes, places, max(0, round((low + high) / 2 * 2**places)), slope)
        raise UsageError(
            "a unit of this box adds more to an echo code than 16 bits hold: give narrower ranges "
            f"({keyword('per_unit', 'EFFECT=LOW:HIGH')}) or shorter echoes ({keyword('longest')})"
        )

    def _rate0(self) -> float:
        """Rate of the unit with the least parameters [1]."""
        clock = self.box.clock
        return clock.least / clock.parameter.steps if clock.free else clock.parameter.linear(clock.low)

    def _scales(self) -> tuple[float, float]:
        """Steps of `delay` and of `rate` for a step of the block."""
        delay = 2.0**self.places / (self.box.delay.parameter.steps * 1e-6 * self.echoes.tick)
        rate = 2.0 ** (16 + self.places) / self.box.clock.parameter.steps
        return delay / (1.0 - self._rate0()), rate / (1.0 - self._rate0())

    def _converted(self, side: Side) -> tuple[int, int]:
        """Shift and factor by which the C scales steps of the block: ``(steps << shift) * factor >> 16``."""
        scale = self._scales()[self.box.sides.index(side)]
        shift = max(0, math.floor(math.log2(scale)) + 1)
        return shift, min(_TOP, round(scale / 2.0**shift * 65_536))

    def converted(self, side: Side, stored: ArrayLike) -> NDArray[np.int64]:
        """Return what the C makes of a stored parameter, without the center."""
        shift, factor = self._converted(side)
        steps = np.asarray(stored, dtype=np.int64) - side.least
        return np.asarray((steps << shift) * factor >> 16) if side.free else np.zeros_like(steps)

    def _fits(self) -> bool:
        """Whether no sum leaves 16 bits where that matters.

        An echo code so large that the sum wraps is corrected by less than 2^(16 - places) codes, and stays
        above the last accepted one; so does one from which more than itself is subtracted.
        """
        room = 2 ** (16 - self.places)
        latest = min(_TOP, self.echoes.last + room)
        free = [side for side in self.box.sides if side.free]
        shifted = [side.span << self._converted(side)[0] for side in free]
        delay, rate = (int(self.converted(side, side.least + side.span)) for side in self.box.sides)
        most = (latest * rate >> 16) + delay + 2**self.places
        cut = 2**self.places - 1
        widest = max([most, rate, cut * self.slope, self.echoes.last + room, *shifted])
        return bool(widest <= _TOP)

    def _codes_off(self) -> tuple[float, float]:
        """Least and greatest error of the corrected echo code, over the box and all echo codes [codes]."""
        unit = 2.0**self.places
        delay, rate = (self._off(side) for side in self.box.sides)
        latest = min(_TOP, self.echoes.last + 2 ** (16 - self.places)) / 65_536
        least = (latest * min(rate[0], 0.0) + delay[0] - (1.0 if self.box.clock.free else 0.0)) / unit
        most = (latest * max(rate[1], 0.0) + delay[1]) / unit
        cut = 0.0 if self.slope else 1.0 - 1.0 / unit
        held = self._held()
        shift = self.center / unit
        return -most - shift - held, -least + cut - shift + held

    def _off(self, side: Side) -> tuple[float, float]:
        """Least and greatest error of a converted parameter, over every stored one."""
        if not side.free:
            return 0.0, 0.0
        stored = np.arange(side.least, side.least + side.span + 1)
        scale = self._scales()[self.box.sides.index(side)]
        off = self.converted(side, stored) - (stored - side.least) * scale
        return float(off.min()), float(off.max())

    def _held(self) -> float:
        """What rounding a unit's parameters to steps of the block changes at most [codes]."""
        delay, clock = self.box.sides
        late = 0.5 / (delay.parameter.steps * 1e-6 * self.echoes.tick) if delay.free else 0.0
        latest = min(_TOP, self.echoes.last + 2 ** (16 - self.places))
        return (late + (latest * 0.5 / clock.parameter.steps if clock.free else 0.0)) / (1.0 - self._rate0())

    def error_um(self) -> float:
        """Bound of the error that the correction adds, over the box, all codes and all conditions [um]."""
        low, high = self._codes_off()
        error = max(-low, high) * self.echoes.slopes[1]
        if not self.slope:
            return error
        # the fraction has the mean slope, and the product is rounded down to a whole um
        unlike = max(abs(self.slope - slope) for slope in self.echoes.slopes)
        return error + unlike * (1.0 - 2.0**-self.places) + 1.0

    def corrected(self, codes: ArrayLike, delay: ArrayLike, rate: ArrayLike) -> tuple[Any, Any]:
        """Return the corrected echo codes and what is then taken off the output, as the C computes them.

        Delay and rate are the stored parameters of the unit; what is taken off is in um.
        """
        codes = np.asarray(codes, dtype=np.int64)
        speed = self.converted(self.box.clock, rate)
        more = ((codes * speed >> 16) + self.converted(self.box.delay, delay) + self.center) & _TOP
        rest = ((more & (2**self.places - 1)) * self.slope & _TOP) >> self.places
        return (codes - (more >> self.places)) & _TOP, rest

    def integers(self) -> dict[str, Any]:
        """Return the integers of the C, by the names that the templates have."""
        delay, clock = self.box.sides
        whole = self._whole_codes()
        bits = max(16, math.ceil(math.log2(whole * 256 + 1)) + 1)
        back = (1.0 - self._rate0()) * 2.0 ** (bits - 5)
        until = self.echoes.tick / 8 * (1.0 - self._rate0())
        return {
            "places": self.places,
            "center": self.center,
            "slope": self.slope,
            "mask": 2**self.places - 1,
            "delay": {**self._side(delay), "back": round(until * 8192)},
            "rate": {**self._side(clock), "back": round(back)},
            "most_more": 2**bits,
            "more_scale": 2 ** (30 - bits),
            "most_delay": math.ceil(whole) * 256,
        }

    def _side(self, side: Side) -> dict[str, int]:
        shift, factor = self._converted(side)
        default = side.parameter.stored(side.default)
        low = side.least & _TOP
        return {"low": low, "span": side.span, "default": default, "steps": default - side.least} | {
            "shift": shift,
            "factor": factor,
        }

    def _whole_codes(self) -> float:
        """The most that a unit adds to an echo code, and some room [codes]."""
        delay, rate = (int(self.converted(side, side.least + side.span)) for side in self.box.sides)
        return float((self.echoes.last * rate / 65_536 + delay) / 2**self.places * 1.1 + 2)
