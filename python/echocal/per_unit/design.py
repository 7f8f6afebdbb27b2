"""Firmware that takes the parameters of its unit: one function, and what corrects its echo code."""

import itertools
import json
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.codes import EchoCodes
from echocal.device_uncertainty import rounded_up
from echocal.errors import BoundError, DomainWarning, UsageError
from echocal.firmware import Firmware, generate
from echocal.keywords import keyword
from echocal.model import Model
from echocal.per_unit.block import VERSION
from echocal.per_unit.box import Box
from echocal.per_unit.layout import Echoes, Layout

_SHARE = 0.5
"""Largest share of the error bound that whole echo codes may take; above it the fraction is taken off the
output. Set by hand: it leaves the function as much."""
_BEYOND = 1e-3  # m; the function underneath is bounded so much farther, for echo codes that are rounded up
_STRAIGHT = 1e-12  # s; rounding of an echo time of 24 ms in double precision is far below
_ECHO_BITS = 16
_OUT_OF_RANGE = -(2**31)


@dataclass(frozen=True)
class UnitFirmware(Firmware):
    """A generated function that takes the parameters of its unit, with its proof and its bit-exact twin.

    Attributes
    ----------
    files, report
        As of `echocal.firmware.Firmware`; ``echocal_unit.h`` and ``echocal_unit.c`` beside the function, and
        ``report["per_unit"]``.
    layout : Layout
        The integers of the correction.
    """

    layout: Layout

    @property
    def box(self) -> Box:
        """The allowed parameters of a unit."""
        return self.layout.box

    def unit_outputs(
        self,
        echo: ArrayLike,
        temperature_code: ArrayLike,
        humidity_code: ArrayLike | None = None,
        *,
        delay: ArrayLike,
        rate: ArrayLike,
    ) -> NDArray[np.int32]:
        """Return the outputs of ``echocal_unit_distance_um``, bit for bit.

        Parameters
        ----------
        echo, temperature_code, humidity_code : array_like of int, shape (...)
            As of `outputs`.
        delay, rate : array_like of int
            Parameters of the unit as its block holds them.

        Returns
        -------
        ndarray of int32, shape (...)
            Distance [um]; the smallest ``int32`` for codes out of range.
        """
        codes, rest = self.layout.corrected(echo, delay, rate)
        found = self.outputs(codes, temperature_code, humidity_code)
        return np.where(found == _OUT_OF_RANGE, found, found - rest).astype(np.int32)


def generate_per_unit(
    model: Model,
    per_unit: Iterable[str] | Mapping[str, tuple[float, float]],
    target: str = "c99",
    *,
    max_error: float = 0.5e-3,
    max_distance: float = 4.0,
    output_unit: str = "um",
    package: str = "c",
    **request: Any,
) -> UnitFirmware:
    """Design a function that takes the parameters of its unit, proven for every unit in a box.

    Parameters
    ----------
    model : Model
        The model of all units. Its own parameters are those of a unit without a valid block.
    per_unit : iterable of str, or mapping of str to (low, high)
        Effects whose parameter units differ in, ``"fixed_delay"`` and ``"clock_error"``, each with its ends:
        ``"fixed_delay=0:1e-4"`` [s]; default: 50 us or 0.0019 on both sides of the model's.
    target, max_error, max_distance, output_unit, package, **request
        As of `echocal.firmware.generate`. `max_error` holds for every unit in the box.

    Returns
    -------
    UnitFirmware

    Raises
    ------
    BoundError
        If no form meets `max_error`.
    UsageError
        If the box is invalid, an effect of the model keeps the echo time from being a straight line over the
        distance, or `package` or `output_unit` is one without unit data.

    Examples
    --------
    >>> from echocal import Model
    >>> from echocal.per_unit import generate_per_unit
    >>> model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    >>> made = generate_per_unit(model, ["fixed_delay", "clock_error"], temperature=(0.5, -20, 60))
    >>> made.report["per_unit"]["error_proven_m"] < 0.5e-3
    True
    """
    _refuse(package, output_unit, request.get("echo"))
    if request.get("further") is not None:
        raise UsageError(
            f"unit data are not proven beside a further input: leave out {keyword('further')} or "
            f"{keyword('per_unit')}"
        )
    box = Box.around(model, per_unit)
    least = box.least(model)
    told = {"per_unit": box.texts(), "max_error_mm": max_error * 1e3, "max_distance_m": max_distance}
    common = {"max_distance": max_distance + _BEYOND, "recorded": told, **request}
    made = generate(least, target, max_error=max_error, **common)
    layout, share = _layout(made, box, model, max_error)
    if made.report["error_proven_m"] + share > max_error:
        left = max_error - share
        if left <= 0.0:
            raise BoundError(_no_room(max_error, share, made.report["device"]["echo"]))
        made = generate(least, target, max_error=left, **common)
    return _with_units(made, layout, share, max_error, max_distance, model)


