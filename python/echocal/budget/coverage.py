"""Expanded uncertainty, and what it decides: JCGM 100:2008, annex G, and JCGM 106:2012."""

from math import inf
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.keywords import keyword

__all__ = [
    "COVERAGE",
    "DECISIONS",
    "checked_coverage",
    "conformity_probability",
    "coverage_factor",
    "decided",
]

Column = NDArray[np.float64]

COVERAGE = 0.9545
"""Coverage probability that gives k = 2 for a normal distribution."""

DECISIONS = ("conforms", "undecided", "does not conform")


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

    Parameters
    ----------
    error : ndarray
        Measured error [m]; 0 where none was measured.
    uncertainty : ndarray
        Its standard uncertainty [m].
    bound : float
        Maximum permissible error [m].

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
