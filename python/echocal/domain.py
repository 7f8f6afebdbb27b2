"""Domains of the laws: a code for each row, or one warning; values are never clamped."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal import _core
from echocal.conditions import numbers
from echocal.errors import DomainWarning, UsageError
from echocal.quantities import AIR, DEFAULTS

__all__ = ["DOMAIN_VIOLATIONS", "counting", "describe", "domain_violations", "warn_outside"]

DOMAIN_VIOLATIONS: tuple[str, ...] = tuple(_core.departure_names())
"""The quantity outside its range, by code of `domain_violations`; empty for a row inside the domain."""


_Counts = dict[str, tuple[int, int, float]]
_COUNTS: ContextVar[tuple[_Counts, set[str | None]] | None] = ContextVar("counts", default=None)


@contextmanager
def counting() -> Iterator[_Counts]:
    """Count rows outside of domains, in place of a warning, in this thread; each law is looked at once.

    Yields
    ------
    dict of str to (int, int, float)
        By domain in words, ``law 'cramer' holds for temperature 0 .. 30 degC``: rows outside, place of the
        first one, and its value.
    """
    counts: _Counts = {}
    token = _COUNTS.set((counts, set()))
    try:
        yield counts
    finally:
        _COUNTS.reset(token)


_NAMES = (*AIR, "frequency")


def _arrays(*values: ArrayLike) -> list[NDArray[np.float64]]:
    return [numbers(name, value) for name, value in zip(_NAMES, values, strict=True)]


def domain_violations(
    temperature: ArrayLike,
    relative_humidity: ArrayLike = DEFAULTS["relative_humidity"],
    pressure: ArrayLike = DEFAULTS["pressure"],
    co2_mole_fraction: ArrayLike = DEFAULTS["co2_mole_fraction"],
    *,
    law: str | None = "cramer",
    frequency: ArrayLike = 0.0,
) -> NDArray[np.uint8]:
    """Find the rows in which a law is used outside its domain.

    Parameters
    ----------
    temperature : array_like
        Air temperature [degC].
    relative_humidity : array_like
        Relative humidity over liquid water [1], 0 to 1.
    pressure : array_like
        Air pressure [Pa].
    co2_mole_fraction : array_like
        Mole fraction of carbon dioxide [1].
    law : str or None
        Name of a law; None asks for the domain of absorption alone.
    frequency : array_like
        Frequency [Hz]; above zero, the domain of the dispersion counts too.

    Returns
    -------
    ndarray of uint8
        For every row, of the broadcast shape, 0 where the law holds, else the position in
        `DOMAIN_VIOLATIONS` of the first quantity that lies outside.

    Raises
    ------
    ModelError
        If there is no such law.
    UsageError
        If an input does not hold numbers, or the shapes do not broadcast.

    References
    ----------
    Cramer 1993, doi:10.1121/1.405827; ISO 9613-1:1993, section 7.

    Examples
    --------
    >>> import echocal
    >>> codes = echocal.domain_violations([20.0, 45.0, 70.0], 0.9, law="cramer")
    >>> [echocal.DOMAIN_VIOLATIONS[code] for code in codes]
    ['', 'water_vapor_mole_fraction', 'temperature']
    """
    values = _arrays(temperature, relative_humidity, pressure, co2_mole_fraction, frequency)
    try:
        broadcast = np.broadcast_arrays(*values)
    except ValueError:
        shapes = ", ".join(str(value.shape) for value in values)
        raise UsageError(
            f"shapes do not broadcast: {shapes} (temperature, humidity, pressure, CO2, frequency)"
        ) from None
    flat = [np.ascontiguousarray(value).reshape(-1) for value in broadcast]
    return _core.departures(law, flat).reshape(broadcast[0].shape)


def warn_outside(
    temperature: ArrayLike,
    relative_humidity: ArrayLike = DEFAULTS["relative_humidity"],
    pressure: ArrayLike = DEFAULTS["pressure"],
    co2_mole_fraction: ArrayLike = DEFAULTS["co2_mole_fraction"],
    *,
    law: str | None = "cramer",
    frequency: ArrayLike = 0.0,
    stacklevel: int = 1,
) -> None:
    """Warn once if any row lies outside the law's domain; rows that are NaN are not counted.

    Parameters are those of `domain_violations`; `stacklevel` 1 names the caller, 2 its caller. Rows count
    from 1 in C order of the broadcast shape, as rows of tables do in every message. Every
    limit is monotone in each input, so two corners clear columns of any length without a pass over
    all combinations.

    Examples
    --------
    >>> from echocal.domain import warn_outside
    >>> warn_outside([10.0, 20.0], 0.5)
    """
    counted = _COUNTS.get()
    if _unheard() if counted is None else law in counted[1]:
        return
    if counted is not None:
        counted[1].add(law)
    values = _arrays(temperature, relative_humidity, pressure, co2_mole_fraction, frequency)
    if min(value.size for value in values) == 0:
        return
    lowest = [_extreme(np.fmin, value) for value in values]
    highest = [_extreme(np.fmax, value) for value in values]
    sound = values[4][values[4] != 0.0]  # at frequency zero nothing disperses
    lowest[4] = _extreme(np.fmin, sound) if sound.size else 0.0
    # water and frequency over pressure are largest where the pressure is lowest
    lowest[2], highest[2] = highest[2], lowest[2]
    if _core.departure(law, lowest) is None and _core.departure(law, highest) is None:
        return
    codes = domain_violations(*values[:4], law=law, frequency=values[4])
    outside = np.flatnonzero(codes > DOMAIN_VIOLATIONS.index("not_a_number"))
    if outside.size == 0:
        return
    first = int(outside[0])
    row = [float(value.flat[first]) for value in np.broadcast_arrays(*values)]
    if counted is not None:
        domain, _, value = describe(law, row, "").partition(": : ")
        counted[0].setdefault(domain, (outside.size, first, float(value.partition(";")[0])))
        return
    where = f"{outside.size} of {codes.size} rows lie outside, first at row {first + 1} (row 1 is the first)"
    message = f"{describe(law, row, where)} (echocal.domain_violations gives every row)"
    warnings.warn(message, DomainWarning, stacklevel=stacklevel + 1)


def _unheard() -> bool:
    """Whether such warnings are ignored, whatever they say and wherever they come from."""
    for action, message, category, module, line in warnings.filters:
        if issubclass(DomainWarning, category):
            return action == "ignore" and message is None and module is None and not line
    return False


def _extreme(which: np.ufunc, values: NDArray[np.float64]) -> float:
    if values.ndim == 0:
        return float(values)
    # several times as fast, and NaN only where one of the values is
    plain = float((np.minimum if which is np.fmin else np.maximum).reduce(values, axis=None))
    return plain if plain == plain else float(which.reduce(values, axis=None))


def describe(law: str | None, row: list[float], where: str) -> str:
    """Describe how a row is outside the domain, with value and limits; empty if it is inside.

    Parameters
    ----------
    law : str or None
        Name of a law; None is absorption.
    row : list of float
        Temperature [degC], relative humidity [1], pressure [Pa], CO2 mole fraction [1],
        frequency [Hz].
    where : str
        Position of the row, for a reader who does not see it.

    Examples
    --------
    >>> from echocal.domain import describe
    >>> describe("virial", [70.0, 0.0, 101325.0, 4e-4, 0.0], "outside at noon")
    "law 'virial' holds for temperature -20 .. 60 degC: outside at noon: 70"
    """
    finding = _core.departure(law, row)
    if finding is None:
        return ""
    name, value, low, high, unit = finding
    unit = "" if unit == "1" else f" {unit}"
    what = "absorption" if law is None else f"law {law!r}"
    message = f"{what} holds for {name} {low:g} .. {high:g}{unit}: {where}: {value:g}"
    wet = law == "cramer" and name == "water_vapor_mole_fraction"
    return f"{message}; law 'virial' holds there" if wet else message
