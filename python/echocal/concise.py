"""Numbers as people read them: the one place that decides their digits."""

import math

__all__ = ["concise", "decimal", "percent"]

_EXACT = 1e-9  # of the value: a smaller uncertainty is what arithmetic leaves, and no measurement has it
_DIGITS = 6  # of a value without uncertainty
_ONE_DIGIT = (0.355, 0.95)  # of a power of ten: between them an uncertainty has one digit, else two
_DECIMAL = (1e-4, 1e7)  # magnitudes that are written without a power of ten


def concise(value: float, uncertainty: float = 0.0, unit: str = "") -> str:
    """A value with its standard uncertainty in the notation of GUM 7.2.2: ``79.9(5) us``.

    The digits in parentheses are the standard uncertainty of the last digits of the value. It has one or two
    digits, as the Particle Data Group rounds: two if it begins with 10 to 35, else one.

    Parameters
    ----------
    value : float
        The value, in `unit`.
    uncertainty : float
        Its standard uncertainty, in `unit`; 0 where it has none.
    unit : str
        The unit; empty for the unit one.

    Examples
    --------
    >>> concise(79.92, 0.51, "us"), concise(78.57, 7.2, "us"), concise(12.31, 1.24)
    ('79.9(5) us', '79(7) us', '12.3(1.2)')
    >>> concise(0.67491, 2.2e-16, "mm"), concise(12345.0, 678.0), concise(3.16e-7, 1e-8)
    ('0.67491 mm', '12300(700)', '3.16(10)e-7')
    """
    return f"{_number(float(value), abs(float(uncertainty)))} {unit}".rstrip()


def decimal(value: float, digits: int = 3) -> str:
    """A value with at least so many significant digits, and no power of ten where people read none.

    Examples
    --------
    >>> decimal(1013.25), decimal(99.96, 2), decimal(0.00012345), decimal(-0.0)
    ('1013', '100', '0.000123', '0')
    """
    value = float(value) + 0.0  # no negative zero
    if not math.isfinite(value) or (value and not _DECIMAL[0] <= abs(value) < _DECIMAL[1]):
        return f"{value:.{digits}g}"
    text = f"{value:.{max(0, digits - 1 - _power(value))}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def percent(part: float) -> str:
    """A part of one in per cent: ``100 %``, ``0.4 %``.

    Examples
    --------
    >>> percent(0.998), percent(0.0042), percent(1.0)
    ('100 %', '0.4 %', '100 %')
    """
    shown = 100.0 * part
    return f"{shown:.0f} %" if abs(shown) >= 1.0 or shown == 0.0 else f"{decimal(shown, 1)} %"


def _number(value: float, uncertainty: float) -> str:
    if not math.isfinite(value) or not math.isfinite(uncertainty):
        return f"{decimal(value, 4)}(?)" if math.isfinite(value) else f"{value:g}"
    if uncertainty <= _EXACT * abs(value):
        return decimal(value, _DIGITS)
    largest = max(abs(value), uncertainty)
    if not _DECIMAL[0] <= largest < _DECIMAL[1]:
        power = _power(largest)
        return f"{_number(value / 10.0**power, uncertainty / 10.0**power)}e{power}"
    above = uncertainty / 10.0 ** (_power(uncertainty) + 1)  # 0.1 to 1
    place = _power(uncertainty) - (not _ONE_DIGIT[0] <= above < _ONE_DIGIT[1]) + (above >= _ONE_DIGIT[1])
    decimals = max(0, -place)
    shown, digits = round(value, -place) + 0.0, round(uncertainty, -place)
    if digits >= 1.0 or not decimals:
        return f"{shown:.{decimals}f}({digits:.{decimals}f})"
    return f"{shown:.{decimals}f}({digits * 10.0**decimals:.0f})"


def _power(value: float) -> int:
    """Power of ten of the first digit."""
    return math.floor(math.log10(abs(value))) if value else 0
