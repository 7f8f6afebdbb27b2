"""Numbers with their expanded uncertainty, rounded as JCGM 100:2008, 7.2.6 asks."""

import math

__all__ = ["plus_minus", "rounded_up"]

_CUT = 0.01
"""Part of an uncertainty that rounding may cut off: 7.2.6 has 28.05 -> 28 (0.2 %) and 10.47 -> 11 (4 %)."""


def rounded_up(uncertainty: float, digits: int = 2) -> tuple[float, int]:
    """An uncertainty with so many significant digits, and the power of ten of the last one.

    It is rounded to the nearest, but up where this would cut off more than 1 %.

    Examples
    --------
    >>> rounded_up(10.47), rounded_up(28.05), rounded_up(0.0999)
    ((11.0, 0), (28.0, 0), (0.1, -2))
    """
    exponent = math.floor(math.log10(uncertainty)) + 1 - digits
    steps = uncertainty / 10.0**exponent
    whole = round(steps)
    if steps - whole > _CUT * steps:
        whole += 1
    if whole >= 10**digits:
        whole, exponent = round(whole / 10), exponent + 1
    return float(f"{whole}e{exponent}"), exponent


def plus_minus(value: float, uncertainty: float, unit: str = "") -> str:
    """A value and its expanded uncertainty, both to the same digit; without one, three decimals.

    Examples
    --------
    >>> plus_minus(2.003871, 0.001234, "m"), plus_minus(-3.10393, 0.0, "mm")
    ('2.0039 ± 0.0013 m', '-3.104 mm')
    """
    if not (uncertainty > 0.0 and math.isfinite(uncertainty) and math.isfinite(value)):
        return f"{round(value, 3) + 0.0:.6g} {unit}".rstrip()
    size, exponent = rounded_up(uncertainty)
    decimals = max(-exponent, 0)
    return f"{round(value, -exponent):.{decimals}f} ± {size:.{decimals}f} {unit}".rstrip()
