"""Accepted echo times: none below the blanking distance, none that is a time-out."""

import math
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from echocal import _core
from echocal.codes import EchoCodes, codes_of, count
from echocal.errors import DomainWarning, UsageError
from echocal.keywords import keyword
from echocal.time_outs import LONGEST_US

__all__ = ["BLANKING_M", "Accepted", "accepted", "warn_of"]

BLANKING_M = 0.02
"""Least distance that an HC-SR04 measures [m]; its data sheet says 2 cm to 400 cm."""

_TIMEOUT = "the time-out pulse of an SRF04 or HC-SR04 without an echo, 36 to 38 ms,"

_BITS = (16, 32)
_CODES = {16: 65_535, 32: 2**24 - 1}  # codes above 0: of a uint16_t; those that are proven in a minute
_SLACK = 1e-9  # of a code; an echo time that is a code exactly stays that code

Echo = float | EchoCodes | tuple[float, ...] | None


@dataclass(frozen=True)
class Accepted:
    """Echo times that a device accepts."""

    tick: float  # of the timer [us]
    shortest: float  # [us]
    longest: float  # [us]
    bits: int = 16  # of the timer
    cut: str | None = None
    """The reason, if the default longest echo time is shorter than the echo from the largest distance."""

    @property
    def codes(self) -> tuple[float, float, float, int]:
        """Tick, shortest and longest [us], and bits of the timer, as the core takes them."""
        return self.tick, self.shortest, self.longest, self.bits


def accepted(model: _core.Model, request: Mapping[str, Any], echo: Echo) -> Accepted:
    """Return the echo times that a device accepts, by the request to the core without the echo.

    Defaults follow from the model: the earliest echo from `BLANKING_M`, and the latest echo from the largest
    bounded distance, over all conditions. The core refuses ends that are not codes. Raises `UsageError` if a
    default end leaves no echo time between the two.
    """
    asked = _asked(echo)
    tick, shortest, longest, bits = float(asked.lsb), asked.shortest, asked.longest, int(asked.bits)
    if asked.bits not in _BITS:
        raise UsageError(f"{keyword('bits', asked.bits)}: a timer has 16 or 32 bits in this version")
    if not (math.isfinite(tick) and tick > 0):
        return Accepted(tick, 0.0, LONGEST_US)
    if shortest is not None and longest is not None:
        return Accepted(tick, float(shortest), float(longest), bits)
    most = _most(tick, bits) if longest is None else float(longest)
    distances = [BLANKING_M, request["maximum_distance"]]
    soonest, latest = zip(*_core.echo_times(model, dict(request), distances), strict=True)
    first = _first(soonest[0] * 1e6, tick) if shortest is None else float(shortest)
    if longest is not None:
        if most <= first:
            raise UsageError(
                f"echo max {most:g} us ends before the echo from {BLANKING_M:g} m, the nearest that an "
                f"HC-SR04 measures, {first:g} us: give the echo min, too ({keyword('shortest')})"
            )
        return Accepted(tick, first, most, bits)
    last, cut = _last([time * 1e6 for time in latest], (tick, bits), most, distances)
    if last <= first:
        raise UsageError(
            _too_late(first, last, cut) if shortest is not None else _no_room(tick, distances[1], cut)
        )
    return Accepted(tick, first, last, bits, cut)


def _asked(echo: Echo) -> EchoCodes:
    """Return the requested codes. The core checks their range."""
    if echo is None:
        return EchoCodes()
    if isinstance(echo, EchoCodes | tuple):
        return codes_of("echo", EchoCodes, echo)
    return EchoCodes(1.0, float(count("echo", echo, 2**31 - 1)))


def _most(tick: float, bits: int) -> float:
    """Return the longest default echo time [us]: a code of the timer."""
    code = min(_CODES[bits], math.floor(LONGEST_US / tick + _SLACK))
    if code < 1:
        raise UsageError(
            f"a tick of {tick:g} us is longer than any echo, {LONGEST_US:g} us: give a finer one "
            f"({keyword('lsb')})"
        )
    return tick * code


