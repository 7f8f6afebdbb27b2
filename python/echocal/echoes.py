"""Echo times that a device accepts: none below its blanking distance, none that is a time-out."""

import math
import warnings
from collections.abc import Iterator, Mapping
from typing import Any

from echocal import _core
from echocal.codes import EchoCodes, codes_of, count
from echocal.errors import DomainWarning, UsageError

__all__ = ["BLANKING", "accepted", "warn_of_no_echo"]

BLANKING = 0.02
"""Least distance that an HC-SR04 measures [m]; its data sheet says 2 cm to 400 cm."""

# Without an echo a module reports a pulse, too, its time-out: an SRF04 one of "about 36 ms" (technical
# documentation of its maker), an HC-SR04 one of 38 ms (data sheet). Those of copies are longer or, on
# forum.arduino.cc 613370, shorter; some never end (forum.arduino.cc 55119).
_TIMEOUT = "the time-out pulse of an SRF04 or HC-SR04 without an echo, 36 to 38 ms,"
_LONGEST = 35_000.0  # us; the shorter of these less 3 % for the module's clock
_SLACK = 1e-9  # of a code; an echo time that is a code exactly stays that code

Echo = float | EchoCodes | tuple[float, ...] | None


def accepted(model: _core.Model, wish: Mapping[str, Any], echo: Echo) -> tuple[float, float, float]:
    """Return tick, shortest and longest echo time [us] that a device accepts.

    Parameters
    ----------
    model : _core.Model
        The model that the firmware follows.
    wish : mapping
        What is asked of the core, but for the echo.
    echo : float, EchoCodes, tuple or None
        What was asked for; what it leaves open follows from the model: an echo from `BLANKING` in the
        conditions where that is the shortest, one from the largest bounded distance where it is the longest.

    Returns
    -------
    tuple of float
        Tick, shortest, longest [us].

    Raises
    ------
    UsageError
        If these are no codes, or nothing is left between the two ends.
    """
    asked = _asked(echo)
    tick, shortest, longest = asked.lsb, asked.shortest, asked.longest
    if shortest is None or longest is None:
        bound = min(_LONGEST, 65_535 * tick) if longest is None else longest
        distances = [BLANKING, wish["maximum_distance"]]
        (near, _), (_, far) = _core.echo_times(model, {**wish, "echo": (tick, 0.0, bound)}, distances)
        shortest = _first(near, tick, longest) if shortest is None else shortest
        longest = _last(far, tick) if longest is None else longest
    return float(tick), float(shortest), float(longest)


def _asked(echo: Echo) -> EchoCodes:
    """Return what was asked for; what range makes sense, the core says."""
    if echo is None:
        return EchoCodes()
    if isinstance(echo, EchoCodes | tuple):
        return codes_of("echo", EchoCodes, echo)
    return EchoCodes(1.0, float(count("echo", echo, 2**31 - 1)))


def _first(near: float, tick: float, longest: float | None) -> float:
    """Return the echo time [us] of the code that the shortest echo [s] gives, however the timer rounds.

    Never code 0, which is what Arduino's pulseIn() gives without an echo.
    """
    shortest = tick * max(1, math.floor(near * 1e6 / tick + _SLACK)) if math.isfinite(near) else tick
    if longest is not None and 0 < longest <= shortest:
        message = (
            f"echo max {longest:g} us ends before the echo from {BLANKING:g} m, the nearest that an HC-SR04 "
            f"measures, {shortest:g} us: give the echo min, too (--echo-min-us, EchoCodes(shortest=...))"
        )
        raise UsageError(message)
    return shortest


def _last(far: float, tick: float) -> float:
    """Return the echo time [us] of the code that the longest echo [s] gives, however the timer rounds."""
    if not (math.isfinite(far) and 0 < far * 1e6 < _LONGEST):
        return _LONGEST
    return tick * math.ceil(far * 1e6 / tick - _SLACK)


def warn_of_no_echo(echo: Echo, shortest: float, longest: float, *, stacklevel: int) -> None:
    """Warn where what is reported without an echo is accepted, or keeps a distance out; times in [us]."""
    for message in _without_echo(echo, shortest, longest):
        warnings.warn(message, DomainWarning, stacklevel=stacklevel + 1)


def _without_echo(echo: Echo, shortest: float, longest: float) -> Iterator[str]:
    if shortest == 0:
        yield (
            "an echo time of 0 us is accepted: that is what Arduino's pulseIn() gives without an echo, and "
            "it is then returned as a distance; an echo min above 0 us refuses it"
        )
    if longest > _LONGEST:
        yield (
            f"echo times to {longest:g} us are accepted: {_TIMEOUT} is then returned as a distance of 6.2 to "
            f"6.5 m; an echo max of {_LONGEST:g} us or less refuses it"
        )
    elif longest == _LONGEST and _asked(echo).longest is None:
        yield (
            f"echo times end at {_LONGEST:g} us, before the largest distance asked for: {_TIMEOUT} must not "
            "be returned as a distance; --echo-max-us, in Python echo=, accepts longer ones"
        )
