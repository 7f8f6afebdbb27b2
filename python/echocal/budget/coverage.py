"""Expanded uncertainty, and what it decides: JCGM 100:2008, annex G, and JCGM 106:2012."""

import math
from math import inf
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.errors import UsageError
from echocal.keywords import keyword

COVERAGE = 0.9545
"""Coverage probability that gives k = 2 for a normal distribution."""

DECISIONS = ("conforms", "undecided", "does not conform")
_CUT = 0.01
"""Part of an uncertainty that rounding may cut off: 7.2.6 has 28.05 -> 28 (0.2 %) and 10.47 -> 11 (4 %)."""


def checked_coverage(coverage: float) -> float:
    """The coverage probability, if it can be one."""
    if not isinstance(coverage, Real) or not 0.0 < float(coverage) < 1.0:
        message = f"{keyword('coverage', coverage)} is no probability; give one between 0 and 1, such as 0.95"
        raise UsageError(message)
    return float(coverage)


def coverage_factor(degrees_of_freedom: Column | float, coverage: float = COVERAGE) -> Column:
    """Factor k of Student's t distribution for effective degrees of freedom.

    Examples
    --------
    >>> coverage_factor([10.0, np.inf]).round(2).tolist()
    [2.28, 2.0]
    """
    from scipy.special import ndtri, stdtrit  # takes long to import

    degrees = np.asarray(degrees_of_freedom, dtype=np.float64)
    upper = 0.5 + 0.5 * coverage
    with np.errstate(invalid="ignore"):
        return np.where(degrees == inf, ndtri(upper), stdtrit(np.minimum(degrees, 1e9), upper))


def conformity_probability(
    error: Column | float, uncertainty: Column | float, degrees_of_freedom: Column | float, bound: float
) -> Column:
    """Probability that a true error is within ``+-bound`` (JCGM 106:2012, 7.2), given what was measured.

    The measured error, 0 where none was measured, its standard uncertainty and the bound are in m.

    Examples
    --------
    >>> conformity_probability([0.0, 3e-3], 1.5e-3, np.inf, 3e-3).round(3).tolist()
    [0.954, 0.5]
    """
    from scipy.special import ndtr, stdtr  # takes long to import

    degrees, error = np.asarray(degrees_of_freedom, dtype=float), np.asarray(error, dtype=float)
    spread = np.asarray(uncertainty, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = [
            np.where(spread > 0.0, (end - error) / spread, np.sign(end - error) * inf)
            for end in (-bound, bound)
        ]
    finite = np.minimum(degrees, 1e9)
    below, up_to = (np.where(degrees == inf, ndtr(end), stdtr(finite, end)) for end in ends)
    return np.asarray(np.where(np.isnan(error), np.nan, up_to - below))


def decided(error: Column, expanded: Column, bound: float) -> NDArray[np.int64]:
    """Place in `DECISIONS` of each error, with a guard band as wide as the expanded uncertainty.

    It conforms where ``|error| <= bound - U`` (guarded acceptance, JCGM 106:2012, 8.3.2), and does not
    where ``|error| > bound + U`` (guarded rejection, 8.3.3). Between them the measurement does not decide.

    Examples
    --------
    >>> decided(np.array([1e-3, 2.5e-3, -5e-3]), np.full(3, 1e-3), 3e-3).tolist()
    [0, 1, 2]
    """
    size = np.abs(error)
    return np.where(size <= bound - expanded, 0, np.where(size > bound + expanded, 2, 1))


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
