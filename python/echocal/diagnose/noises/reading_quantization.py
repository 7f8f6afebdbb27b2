"""Readings in whole steps."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.concise import percent
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.noises.common.kinds import Quantization
from echocal.diagnose.noises.common.truncation import Truncation, cut_off
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.observations.quantization_grid import FINEST_STEP, QuantizationGrid

__all__ = ["NOISE"]

_WHOLE = 1e-3  # of a step by which a multiple may miss it: what converting a unit leaves


FACTS = CauseFacts(
    id="reading_quantization",
    kind="noise",
    sentence="The device gives its reading in whole steps, rounded or cut off.",
    signature="readings are multiples of one step; cut off, they are half a step short, beside any scale",
    source="integer division t/58 of the Arduino examples: floor to 1 cm",
    parameters=(
        Quantity("step", "m", "step of the readings", (FINEST_STEP, 1.0), "any"),
        Quantity(
            "cut", "1", "1: cut off; 0: rounded", (0.0, 1.0), "rounded, unless the mean error says cut off"
        ),
    ),
    check="print the raw echo time in microseconds",
    prior=0.1,
    formula="reading' = step * floor(reading / step + (1 - cut) / 2)",
    needs=("reading",),
    repair="adds half a step to readings that are cut off",
)


def detect(view: View, settings: NoiseSettings) -> Finding | None:
    """Find the step of the readings, and whether they are cut off."""
    observations = view.observations
    if observations.reading is None:
        return None
    grid = view.grid
    if grid is None or grid.step < FINEST_STEP:
        return None
    step = grid.step
    cut = cut_off(view, step, settings.of(FACTS, Truncation))
    share = step**2 / 12 / max(view.scatter**2, step**2 / 12)
    kind = "cut off: half a step is added" if cut else "rounded"
    because = (
        f"{_multiples(grid, observations.reading[view.good])} {1e3 * step:.4g} mm, {kind}; the step "
        f"makes {percent(share)} of the variance of the noise"
    )
    parameters = (Parameter("step", step, 0.0, "m"), Parameter("cut", float(cut), 0.0, "1"))
    repaired = None
    if cut:
        longer = 1 + 0.5 * step / np.where(view.indication > 0, view.indication, np.inf)
        repaired = replace(
            observations,
            echo_time=observations.echo_time * longer,
            reading=observations.reading + 0.5 * step,
        )
    return Finding(
        FACTS,
        grid.evidence,
        because,
        parameters,
        observations.usable,
        repaired,
        1.0 if cut else share,
        step / 12**0.5,
    )


def _multiples(grid: QuantizationGrid, readings: NDArray[np.float64]) -> str:
    """What is a multiple of the step: the readings, or only their differences."""
    steps = readings / grid.step
    if np.abs(steps - np.round(steps)).max() < _WHOLE:
        return f"all {grid.distinct} different readings are multiples of"
    return f"all {grid.distinct} different readings differ by multiples of"


def draw(table: Columns, random: np.random.Generator) -> None:
    """Cut readings off at whole centimeters, or round them to 5 mm."""
    if random.random() < 0.5:
        table["reading_m"] = np.floor(100 * table["reading_m"]) / 100
    else:
        table["reading_m"] = np.round(200 * table["reading_m"]) / 200


NOISE = Quantization(
    facts=FACTS, draw=draw, detect=detect, imitates=("cycle_slip", "polling_jitter"), thresholds=Truncation()
)
