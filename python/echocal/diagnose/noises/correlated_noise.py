"""Noise that remembers."""

import numpy as np

from echocal.diagnose.facts import CauseFacts, Quantity
from echocal.diagnose.noise import Noise

__all__ = ["FACTS", "of", "parameters"]

FACTS = CauseFacts(
    id="correlated_noise",
    kind="noise",
    sentence="The noise remembers: neighboring rows err alike, as in drifting cells of warm air.",
    signature="autocorrelation of what the causes leave, in row order",
    source="arendst/Tasmota PR #4488: slow oscillation of a static target",
    parameters=(Quantity("autoregression", "1", "coefficient from one row to the next"),),
    check="repeat the rows in a random order",
    prior=0.05,
)


def of(noise: Noise) -> bool:
    """Whether a noise of the engine's guards is this cause."""
    return noise.rho != 0.0


def parameters(noises: tuple[Noise, ...], share: np.ndarray, _: float) -> dict[str, tuple[float, float]]:
    """Mean and spread of the coefficient over the noises that remember."""
    rho = np.array([noise.rho for noise in noises])
    weight = share * np.array([of(noise) for noise in noises])
    weight = weight / max(weight.sum(), 1e-300)
    mean = float(weight @ rho)
    return {"autoregression": (mean, float(np.sqrt(weight @ (rho - mean) ** 2)))}
