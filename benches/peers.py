"""The rivals, each written as its users would write it, and the memory roof.

The formula stands here a second time on purpose: it is what somebody without echocal types.
"""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[Any]
CHUNK = 16_384


def cramer(t: Any, h: Any, p: Any, exp: Callable[[Any], Any] = np.exp, xc: float = 4e-4) -> Any:
    """Cramer 1993 with Davis 1992, as a plain expression."""
    k = t + 273.15
    saturated = exp(1.2378847e-5 * k * k - 1.9121316e-2 * k + 33.93711047 - 6343.1645 / k)
    xw = h * (1.00062 + 3.14e-8 * p + 5.6e-7 * t * t) * saturated / p
    return (
        331.5024
        + 0.603055 * t
        - 0.000528 * t * t
        + (51.471935 + 0.1495874 * t - 0.000782 * t * t) * xw
        + (-1.82e-7 + 3.73e-8 * t - 2.93e-10 * t * t) * p
        + (-85.20931 - 0.228525 * t + 5.91e-5 * t * t) * xc
        - 2.835149 * xw * xw
        - 2.15e-13 * p * p
        + 29.179762 * xc * xc
        + 0.000486 * xw * p * xc
    )


def numpy_naive(out: Array, time: Array, t: Array, h: Array, p: Array) -> None:
    """One expression over whole arrays."""
    np.multiply(0.5 * time, cramer(t, h, p), out=out)


def numpy_chunked(out: Array, time: Array, t: Array, h: Array, p: Array) -> None:
    """The same, in slices that stay in the cache."""
    for first in range(0, out.size, CHUNK):
        rows = slice(first, first + CHUNK)
        np.multiply(0.5 * time[rows], cramer(t[rows], h[rows], p[rows]), out=out[rows])


def numpy_linear_in_place(out: Array, time: Array, t: Array) -> None:
    """The study's law, its constants halved by hand, in three calls that write where the result belongs."""
    np.multiply(t, 0.3, out=out)
    np.add(out, 165.7, out=out)
    np.multiply(out, time, out=out)


_cramer_numba = njit(cramer)


@njit
def _exp(x: float) -> float:
    return math.exp(x)


@njit(nogil=True)
def _numba_distance(out: Array, time: Array, t: Array, h: Array, p: Array) -> None:
    for i in range(out.size):
        out[i] = 0.5 * time[i] * _cramer_numba(t[i], h[i], p[i], _exp)


@njit(nogil=True)
def _sum_of_four(out: Array, a: Array, b: Array, c: Array, d: Array) -> None:
    for i in range(out.size):
        out[i] = a[i] + b[i] + c[i] + d[i]


@njit(nogil=True)
def _sum_of_two(out: Array, a: Array, b: Array) -> None:
    for i in range(out.size):
        out[i] = a[i] + b[i]


def threaded(function: Callable[..., None], threads: int) -> Callable[..., None]:
    """Run a function on so many threads, each with its share of the rows; none spins while it waits."""
    if threads == 1:
        return function
    pool = ThreadPoolExecutor(threads)

    def call(*arguments: Array) -> None:
        share = -(-arguments[0].size // threads)
        parts = [slice(first, first + share) for first in range(0, arguments[0].size, share)]
        list(pool.map(lambda part: function(*(column[part] for column in arguments)), parts))

    return call


def numba_distance(threads: int) -> Callable[..., None]:
    """Numba's compiled loop."""
    return threaded(_numba_distance, threads)


def memory_of_five(threads: int) -> Callable[..., None]:
    """Read four arrays and write one, with the least arithmetic that does not vanish."""
    return threaded(_sum_of_four, threads)


def memory_of_three(threads: int) -> Callable[..., None]:
    """Read two arrays and write one."""
    return threaded(_sum_of_two, threads)


def pyfar_speed(t: Any, h: Any, p: Any) -> Any:
    """The published package with the same law; its arguments stay within 0..30 degC."""
    from pyfar.constants import speed_of_sound_cramer

    return speed_of_sound_cramer(t, h, 400.0, p)


def pyfar_distance(out: Array, time: Array, t: Array, h: Array, p: Array) -> None:
    """Distance by pyfar's speed of sound."""
    np.multiply(0.5 * time, pyfar_speed(t, h, p), out=out)
