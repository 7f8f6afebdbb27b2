"""The loop closed on silicon: docs/closed-loop.md.

A device without a correction logs a table on the emulated board. The diagnosis makes a model of it, the model
becomes C, and the corrected device measures at other places in other air.
``python benches/closed_loop.py --write``
measures, and writes closed_loop.json, the page and the figure; without ``--write`` it prints. It takes some
minutes.
"""

import json
import math
import re
import sys
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import typer
from closed_loop_page import FIGURE, PAGE, draw, page
from rich.console import Console
from rich.progress import track
from sklearn.ensemble import HistGradientBoostingRegressor

import echocal
from echocal.emulation import TRUTH, Emulation
from echocal.emulation.package import package_of
from echocal.errors import BoundError
from echocal.firmware import Firmware
from echocal.registry import find_effect
from echocal.virtual_bench.echo_time import echo_time

RESULTS = Path(__file__).with_name("closed_loop.json")
BASE = echocal.Model("virial")
"""What the device computes before it is corrected: the law that holds over this range at every humidity."""

WARM, DAMP, FAR = (0.0, 50.0), (0.2, 0.9), (0.1, 4.0)
"""Ranges of temperature [degC], relative humidity [1] and distance [m]."""

NEAR = 2.2
"""Distance up to which a module with a comparator logs [m]: a little more than where it is judged."""

TRAINED, TESTED = 300, 400  # rows
LIMIT, REACH = 3e-3, 2.0  # m: the data sheet's error, and up to which distance it is judged
_IGNORED = {TRUTH: "ignore", "true_humidity": "ignore", "reading_m": "ignore"}
_FIRST, _SECOND = 1, 2  # seeds of the two campaigns
LEARNED = 30_000  # readings that trees learn from
PINGS = (1, 9)
_AIR = ["temperature_C", "humidity_percent", "distance_m"]


@dataclass(frozen=True)
class Device:
    """A device.

    Attributes
    ----------
    title : str
    detector : str
        Of the module, as of `echocal.virtual_bench.echo_time`.
    seed : int or None
        Draws its thermometer and hygrometer; None: ideal parts.
    trained : float
        Distance up to which it logs [m].
    """

    title: str
    detector: str
    seed: int | None
    trained: float = FAR[1]


DEVICES = {
    "ideal": Device("ideal module, ideal thermometer and hygrometer", "ideal", None),
    "drawn": Device("ideal module, a TMP36 and a HIH-4030 with their tolerances", "ideal", 7),
    "comparator": Device(
        "HC-SR04 with a comparator, ideal thermometer and hygrometer", "comparator", None, NEAR
    ),
}


def rows(device: Device, campaign: int, count: int, longest: float = FAR[1], pings: int = 1) -> pd.DataFrame:
    """Draw places, air and echoes of one campaign; an echo time is the median of some pings."""
    random = np.random.default_rng([campaign, count])
    warm, damp, far = (random.uniform(*bounds, count) for bounds in (WARM, DAMP, (FAR[0], longest)))
    noise = int(random.integers(2**31))
    each = (np.repeat(values, pings) for values in (far, warm, damp))
    echo = np.median(echo_time(*each, detector=device.detector, seed=noise).reshape(count, pings), axis=1)
    heard = np.isfinite(echo)
    table = pd.DataFrame(
        {"temperature_C": warm, "humidity_percent": 100.0 * damp, "distance_m": far, "echo_us": echo * 1e6}
    )
    return table[heard].reset_index(drop=True)


@cache
def base() -> Firmware:
    """Generate the library of the device before it is corrected."""
    return library(BASE)


def refused(model: echocal.Model) -> list[str]:
    """Name the effects of a model that have no form in C."""
    return [name for name in model.effects if find_effect(name).firmware == "refused"]


def library(model: echocal.Model, far: float = FAR[1], **bound: float) -> Firmware:
    """Generate the Arduino library of a model, without the effects that have no form in C; it is proven."""
    with warnings.catch_warnings(action="ignore"):  # of what the model assumes: it is recorded here
        return package_of(model, "TMP36", humidity=True, accept=refused(model), max_distance=far, **bound)


def shipped(model: echocal.Model, far: float) -> Firmware:
    """Generate the library within the usual bound, or within the least that the refusal names."""
    try:
        return library(model, far)
    except BoundError as told:
        least = re.search(r"ask for ([\d.]+) mm", str(told))
        if least is None:
            raise
        return library(model, far, max_error=1e-3 * float(least[1]))


def measured(made: Firmware, device: Device, table: pd.DataFrame) -> Emulation:
    """Run the C of a model on the board."""
    with warnings.catch_warnings(action="ignore"):
        return echocal.emulate(made, table, seed=device.seed)


def diagnosed(found: Emulation) -> echocal.Diagnosis:
    """Diagnose what the device printed, and the true distances."""
    with warnings.catch_warnings(action="ignore"):
        return echocal.diagnose(found.table, base=BASE, columns=_columns(found.table))


