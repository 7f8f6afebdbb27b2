"""The page of a firmware: what was proven, what it costs, and the forms among which it was chosen."""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from echocal.charts.parts import Axis, Chart, Line, Panel, span
from echocal.codes import value_at
from echocal.errors import DomainWarning, EchocalError
from echocal.firmware import Firmware
from echocal.model import Model
from echocal.pages.considered import Considered
from echocal.report.html.document import rendered

_ECHOES, _LINES = 300, 5
_MM, _US = 1e3, 1e6
_NOTES = (
    "output of the function less distance by the model, at five temperatures of the range, where further "
    "conditions are in the middle of theirs",
    "dotted: the requested bound",
    "the proof is over every input, not only over these",
)
_TONES = ("one", "two", "three", "four", "five")


def firmware_page(
    made: Firmware, model: Model, forms: Sequence[Considered], assumed: Mapping[str, float] | None = None
) -> str:
    """A firmware as an HTML document that needs no other file and no network.

    `forms` were tried; `assumed` are values of conditions that the device does not measure.
    """
    report = made.report
    name = report["provenance"]["target"]
    return rendered(
        "firmware.html.j2",
        "firmware",
        f"firmware for {name}",
        report=report,
        proven=f"{_MM * report['error_proven_m']:.4f}",
        asked=f"{_MM * report['error_bound_m']:g}",
        worst=_worst(report),
        inputs=f"{report['inputs_checked']:,}",
        facts=_facts(made),
        forms=[_row(one, made) for one in forms],
        why=_why(made, forms),
        error=_error(made, model, dict(assumed or {})),
        files=list(made.files),
        header=next((t for n, t in made.files.items() if n.endswith("echocal_correction.h")), ""),
    )


def _facts(made: Firmware) -> list[tuple[str, str]]:
    report = made.report
    facts = [("target", str(report["target"])), ("largest error", f"{_MM * report['error_proven_m']:.4f} mm")]
    for one in report["measured"]:
        unit = "instructions" if one["cycles"] is None else "cycles"
        facts.append((f"measured on {one['core']}", f"{one['flash_bytes']} bytes, {one[unit]} {unit}"))
    if not report["measured"]:
        flash, steps = made.ranked_by()
        facts.append(("by the cost model", f"{flash} bytes, {steps} {_unit(made)}"))
    return [*facts, ("tables", f"{report['table_bytes']} bytes")]


def _unit(made: Firmware) -> str:
    return "cycles" if made.report["target"] == "avr" else "instructions"


def _worst(report: Mapping[str, Any]) -> str:
    worst, axis = report["worst_input"], report["device"]["echo"]
    humidity = f", relative humidity {worst['relative_humidity']:g}" if "relative_humidity" in worst else ""
    return f"echo {worst[axis['name']] * axis['lsb'] * _US:g} us, {worst['temperature']:g} degC{humidity}"


def _row(one: Considered, made: Firmware) -> dict[str, str]:
    if one.made is None:
        return {"form": one.form, "error": "", "cost": "", "outcome": one.reason}
    flash, steps = one.made.ranked_by()
    chosen = _is(one, made)
    return {
        "form": str(one.made.report["form"]["description"]),
        "error": f"{_MM * one.made.report['error_proven_m']:.4f} mm",
        "cost": f"{flash} bytes, {steps} {_unit(made)}",
        "outcome": "chosen" if chosen else "meets the bound",
    }


def _is(one: Considered, made: Firmware) -> bool:
    same = ("form", "output_hash")  # two forms can give the same output for every input
    return one.made is not None and all(one.made.report[name] == made.report[name] for name in same)


def _why(made: Firmware, forms: Sequence[Considered]) -> str:
    meet = sum(one.made is not None for one in forms)
    if meet <= 1:
        return "It is the only form that was tried and meets the bound."
    least = "the fewest steps" if made.report["provenance"]["prefer"] == "speed" else "the least flash"
    if forms[0].made is not None and _is(forms[0], made):
        return f"Of {meet} forms that meet the bound it needs {least}, by the cost model of the search."
    return f"The request names the form; of {meet} forms that meet the bound another one needs {least}."


def _error(made: Firmware, model: Model, assumed: dict[str, float]) -> Chart | None:
    """Error of the function against the model, over the distance, at temperatures across the range."""
    device, most = made.report["device"], made.report["maximum_distance_m"]
    echo = np.unique(_codes(device["echo"], _ECHOES))
    thermometer, *others = device["conditions"]
    middle = {one["quantity"]: int(_codes(one, 3)[1]) for one in others}
    lines = []
    try:
        for code, tone in zip(_codes(thermometer, _LINES), _TONES, strict=True):
            air = {one["quantity"]: value_at(one, middle[one["quantity"]]) for one in others}
            celsius = value_at(thermometer, int(code))
            with warnings.catch_warnings():  # `generate` has told it
                warnings.simplefilter("ignore", DomainWarning)
                true = model.distance(echo * device["echo"]["lsb"], temperature=celsius, **{**assumed, **air})
            out = made.outputs(echo, int(code), *middle.values()) * device["output"]["lsb"]
            inside = true <= most
            lines.append(Line(f"{celsius:g} degC", tone, true[inside], _MM * (out - true)[inside]))
    except EchocalError:  # the model needs what neither the device nor the request gives
        return None
    bound = _MM * made.report["error_bound_m"]
    ends = span([line.x for line in lines])
    sides = [
        Line("requested bound", "out", np.array(ends), np.full(2, side), True) for side in (-bound, bound)
    ]
    y = Axis("error [mm]", -1.15 * bound, 1.15 * bound)
    return Chart(
        "Error against the model", Axis("distance [m]", *ends), [Panel("", y, [*lines, *sides])], _NOTES
    )


def _codes(axis: Mapping[str, Any], count: int) -> np.ndarray:
    return np.linspace(axis["codes"]["minimum"], axis["codes"]["maximum"], count).round().astype(np.int64)