def _first(near: float, tick: float) -> float:
    """Return the echo time [us] of the code that the shortest echo [us] gives, however the timer rounds.

    Never code 0, which is what Arduino's pulseIn() gives without an echo.
    """
    return tick * max(1, math.floor(near / tick + _SLACK)) if math.isfinite(near) else tick


def _last(
    latest: list[float], timer: tuple[float, int], most: float, distances: list[float]
) -> tuple[float, str | None]:
    """Return the echo time [us] of the code that the longest echo gives, however the timer rounds.

    At most `most` [us], and why it is cut, if it is. `latest` are the longest echo times [us] at the blanking
    distance and the largest one [m]; the timer has a tick [us] and bits.
    """
    (tick, bits), far, largest = timer, latest[1], distances[1]
    if not (math.isfinite(far) and far > 0):
        return most, f"echo times end at {most:g} us: the model has none at {largest:g} m"
    last = tick * math.ceil(far / tick - _SLACK)
    if last <= most:
        return last, None
    reach = BLANKING_M + (largest - BLANKING_M) * (most - latest[0]) / (far - latest[0])
    if tick * _CODES[bits] < LONGEST_US:
        wider = f"a timer of 32 bits ({keyword('bits', 32)}), " if bits == 16 else ""
        why = (
            f"a {bits}-bit timer with a tick of {tick:g} us ends there; {wider}a coarser tick "
            f"({keyword('lsb')}) or a shorter distance ({keyword('max_distance')}) mends that"
        )
    else:
        why = f"{_TIMEOUT} must not be returned as a distance; {keyword('longest')} accepts longer ones"
    return most, (
        f"echo times end at {most:g} us, before the requested largest distance: the echo from {largest:g} m "
        f"takes up to {far:.0f} us, and all are accepted up to {math.floor(reach * 100) / 100:g} m; {why}"
    )


def _too_late(first: float, last: float, cut: str | None) -> str:
    """Explain why a requested echo min leaves nothing below the default echo max."""
    end = cut or (
        f"the echo from the largest distance, {last:g} us, is the longest that is accepted "
        f"({keyword('max_distance')})"
    )
    return f"echo min {first:g} us leaves no echo: give a shorter one, or an echo max; {end}"


def _no_room(tick: float, largest: float, cut: str | None) -> str:
    """Explain why nothing is left between the two default ends."""
    if cut:
        return f"no echo from {BLANKING_M:g} m or more is accepted: {cut}"
    if largest < BLANKING_M:
        return (
            f"the largest distance, {largest:g} m, is nearer than {BLANKING_M:g} m, the blanking distance of "
            f"an HC-SR04: give a larger one ({keyword('max_distance')}) or, of a sensor that measures "
            f"nearer, the echo min ({keyword('shortest')})"
        )
    return (
        f"a tick of {tick:g} us is too coarse: the echoes from {BLANKING_M:g} m to {largest:g} m are a "
        f"single code; give a finer one ({keyword('lsb')})"
    )


def warn_of(times: Accepted, *, stacklevel: int) -> None:
    """Warn if a reading without an echo is accepted, or if its exclusion shortens the range."""
    for message in _doubts(times):
        warnings.warn(message, DomainWarning, stacklevel=stacklevel + 1)


def _doubts(times: Accepted) -> Iterator[str]:
    if times.shortest == 0:
        yield (
            "an echo time of 0 us is accepted: that is what Arduino's pulseIn() gives without an echo, and "
            "it is then returned as a distance; an echo min above 0 us refuses it"
        )
    if times.longest > LONGEST_US:
        yield (
            f"echo times to {times.longest:g} us are accepted: {_TIMEOUT} is then returned as a distance of "
            f"6.2 to 6.5 m; an echo max of {LONGEST_US:g} us or less refuses it"
        )
    if times.cut:
        yield times.cut
