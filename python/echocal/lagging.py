"""Firmware for a thermometer that lags: a function with a state gives the code of the air."""

import json
import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from echocal.codes import value_at
from echocal.device_uncertainty import rounded_up
from echocal.errors import DomainWarning, UsageError
from echocal.firmware import Firmware, generate
from echocal.keywords import keyword
from echocal.model import Model

__all__ = ["Follower", "LagFirmware", "generate_lagging"]

EFFECT = "temperature_lag"
_PLACES = 16  # binary places of the smoothed code, and of the share of the gap
_WORD = 32
_SMOOTHING = 4.0  # times faster than the thermometer by default, and noise is so often larger; set by hand
_SAME = 1e-9  # m; rounding of a distance in double precision is far below
_GOLDEN = 256
_NONE = -(2**31)


@dataclass(frozen=True)
class Follower:
    """The integers of the recursion ``smoothed += share * (code - smoothed)``, and what is added to the code.

    The rate of the smoothed code times what the thermometer lags more than the output does is added. In real
    numbers a thermometer of the time constant `lag` then gives the air with the time constant `smoothing`.

    Attributes
    ----------
    first, last : int
        Accepted codes.
    lag, interval, smoothing : float
        Time constant of the thermometer, time between two calls, time constant of the output [s].
    """

    first: int
    last: int
    lag: float
    interval: float
    smoothing: float

    @property
    def places(self) -> int:
        """Binary places of the smoothed code."""
        return min(_PLACES, _WORD - 1 - (self.last - self.first).bit_length())

    @property
    def share(self) -> int:
        """Part of the gap that a call closes [2^-16]."""
        return round(-math.expm1(-self.interval / self.smoothing) * 65_536)

    @property
    def drop(self) -> int:
        """Bits of the gap that its product with the share leaves out."""
        gap = (self.last - self.first) << self.places
        return max(0, gap.bit_length() + self.share.bit_length() - _WORD)

    @property
    def _exact_ratio(self) -> float:
        return (self.lag - self.smoothing) / self.interval

    @property
    def _most(self) -> int:
        """The largest move of a call [2^-places codes]."""
        gap = (self.last - self.first) << self.places
        return (gap >> self.drop) * self.share >> (_PLACES - self.drop)

    @property
    def _ratio_bits(self) -> int:
        return min(16, 16 - math.ceil(math.log2(self._exact_ratio)))

    @property
    def ratio(self) -> int:
        """What the output is ahead of the code, for a move of the smoothed one, with its binary places."""
        return min(2**16 - 1, round(self._exact_ratio * 2.0**self._ratio_bits))

    @property
    def lead_drop(self) -> int:
        """Bits of the move that its product with the ratio leaves out; one bit is left for rounding."""
        return max(0, self._most.bit_length() + self.ratio.bit_length() - (_WORD - 1))

    @property
    def lead_shift(self) -> int:
        """Binary places of that product."""
        return self.places + self._ratio_bits - self.lead_drop

    def error(self) -> float:
        """Bound of the difference to the recursion in real numbers, over every sequence of codes [codes].

        Each call moves too little, by less than `short`. An error of the smoothed code shrinks by the share
        in each call, so all of them together are below ``short / share``.
        """
        unit, share = 2.0**self.places, self.share / 2.0**_PLACES
        short = (2.0**self.drop * share + 1.0) / unit if self.drop else 1.0 / unit
        ratio = self.ratio / 2.0**self._ratio_bits
        late = short / share  # of the smoothed code
        moved = share * late + short
        dropped = (2.0**self.lead_drop - 1.0) / unit
        unlike = abs(ratio - self._exact_ratio) * share * (self.last - self.first)
        return ratio * (moved + dropped) + unlike + 0.5

    def refuse_times(self) -> None:
        """Raise `UsageError` where a time constant cannot be followed."""
        if not 0.0 < self.interval <= self.smoothing < self.lag:
            raise UsageError(
                f"a thermometer that lags {self.lag:g} s, a call every {self.interval:g} s and an output "
                f"that lags {self.smoothing:g} s: give 0 < {keyword('lag_interval')} <= "
                f"{keyword('lag_smoothing')} < the time constant of the thermometer"
            )

    def refuse_wide(self) -> None:
        """Raise `UsageError` where an integer would leave 32 bits."""
        if self.share < 1 or not 0 < self.lead_shift < _WORD or self.drop > _PLACES:
            raise UsageError(
                f"a call every {self.interval:g} s is too often for a time constant of {self.smoothing:g} s "
                f"in 32 bits: give a longer {keyword('lag_interval')}"
            )

    def exact(self, codes: Iterable[int]) -> list[float]:
        """Return the outputs of the recursion in real numbers, from a new state [codes]."""
        share, found, smoothed = self.share / 2.0**_PLACES, [], None
        for code in codes:
            smoothed = float(code) if smoothed is None else smoothed
            move = share * (code - smoothed)
            smoothed += move
            found.append(code + self._exact_ratio * move)
        return found

    def outputs(self, codes: Iterable[int]) -> list[int]:
        """Return the outputs of ``echocal_air_code`` for codes in order, from a new state, bit for bit.

        Parameters
        ----------
        codes : iterable of int
            Temperature codes, one for each interval.

        Returns
        -------
        list of int
            Codes of the air; the smallest ``int32`` where there is none.

        Examples
        --------
        >>> Follower(-320, 960, 300.0, 10.0, 60.0).outputs([320, 324, 328, 328])
        [320, 339, 355, 351]
        """
        smoothed, found = None, []
        for code in codes:
            index = code - self.first
            if not 0 <= index <= self.last - self.first:
                found.append(_NONE)
                continue
            wanted = index << self.places
            smoothed = wanted if smoothed is None else smoothed
            sign, gap = (1, wanted - smoothed) if wanted >= smoothed else (-1, smoothed - wanted)
            move = (gap >> self.drop) * self.share >> (_PLACES - self.drop)
            lead = ((move >> self.lead_drop) * self.ratio + (1 << self.lead_shift >> 1)) >> self.lead_shift
            smoothed += sign * move
            air = index + sign * lead
            found.append(air + self.first if 0 <= air <= self.last - self.first else _NONE)
        return found


