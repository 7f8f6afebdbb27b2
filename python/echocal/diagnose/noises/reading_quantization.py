"""Readings in whole steps."""

from dataclasses import replace

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.quantization_grid import FINEST, find_lattice
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_AWAY = 4.0  # standard errors by which the mean must miss rounding,
_NEAR = 2.5  # and hit truncation
_ANYHOW = 3e-4  # m, by which a mean is off anyhow: a ruler's millimeter

FACTS = CauseFacts(
    id="reading_quantization",
    kind="noise",
    sentence="The device gives its reading in whole steps, rounded or cut off.",
    signature="readings are multiples of one step; cut off, they are half a step short on average",
    source="integer division t/58 of the Arduino examples: floor to 1 cm",
    parameters=(
        Quantity("step", "m", "step of the readings"),
        Quantity("cut", "1", "1: cut off; 0: rounded"),
    ),
    check="print the raw echo time in microseconds",
    prior=0.1,
)


def detect(view: View) -> Finding | None:
    """Find the step of the readings, and whether they are cut off."""
    observations = view.observations
    if observations.reading is None:
        return None
    lattice = find_lattice(np.where(view.good, observations.reading, np.nan))
    if lattice is None or lattice.step < FINEST:
        return None
    step = lattice.step
    cut = _cut(view, step)
    share = step**2 / 12 / max(view.scatter**2, step**2 / 12)
    kind = "cut off: half a step is added" if cut else "rounded"
    because = (
        f"all {lattice.distinct} different readings are multiples of {1e3 * step:.4g} mm, {kind}; the step "
        f"makes {100 * share:.2g} % of the variance of the noise"
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
        lattice.evidence,
        because,
        parameters,
        observations.usable,
        repaired,
        1.0 if cut else share,
        step / 12**0.5,
    )


def _cut(view: View, step: float) -> bool:
    """Whether readings are half a step short, and would not be had they been rounded."""
    if view.reference is None:
        return False
    error = (view.indication - view.reference)[view.good]
    if len(error) < 5:
        return False
    scatter = 1.4826 * float(np.median(np.abs(error - np.median(error))))
    standard_error = float(np.hypot(max(scatter, step / 4) / np.sqrt(len(error)), _ANYHOW))
    mean = float(np.clip(error, *np.quantile(error, [0.02, 0.98])).mean())
    return bool(abs(mean) > _AWAY * standard_error and abs(mean + step / 2) < _NEAR * standard_error)
