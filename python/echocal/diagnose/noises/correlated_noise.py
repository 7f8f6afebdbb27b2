"""Noise that remembers."""

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.inference.noise import Noise

__all__ = ["FACTS", "of", "parameters"]

FACTS = CauseFacts(
    id="correlated_noise",
    kind="noise",
    sentence="The noise remembers: neighboring rows err alike, as in drifting cells of warm air.",
    signature="autocorrelation of what the causes leave, in row order",
    source="arendst/Tasmota PR #4488: slow oscillation of a static target",
    parameters=(
        Quantity("autoregression", "1", "coefficient from one row to the next"),
        Quantity("growth", "1/m", "remembered variance over the rest, where it grows with distance"),
    ),
    check="repeat the rows in a random order",
    prior=0.05,
)

_LIKELY = 0.5  # probability from which on memory is said to grow with the distance


def of(noise: Noise) -> bool:
    """Whether a noise of the engine's guards is this cause."""
    return noise.rho != 0.0


def parameters(noises: tuple[Noise, ...], share: np.ndarray, _: float) -> dict[str, tuple[float, float]]:
    """Mean and spread of the coefficient over the noises that remember; of the growth, where there is one."""
    weight = share * np.array([of(noise) for noise in noises])
    weight = weight / max(weight.sum(), 1e-300)
    found = {"autoregression": _mean(np.array([noise.rho for noise in noises]), weight)}
    growth = np.array([noise.growth for noise in noises])
    if weight[growth > 0.0].sum() > _LIKELY:
        found["growth"] = _mean(growth, weight)
    return found


def _mean(values: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    mean = float(weight @ values)
    return mean, float(np.sqrt(weight @ (values - mean) ** 2))
