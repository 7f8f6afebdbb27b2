"""The further input of a device: codes of one quantity beside temperature and humidity."""

from collections.abc import Collection
from typing import Any

from echocal.codes import FurtherCodes
from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.quantities import QUANTITIES

__all__ = ["further_of"]

_OWN = {"temperature": "temperature", "relative_humidity": "humidity", "echo_time": "echo"}


def further_of(request: FurtherCodes | str, reads: Collection[str]) -> FurtherCodes:
    """Return the codes of a further input, from such codes or from ``QUANTITY=LOW:HIGH:LSB[:ZERO[:SHIFT]]``.

    `reads` are the quantities that the model depends on. Raises `UsageError` if it is neither, if no device
    has codes of the quantity, or if nothing depends on it.

    Examples
    --------
    >>> further_of("supply_voltage=4.5:5.5:0.01", {"supply_voltage"})
    FurtherCodes(quantity='supply_voltage', lsb=0.01, low=4.5, high=5.5, zero=0.0, shift=0)
    """
    found = request if isinstance(request, FurtherCodes) else _read(request)
    if found.quantity in _OWN:
        way_out = f"give its codes as {keyword(_OWN[found.quantity])}"
        raise UsageError(f"{keyword('further')} is {found.quantity}, which is no further input: {way_out}")
    if found.quantity not in QUANTITIES:
        known = ", ".join(name for name in QUANTITIES if name not in _OWN)
        raise UsageError(
            f"{keyword('further')} is {found.quantity!r}, and no quantity has this name: give one of {known}"
        )
    if found.quantity not in reads:
        others = ", ".join(name for name in QUANTITIES if name in reads and name not in _OWN)
        raise UsageError(
            f"{keyword('further')} is {found.quantity}, and nothing in the model depends on it: leave it out"
            + (f", or give one of {others}" if others else "")
        )
    return found


def _read(text: Any) -> FurtherCodes:
    try:
        name, _, rest = text.partition("=")
        low, high, lsb, *more = (float(one) for one in rest.split(":"))
        return FurtherCodes(name, lsb, low, high, *(int(one) if i else one for i, one in enumerate(more)))
    except (AttributeError, TypeError, ValueError):
        raise UsageError(
            f"{keyword('further')} is {text!r}: give QUANTITY=LOW:HIGH:LSB, and after that the value of code "
            "0 and the bits to drop where they are not 0, as in supply_voltage=4.5:5.5:0.01; or give "
            "FurtherCodes(...)"
        ) from None