def _refuse(package: str, output_unit: str, echo: EchoCodes | None) -> None:
    if echo is not None and echo.bits != _ECHO_BITS:
        raise UsageError(
            f"unit data correct echo codes of {_ECHO_BITS} bits, and the timer has {echo.bits}: choose "
            f"{keyword('bits', _ECHO_BITS)}"
        )
    if package != "c":
        raise UsageError(f"the package {package} has no unit data: choose {keyword('package', 'c')}")
    if output_unit != "um":
        raise UsageError(
            f"unit data correct more finely than {output_unit}: choose {keyword('output_unit', 'um')}, "
            "and round the output"
        )


def _layout(made: Firmware, box: Box, model: Model, max_error: float) -> tuple[Layout, float]:
    """Return the layout, and the error that it adds [m]."""
    echoes = _echoes(made)
    bytewise = made.report["target"] == "avr"
    lag = _lag(made, box, model) * 1e6 / echoes.tick * echoes.slopes[1]  # um
    whole = Layout.of(box, echoes, fine=False, bytewise=bytewise)
    share = (whole.error_um() + lag) * 1e-6
    if share <= _SHARE * max_error:
        return whole, share
    fine = Layout.of(box, echoes, fine=True, bytewise=bytewise)
    return fine, (fine.error_um() + lag) * 1e-6


def _echoes(made: Firmware) -> Echoes:
    """Return the echo codes of a function, and the slopes over all its conditions, from its own outputs."""
    device = made.report["device"]
    first, last = device["echo"]["codes"]["minimum"], device["echo"]["codes"]["maximum"]
    spans = [_steps(axis) for axis in device["conditions"]]
    conditions = [codes.ravel() for codes in np.meshgrid(*spans, indexing="ij")]
    near, far = (made.outputs(code, *conditions) for code in (first, last))
    chord = (far.astype(float) - near) / (last - first)
    # The function lies within its bound of the model, whose distance is a straight line in the echo code.
    off = 2e6 * made.report["error_overall_m"] / (last - first)
    return Echoes(device["echo"]["lsb"] * 1e6, last, (float(chord.min()) - off, float(chord.max()) + off))


def _steps(axis: Mapping[str, Any]) -> NDArray[np.int64]:
    """Return the first code of each step; all codes of a step give the same output."""
    return np.arange(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1, 1 << axis.get("shift", 0))


def _lag(made: Firmware, box: Box, model: Model) -> float:
    """Return how far the corrected echo time of a unit is from that of the least unit at most [s].

    Zero but for rounding, unless an effect changes an echo time after the parameters of the unit do, such as
    a clock whose error depends on the temperature. Computed at the corners of the box.
    """
    left_out = {one["effect"] for one in made.report["omissions"]}
    kept = {id_: own for id_, own in model.effects.items() if id_ not in left_out}
    base = Model(model.law, kept, air=model.air, columns=model.given_columns)
    warm, *_ = made.report["device"]["conditions"]
    ends = np.linspace(warm["codes"]["minimum"], warm["codes"]["maximum"], 9) * warm["lsb"] + warm["zero"]
    far = made.report["maximum_distance_m"] * np.array([[0.0], [0.02], [0.3], [1.0]])
    distance, temperature = np.broadcast_arrays(far, ends)
    conditions: dict[str, Any] = {**_conditions(made), "temperature": temperature}

    def times(of: Model) -> NDArray[np.float64]:
        with warnings.catch_warnings():  # those of the law's domain were given with the function
            warnings.simplefilter("ignore", DomainWarning)
            return np.asarray(of.time_of_flight(distance, **conditions))

    least = box.least(base)
    known = times(least)
    _refuse_bent(model, known - (known[0] + (known[-1] - known[0]) * far / far[-1]))
    delay0, rate0 = (side.parameter.linear(side.parameter.of(least)) for side in box.sides)
    lag = 0.0
    for corner in itertools.product(*({side.low, side.high} for side in box.sides)):
        delay, rate = (side.parameter.linear(value) for side, value in zip(box.sides, corner, strict=True))
        found = times(with_parameters(base, box, corner))
        expected = (found * (1.0 - rate) - delay + delay0) / (1.0 - rate0)
        lag = max(lag, float(np.abs(expected - known).max()))
    return lag


