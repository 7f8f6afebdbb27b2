"""Printed numbers: the values that round to them, and what can follow from these."""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Printed", "reach"]

Array = NDArray[np.float64]
SLACK = 1e-9  # of half a digit: a number that lies on the edge rounds either way


@dataclass(frozen=True)
class Printed:
    """A number as printed: every value that rounds to it is meant.

    Examples
    --------
    >>> printed = Printed("2.071")
    >>> printed.low, printed.high
    (2.0705, 2.0715)
    >>> printed.holds(2.0713), printed.holds(2.0716)
    (True, False)
    """

    text: str  # the number as printed, e.g. ``"2.071"`` or ``"6.13e-6"``.

    @property
    def value(self) -> float:
        """The number itself."""
        return float(self.text)

    @property
    def half(self) -> float:
        """Half a unit of the last printed digit."""
        exponent = Decimal(self.text).as_tuple().exponent
        return float(Decimal(1).scaleb(int(exponent)) / 2)

    @property
    def low(self) -> float:
        """Smallest value that rounds to it."""
        return float(Decimal(self.text) - Decimal(repr(self.half)))

    @property
    def high(self) -> float:
        """Largest value that rounds to it."""
        return float(Decimal(self.text) + Decimal(repr(self.half)))

    def holds(self, value: float) -> bool:
        """Whether a value rounds to it."""
        return self.meets(value, value)

    def meets(self, low: float, high: float) -> bool:
        """Whether some value between two bounds rounds to it."""
        slack = SLACK * self.half
        return low <= self.high + slack and high >= self.low - slack


def reach(function: Callable[[Array], float], center: Array, half: Array) -> tuple[float, float]:
    """Find the range of a function over everything that rounds to its printed arguments.

    Follows the signs of the derivatives to a corner of the box, until they no longer change. Both
    ends are values that the function takes in the box, so what lies between them is reachable;
    where the function is monotone in each argument, as here over half a digit, they are its
    extremes.

    Parameters
    ----------
    function : callable
        Takes the arguments, shape (n,).
    center : ndarray, shape (n,)
        The arguments as printed.
    half : ndarray, shape (n,)
        Half a unit of the last printed digit of each.

    Returns
    -------
    tuple of float
        Lowest and highest value reached.

    Examples
    --------
    >>> reach(lambda x: float(x.sum()), np.array([1.0, 2.0]), np.array([0.5, 0.5]))
    (2.0, 4.0)
    """
    return _corner(function, center, half, -1.0), _corner(function, center, half, 1.0)


def _corner(function: Callable[[Array], float], center: Array, half: Array, sign: float) -> float:
    best = at = center
    for _ in range(10):
        slopes = np.array([_slope(function, at, half, index) for index in range(len(center))])
        at = center + sign * np.sign(slopes) * half
        if sign * (function(at) - function(best)) <= 0.0:
            break
        best = at
    return function(best)


def _slope(function: Callable[[Array], float], at: Array, half: Array, index: int) -> float:
    step = np.zeros_like(at)
    step[index] = 0.1 * half[index]
    return function(at + step) - function(at - step)
