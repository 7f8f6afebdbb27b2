"""The loop closed on silicon: docs/closed-loop.md.

A device without a correction logs a table on the emulated board. The diagnosis makes a model of it, the model
becomes C, and the corrected device measures at other places in other air. ``python benches/closed_loop.py --write``
measures, and writes closed_loop.json, the page and the figure; without ``--write`` it prints. Some minutes.
"""

import json
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import typer
from closed_loop_page import FIGURE, PAGE, draw, page
from rich.console import Console
from rich.progress import track

import echocal
from echocal.emulation import TRUTH, Emulation
from echocal.virtual_bench.echo_time import echo_time

RESULTS = Path(__file__).with_name("closed_loop.json")
BASE = echocal.Model("virial")
"""What the device computes before it is corrected: the law that holds over this range at every humidity."""

WARM, DAMP, FAR = (0.0, 50.0), (0.2, 0.9), (0.1, 4.0)
"""Ranges of temperature [degC], relative humidity [1] and distance [m]."""

TRAINED, TESTED = 300, 400  # rows
LIMIT, REACH = 3e-3, 2.0  # m: the data sheet's error, and up to which distance it is judged
_IGNORED = {TRUTH: "ignore", "true_humidity": "ignore", "reading_m": "ignore"}
_FIRST, _SECOND = 1, 2  # seeds of the two campaigns


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
    """

    title: str
    detector: str
    seed: int | None


DEVICES = {
    "ideal": Device("ideal module, ideal thermometer and hygrometer", "ideal", None),
    "drawn": Device("ideal module, a TMP36 and a HIH-4030 with their tolerances", "ideal", 7),
    "comparator": Device("HC-SR04 with a comparator, ideal thermometer and hygrometer", "comparator", None),
    "both": Device(
        "HC-SR04 with a comparator, a TMP36 and a HIH-4030 with their tolerances", "comparator", 7
    ),
}


def rows(device: Device, campaign: int, count: int) -> pd.DataFrame:
    """Draw places, air and echoes of one campaign."""
    random = np.random.default_rng([campaign, count])
    warm, damp, far = (random.uniform(*bounds, count) for bounds in (WARM, DAMP, FAR))
    noise = int(random.integers(2**31))
    echo = echo_time(far, warm, damp, detector=device.detector, seed=noise)
    heard = np.isfinite(echo)
    table = pd.DataFrame(
        {"temperature_C": warm, "humidity_percent": 100.0 * damp, "distance_m": far, "echo_us": echo * 1e6}
    )
    return table[heard].reset_index(drop=True)


def measured(model: echocal.Model, device: Device, table: pd.DataFrame) -> Emulation:
    """Run the C of a model on the board."""
    with warnings.catch_warnings(action="ignore"):  # of what the model assumes: it is recorded here
        return echocal.emulate(model, table, humidity=True, seed=device.seed)


def loop(device: Device) -> dict[str, Any]:
    """Close the loop for one device."""
    logged = measured(BASE, device, rows(device, _FIRST, TRAINED))
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(logged.table, base=BASE, columns=_columns(logged.table))
    model = diagnosis.model
    fresh = rows(device, _SECOND, TESTED)
    study = echocal.emulate("study", fresh, seed=device.seed)
    before, after = measured(BASE, device, fresh), measured(model, device, fresh)
    causes = [cause.id for cause in diagnosis.causes if cause.in_model]
    return {
        "title": device.title,
        "verdict": diagnosis.verdict,
        "causes": causes,
        "effects": {name: dict(sizes) for name, sizes in model.effects.items()},
        "twin": _twin(after),
        "study": _errors(study, None),
        "before": _errors(before, BASE),
        "after": _errors(after, model),
    }


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
    if write:
        RESULTS.write_text(json.dumps(results, allow_nan=True) + "\n", encoding="utf-8")
        PAGE.write_text(page(results), encoding="utf-8")
        draw(results).savefig(FIGURE, dpi=110)
    else:
        sys.stdout.write(page(results))


if __name__ == "__main__":
    typer.run(main)
