"""Temperatures in whole steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.concise import percent
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.noises.common.kinds import Quantization
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.quantization_grid import find_grid

__all__ = ["NOISE"]


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this noise."""

    even: float = threshold(0.8, "1", "part of the steps of a sweep that are alike; judgement")
    turns: float = threshold(0.1, "1", "part of the steps of a sweep that change direction; judgement")
    coarsest: float = threshold(
        1.05, "K", "widest step of a thermometer: 1 K of a DHT11; the steps of a sweep are wider"
    )


FACTS = CauseFacts(
    id="temperature_quantization",
    kind="noise",
    sentence="The thermometer gives whole steps; the air between two steps is compensated wrong.",
    signature="temperatures are multiples of one step; variance that grows with the square of the distance",
    source="data sheets: DS18B20 0.0625 K, DHT11 1 K; LM35 on a 10-bit converter at 5 V 0.49 K",
    parameters=(Quantity("step", "K", "step of the temperatures", (0.0, 1.05), "any"),),
    check="list the different temperatures in the table",
    prior=0.1,
    formula="T' = step * round(T / step)",
    needs=("temperature",),
)


def detect(view: View, settings: NoiseSettings) -> Finding | None:
    """Find the step of the temperatures, unless they were set in a sweep."""
    own, recorded = settings.of(FACTS, Thresholds), view.temperature
    if recorded is None:
        return None
    kept = np.where(view.good, recorded, np.nan)
    grid = find_grid(kept)
    if grid is None or grid.step > own.coarsest or _sweep(kept[view.good], own):
        return None
    error = grid.step * _per_kelvin(view) / np.sqrt(12)
    variance = float(np.mean(error[view.good] ** 2))
    share = variance / max(view.scatter**2, variance)
    because = (
        f"all {grid.distinct} different temperatures are multiples of {grid.step:.4g} K, moving "
        f"the reading by {1e3 * np.sqrt(variance):.2g} mm (rms): {percent(share)} of the variance of noise"
    )
    parameters = (Parameter("step", grid.step, 0.0, "K"),)
    return Finding(
        FACTS, grid.evidence, because, parameters, view.observations.usable, None, share, variance**0.5
    )


def _sweep(recorded: NDArray[np.float64], own: Thresholds) -> bool:
    """Whether the temperatures were set: mostly in steps of one width that seldom turn back."""
    steps = np.diff(recorded)
    moved = steps[np.abs(steps) > 1e-9]
    if len(moved) < 2:
        return True
    width = float(np.median(np.abs(moved)))
    even = np.mean(np.abs(np.abs(moved) - width) < 1e-6 * width)
    turns = np.mean(np.diff(np.sign(moved)) != 0)
    return bool(even > own.even and turns < own.turns)


def _per_kelvin(view: View) -> NDArray[np.float64]:
    """Change of the reading with temperature [m/K], from the base's own conversion."""
    conditions = view.observations.conditions
    warmer = {**conditions, "temperature": conditions["temperature"] + 1.0}
    return np.asarray(view.base.indication(view.observations.echo_time, warmer) - view.indication)


def draw(table: Columns, random: np.random.Generator) -> None:
    """Give whole degrees; the reading is compensated with these."""
    true = random.uniform(5.0, 35.0, len(table["temperature_C"]))
    table["temperature_C"] = np.round(true)
    table["reading_m"] *= (331.4 + 0.6 * table["temperature_C"]) / (331.4 + 0.6 * true)


NOISE = Quantization(
    facts=FACTS, draw=draw, detect=detect, imitates=("noise_growth",), thresholds=Thresholds()
)
