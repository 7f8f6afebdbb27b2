"""Temperatures in whole steps."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.quantization_grid import find_lattice
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_EVEN = 0.8  # part of the steps of a sweep that are alike
_TURNS = 0.1  # and of those that change direction
_COARSEST = 1.05  # K; the steps of a sweep are wider, those of thermometers are not

FACTS = CauseFacts(
    id="temperature_quantization",
    kind="noise",
    sentence="The thermometer gives whole steps; the air between two steps is compensated wrong.",
    signature="temperatures are multiples of one step; variance that grows with the square of the distance",
    source="data sheets: DS18B20 0.0625 K, DHT11 1 K; LM35 on a 10-bit converter at 5 V 0.49 K",
    parameters=(Quantity("step", "K", "step of the temperatures"),),
    check="list the different temperatures in the table",
    prior=0.1,
)


def detect(view: View) -> Finding | None:
    """Find the step of the temperatures, unless they were set in a sweep."""
    recorded = view.temperature
    if recorded is None:
        return None
    kept = np.where(view.good, recorded, np.nan)
    lattice = find_lattice(kept)
    if lattice is None or lattice.step > _COARSEST or _sweep(kept[view.good]):
        return None
    error = lattice.step * _per_kelvin(view) / np.sqrt(12)
    variance = float(np.mean(error[view.good] ** 2))
    share = variance / max(view.scatter**2, variance)
    because = (
        f"all {lattice.distinct} different temperatures are multiples of {lattice.step:.4g} K, moving "
        f"the reading by {1e3 * np.sqrt(variance):.2g} mm (rms): {100 * share:.2g} % of the variance of noise"
    )
    parameters = (Parameter("step", lattice.step, 0.0, "K"),)
    return Finding(
        FACTS, lattice.evidence, because, parameters, view.observations.usable, None, share, variance**0.5
    )


def _sweep(recorded: NDArray[np.float64]) -> bool:
    """Whether the temperatures were set: mostly in steps of one width that seldom turn back."""
    steps = np.diff(recorded)
    moved = steps[np.abs(steps) > 1e-9]
    if len(moved) < 2:
        return True
    width = float(np.median(np.abs(moved)))
    even = np.mean(np.abs(np.abs(moved) - width) < 1e-6 * width)
    turns = np.mean(np.diff(np.sign(moved)) != 0)
    return bool(even > _EVEN and turns < _TURNS)


def _per_kelvin(view: View) -> NDArray[np.float64]:
    """Change of the reading with temperature [m/K], from the base's own conversion."""
    conditions = view.observations.conditions
    warmer = {**conditions, "temperature": conditions["temperature"] + 1.0}
    return np.asarray(view.base.indication(view.observations.echo_time, warmer) - view.indication)