@dataclass(frozen=True)
class LagFirmware(Firmware):
    """A generated function of the air's temperature, and the function that gives its code.

    Attributes
    ----------
    files, report
        As of `echocal.firmware.Firmware`; ``echocal_air.h``, ``echocal_air.c``, ``echocal_air_golden.csv``
        and ``report["temperature_lag"]`` beside them.
    follower : Follower
        The integers of the recursion, and its twin.
    """

    follower: Follower


def generate_lagging(
    model: Model,
    lag_interval: float,
    target: str = "c99",
    *,
    lag_smoothing: float | None = None,
    package: str = "c",
    **request: Any,
) -> LagFirmware:
    """Design a function of the air's temperature, and one that gives it from a thermometer that lags.

    Parameters
    ----------
    model : Model
        A model with the effect ``temperature_lag``.
    lag_interval : float
        Time between two codes of the thermometer [s].
    target, package, **request
        As of `echocal.firmware.generate`.
    lag_smoothing : float, optional
        Time constant of the output [s]; default: a fourth of the thermometer's, and at least the interval.

    Returns
    -------
    LagFirmware

    Raises
    ------
    UsageError
        If the model has no such effect, or another one that depends on the thermometer in a way that the
        state does not follow; if times or codes do not fit.

    Examples
    --------
    >>> from echocal import Model
    >>> model = Model("cramer", {"temperature_lag": {"time_constant": 240.0}})
    >>> made = generate_lagging(model, 10.0, temperature=(0.0625, -20, 60))
    >>> round(made.report["temperature_lag"]["error_proven_K"], 3) < 0.05
    True
    """
    lag = model.effects.get(EFFECT, {}).get("time_constant", 0.0)
    if lag <= 0.0:
        raise UsageError(f"the model has no effect {EFFECT}: leave out {keyword('lag_interval')}")
    if package != "c":
        raise UsageError(
            f"the package {package} keeps no state of a thermometer: choose {keyword('package', 'c')}"
        )
    smoothing = max(lag / _SMOOTHING, lag_interval) if lag_smoothing is None else float(lag_smoothing)
    Follower(0, 1, lag, float(lag_interval), smoothing).refuse_times()
    kept = {id_: dict(own) for id_, own in model.effects.items() if id_ != EFFECT}
    of_air = Model(model.law, kept, air=model.air, columns=model.given_columns)
    told = {"lag_interval_s": lag_interval, "lag_smoothing_s": lag_smoothing}
    made = generate(of_air, target, package=package, recorded=told, **request)
    warm = made.report["device"]["conditions"][0]
    if warm.get("shift") or "values" in warm:
        raise UsageError(
            "a lag is followed for codes of equal steps of which no bit is dropped: give such codes"
        )
    _refuse_unlike(model, of_air, lag, made)
    follower = Follower(
        warm["codes"]["minimum"], warm["codes"]["maximum"], lag, float(lag_interval), smoothing
    )
    follower.refuse_wide()
    return _with_state(made, follower, model)