def loop(device: Device) -> dict[str, Any]:
    """Close the loop for one device."""
    diagnosis = diagnosed(measured(base(), device, rows(device, _FIRST, TRAINED, device.trained)))
    model = diagnosis.model
    fresh = rows(device, _SECOND, TESTED)
    study = echocal.emulate("study", fresh, seed=device.seed)
    made = shipped(model, device.trained)
    before, after = measured(base(), device, fresh), measured(made, device, fresh)
    return {
        "title": device.title,
        "trained_to_m": device.trained,
        "verdict": diagnosis.verdict,
        "effects": {name: dict(sizes) for name, sizes in model.effects.items()},
        "bound_mm": round(1e3 * made.report["error_proven_m"], 4),
        "left_out": refused(model),
        "twin": _twin(after),
        "study": _errors(study, None),
        "before": _errors(before, BASE),
        "after": _errors(after, model),
        "everywhere": _everywhere(device, before) if device.trained < FAR[1] else None,
    }


def _everywhere(device: Device, before: Emulation) -> dict[str, Any]:
    """Return what the model of a log over all distances would make, in floating point, of the same rows."""
    model = diagnosed(measured(base(), device, rows(device, _FIRST, TRAINED))).model
    table = before.table
    air = {
        "temperature": table["temperature_C"].to_numpy(),
        "relative_humidity": table["humidity_percent"].to_numpy() / 100.0,
    }
    with warnings.catch_warnings(action="ignore"):
        reading = model.distance(table["echo_us"].to_numpy() * 1e-6, **air)
    error = np.round(1e3 * (reading - before.inputs.distance), 3)
    try:
        library(model)
        best = None
    except BoundError as error:
        told = re.search(r"best reachable is ([\d.]+) mm", str(error))
        best = float(told[1]) if told else math.nan
    return {
        "best_error_mm": best,
        "effects": {name: dict(sizes) for name, sizes in model.effects.items()},
        "distance_m": np.round(before.inputs.distance, 4).tolist(),
        "error_mm": error.tolist(),
    }


def ceiling(pings: int) -> float:
    """Return the share within the limit that a correction by distance and air could reach.

    Trees learn the error of the comparator from many readings with the true distance and the true air, and
    are judged on others. Each reading is the median of some pings.
    """
    device = DEVICES["comparator"]
    learned, judged = (rows(device, campaign, LEARNED, REACH, pings) for campaign in (_FIRST, _SECOND))
    trees = HistGradientBoostingRegressor(max_iter=400, learning_rate=0.05, random_state=0)
    trees.fit(learned[_AIR], _raw(learned))
    left = _raw(judged) - trees.predict(judged[_AIR])
    return float((np.abs(left) <= LIMIT).mean())


def _raw(table: pd.DataFrame) -> np.ndarray:
    """Error of the uncorrected law in the true air [m]."""
    air = {"temperature": table["temperature_C"], "relative_humidity": table["humidity_percent"] / 100.0}
    with warnings.catch_warnings(action="ignore"):
        found = BASE.distance(table["echo_us"] * 1e-6, **air)
    return np.asarray(found - table["distance_m"])


def _columns(table: pd.DataFrame) -> dict[str, str]:
    return {name: told for name, told in _IGNORED.items() if name in table}


def _twin(found: Emulation) -> list[int]:
    """Count the rows that are equal to the twin's output, and all rows with a distance."""
    made, table = found.firmware, found.table
    assert made is not None
    told = table["reading_m"].notna().to_numpy()
    axes = (made.report["device"]["echo"], *made.report["device"]["conditions"])
    columns = (table["echo_us"] * 1e-6, table["temperature_C"], table["humidity_percent"] / 100.0)
    codes = [
        np.round((values.to_numpy()[told] - one["zero"]) / one["lsb"]).astype(int)
        for one, values in zip(axes, columns, strict=True)
    ]
    twin = np.asarray(made.outputs(*codes))
    own = np.round(table["reading_m"].to_numpy()[told] * 1e6).astype(int)
    return [int((twin == own).sum()), int(told.sum())]


def _errors(found: Emulation, model: echocal.Model | None) -> dict[str, Any]:
    """Errors of the readings, and their parts, rounded to a micrometer [mm]."""
    error = found.errors()["reading_m"]
    kept: dict[str, Any] = {
        "distance_m": np.round(found.inputs.distance, 4).tolist(),
        "error_mm": np.round(error * 1e3, 3).tolist(),
    }
    if model is not None:
        parts = echocal.error_parts(found, model) * 1e3
        kept["parts_mm"] = {str(name): np.round(parts[name], 3).tolist() for name in parts}
    return kept


def main(write: bool = False, devices: str = ",".join(DEVICES)) -> None:
    """Close the loop for each device."""
    console = Console(stderr=True)
    shown = track(devices.split(","), "closing the loop", console=console, disable=not console.is_terminal)
    results = {"limit_m": LIMIT, "reach_m": REACH, "trained": TRAINED, "devices": {}}
    for name in shown:
        results["devices"][name] = loop(DEVICES[name])
    if "comparator" in results["devices"]:
        results["ceiling"] = {"learned": LEARNED, "pings": PINGS, "share": [ceiling(one) for one in PINGS]}
    if write:
        RESULTS.write_text(json.dumps(results, allow_nan=True) + "\n", encoding="utf-8")
        PAGE.write_text(page(results), encoding="utf-8")
        draw(results).savefig(FIGURE, dpi=110)
    else:
        sys.stdout.write(page(results))


if __name__ == "__main__":
    typer.run(main)
