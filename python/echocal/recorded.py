"""The command line that makes the files of a firmware again."""

from collections.abc import Mapping
from typing import Any

from echocal.keywords import command_line, exact

__all__ = ["WIDEST", "recorded_command"]

WIDEST = 64
"""Bits of the widest integer, unless the user says it."""


def recorded_command(
    request: Mapping[str, Any],
    model_name: str,
    assume: Mapping[str, float],
    uncertainties: list[str],
    measure: bool,
    recorded: Mapping[str, Any],
) -> str:
    """Return the command line that makes the same files again."""
    tick, shortest, longest, bits = request["echo"]
    package, unit = request["package"], request["output_unit"]
    window, gate = request["median"] or (None, None)
    options: dict[str, Any] = dict(
        target=request["target"],
        **_codes("temperature", request["temperature"], stepped=request["thermistor"] is None),
        **_codes("humidity", request["humidity"]),
        further=_further(request["further"]),
        echo_lsb_us=None if tick == 1.0 else tick,
        echo_bits=None if bits == 16 else bits,
        echo_min_us=shortest,
        echo_max_us=longest,
        max_error_mm=_millimeters(request["maximum_error"]),
        output_unit=None if unit == "um" else unit,
        output_type=request["output_type"],
        max_distance_m=request["maximum_distance"],
        prefer=request["prefer"],
        form=request["form"] or None,
        max_table_bytes=request["maximum_table"],
        median=window,
        gate_mm=None if gate is None else _millimeters(gate),
        max_bits=None if request["widest"] == WIDEST else request["widest"],
        package=None if package == "c" else package,
        name=None if request["name"] == "echocal" else request["name"],
        accept=request["accept"],
        assume=[f"{name}={exact(value)}" for name, value in sorted(assume.items())],
        uncertainty=uncertainties,
        measure=measure,
        out="firmware",
    )
    return command_line("firmware", model_name, **{**options, **recorded})


def _millimeters(size: float) -> float:
    """The shortest number of millimeters that reads back to a size [m], as the command reads it."""
    texts = (float(f"{size * 1e3:.{digits}g}") for digits in range(1, 18))
    return next((text for text in texts if text * 1e-3 == size), size * 1e3)


def _further(further: tuple[str, tuple[float, float, float, float, int]] | None) -> str | None:
    """The option of a further input; none if there is none."""
    if further is None:
        return None
    quantity, (lsb, low, high, zero, shift) = further
    texts = [exact(one) for one in (low, high, lsb)]
    texts += [exact(zero), *([str(shift)] if shift else [])] if zero or shift else []
    return f"{quantity}={':'.join(texts)}"


def _codes(
    name: str, codes: tuple[float, float, float, float, int] | None, *, stepped: bool = True
) -> dict[str, Any]:
    """Options of the codes of a quantity; none if it is not measured."""
    if codes is None:
        return {}
    lsb, low, high, zero, shift = codes
    return {
        f"{name}_lsb": lsb if stepped else None,
        f"{name}_range": f"{exact(low)}:{exact(high)}",
        f"{name}_zero": zero or None,
        f"{name}_shift": shift or None,
    }