def _refuse_bent(model: Model, off: NDArray[np.float64]) -> None:
    """Raise `UsageError` where echo times are off a straight line over the distance [s]."""
    if np.abs(off).max() > _STRAIGHT:
        raise UsageError(
            f"with the effects {', '.join(model.effects)} the echo time is no straight line over the "
            f"distance ({np.abs(off).max() * 1e6:.3g} us), and unit data are not proven: leave the effect "
            f"that bends it out of the model, or leave out {keyword('per_unit')}"
        )


def _conditions(made: Firmware) -> dict[str, float]:
    """Return the conditions that a function assumes or measures beside the temperature, in the middle."""
    at = {one["quantity"]: one["assumed"] for one in made.report["omissions"] if one["assumed"] is not None}
    for axis in made.report["device"]["conditions"][1:]:
        middle = (axis["codes"]["minimum"] + axis["codes"]["maximum"]) / 2
        at[axis["quantity"]] = middle * axis["lsb"] + axis["zero"]
    return at


def with_parameters(model: Model, box: Box, values: Iterable[float]) -> Model:
    """Return a model with other parameters of the unit, delay and frequency error."""
    effects = {id_: dict(own) for id_, own in model.effects.items()}
    for side, value in zip(box.sides, values, strict=True):
        effects[side.parameter.effect] = {side.parameter.name: value}
    return Model(model.law, effects, air=model.air, columns=model.given_columns)


def _no_room(max_error: float, share: float, echo: Mapping[str, Any]) -> str:
    return (
        f"an error of {max_error * 1e3:g} mm cannot be met for every unit of the box: the parameters of a "
        f"unit alone add up to {rounded_up(share * 1e3):g} mm, with echo codes of {echo['lsb'] * 1e6:g} us. "
        f"Allow a larger error, a narrower box ({keyword('per_unit', 'EFFECT=LOW:HIGH')}) or a finer tick "
        f"({keyword('lsb')})"
    )


def _with_units(
    made: Firmware, layout: Layout, share: float, asked: float, distance: float, model: Model
) -> UnitFirmware:
    proven = made.report["error_proven_m"]
    per_unit = {
        "error_bound_m": asked,
        "error_proven_m": proven + share,
        "error_of_the_function_m": proven,
        "error_of_the_unit_data_m": share,
        "maximum_distance_m": distance,
        "model_hash": model.hash,
        "block_version": VERSION,
        "box": {side.parameter.key: [side.low, side.high] for side in layout.box.sides if side.free},
        "law": model.law,
    }
    numbers = layout.integers()
    numbers |= {
        "generator": made.report["provenance"]["version"],
        "block_version": VERSION,
        "block_bytes": 12,
        "box": [side.words() for side in layout.box.sides if side.free],
        "maximum_distance": f"{distance:g}",
        "error_mm": f"{rounded_up((proven + share) * 1e3):.4f}",
        "asked_mm": f"{asked * 1e3:.9g}",
        "shares": _shares(made, layout, share),
        "least_apart": (layout.echoes.last - made.report["device"]["echo"]["codes"]["minimum"]) // 4,
        "natural": made.report["reach_m"]["sometimes"][0] >= 0.0,
    }
    report = {**made.report, "per_unit": per_unit}
    text = json.dumps(report, indent=2, sort_keys=True) + "\n"
    files = {**made.files, **dict(made._twin.unit_files(json.dumps(numbers))), "report.json": text}
    return UnitFirmware(files, report, made._twin, layout)


def _shares(made: Firmware, layout: Layout, share: float) -> list[str]:
    kind = "echo codes with a fraction" if layout.slope else "whole echo codes"
    return [
        f"the function underneath: {rounded_up(made.report['error_proven_m'] * 1e3):.4f} mm",
        f"the correction in {kind}, with every rounding: {rounded_up(share * 1e3):.4f} mm",
    ]