def _refuse_unlike(model: Model, of_air: Model, lag: float, made: Firmware) -> None:
    """Raise `UsageError` where the model at a rate is not the model without lag at the air's temperature."""
    device = made.report["device"]
    at: dict[str, Any] = {
        axis["quantity"]: value_at(axis, axis["codes"]["maximum"]) for axis in device["conditions"][1:]
    }
    at |= {one["quantity"]: one["assumed"] for one in made.report["omissions"] if one["assumed"] is not None}
    ends = [value_at(device["conditions"][0], code) for code in device["conditions"][0]["codes"].values()]
    warm = np.linspace(min(ends), max(ends), 9)
    rate = 1.0 / lag  # K/s
    time = device["echo"]["lsb"] * device["echo"]["codes"]["maximum"]
    with warnings.catch_warnings(action="ignore", category=DomainWarning):  # told of the code ranges
        late = model.distance(time, temperature=warm, temperature_rate=rate, **at)
        off = float(np.abs(late - of_air.distance(time, temperature=warm + lag * rate, **at)).max())
    if not off <= _SAME:
        raise UsageError(
            f"with the effects {', '.join(model.effects)} a lag of 1 K is not the same as air that is 1 K "
            f"warmer ({off * 1e3:.3g} mm): leave the effect of the thermometer beside the lag out of the "
            "model"
        )


def _with_state(made: Firmware, follower: Follower, model: Model) -> LagFirmware:
    device = made.report["device"]
    step = abs(device["conditions"][0]["lsb"])
    far = _per_code(made)
    error = follower.error()
    lag = {
        "time_constant_s": follower.lag,
        "interval_s": follower.interval,
        "smoothing_s": follower.smoothing,
        "error_proven_codes": error,
        "error_proven_K": error * step,
        "error_m": error * far,
        "model_hash": model.hash,
    }
    share = follower.share / 2.0**_PLACES
    numbers = {name: getattr(follower, name) for name in ("places", "share", "drop", "ratio", "lead_drop")}
    numbers |= {
        "lead_shift": follower.lead_shift,
        "half": 1 << follower.lead_shift >> 1,
        "generator": made.report["provenance"]["version"],
        "lag": f"{follower.lag:g}",
        "interval": f"{follower.interval:g}",
        "interval_ms": round(follower.interval * 1e3),
        "smoothing": f"{follower.smoothing:g}",
        "amplified": f"{1.0 + share * (follower.lag - follower.smoothing) / follower.interval:.2g}",
        "error_codes": f"{rounded_up(error, 3):g}",
        "error_K": f"{rounded_up(error * step):g}",
        "error_mm": f"{rounded_up(error * far * 1e3, 3):g}",
        "maximum_distance": f"{made.report['maximum_distance_m']:g}",
    }
    report = {**made.report, EFFECT: lag}
    name = made.report["name"]
    files = {
        **made.files,
        **dict(made._twin.air_files(json.dumps(numbers))),
        f"{name}_air_golden.csv": _golden(follower),
        "report.json": json.dumps(report, indent=2, sort_keys=True) + "\n",
    }
    return LagFirmware(files, report, made._twin, follower)


def _per_code(made: Firmware) -> float:
    """Return the most that one temperature code changes the largest distance [m]."""
    axes = made.report["device"]["conditions"]
    codes = np.arange(axes[0]["codes"]["minimum"], axes[0]["codes"]["maximum"] + 1)
    others = {
        "humidity_code" if axis["quantity"] == "relative_humidity" else "further_code": axis["codes"][
            "maximum"
        ]
        for axis in axes[1:]
    }
    last = made.report["device"]["echo"]["codes"]["maximum"]
    outputs = made.outputs(last, codes, **others).astype(float) * made.report["device"]["output"]["lsb"]
    scale = np.minimum(1.0, made.report["maximum_distance_m"] / outputs)
    wide = min(16, len(codes) - 1) or 1
    return (
        float((np.abs(outputs[wide:] - outputs[:-wide]) * scale[wide:]).max() / wide)
        if len(codes) > 1
        else 0.0
    )


def _golden(follower: Follower) -> str:
    """Return a sequence of codes with the outputs: settled, steps to both ends, ramps, refused codes."""
    first, last = follower.first, follower.last
    middle, quarter = (first + last) // 2, max(1, (last - first) // 4)
    ramp = [middle + quarter * step // 64 for step in range(64)]
    swing = [middle + round(quarter * math.sin(step / 7.0)) for step in range(96)]
    codes = [middle] * 8 + ramp + ramp[::-1] + swing + [first] * 8 + [last] * 8 + [first - 1, last + 1]
    codes = (codes + [middle] * _GOLDEN)[:_GOLDEN]
    pairs = zip(codes, follower.outputs(codes), strict=True)
    return "temperature_code,air_code\n" + "".join(f"{code},{air}\n" for code, air in pairs)
