"""An error of the reference that all rows of a stand share."""

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.inference.noise import Noise

__all__ = ["FACTS", "of", "parameters"]

FACTS = CauseFacts(
    id="reference_error",
    kind="noise",
    sentence="The reference distance of each stand is off by an error of its own: the tape, the hand.",
    signature="what the causes leave steps from stand to stand",
    source="a steel tape of class II, 0.5 to 2 mm (general knowledge)",
    parameters=(Quantity("standard_deviation", "m", "of the errors of the stands"),),
    check="measure the distances again, with another instrument",
    prior=0.05,
)


def of(noise: Noise) -> bool:
    """Whether a noise of the engine's guards is this cause."""
    return noise.stand_ratio > 0.0


def parameters(
    noises: tuple[Noise, ...], share: np.ndarray, variance: float
) -> dict[str, tuple[float, float]]:
    """Mean and spread of the standard deviation over the noises with an error per stand."""
    deviation = np.sqrt(variance * np.array([noise.stand_ratio for noise in noises]))
    weight = share * np.array([of(noise) for noise in noises])
    weight = weight / max(weight.sum(), 1e-300)
    mean = float(weight @ deviation)
    return {"standard_deviation": (mean, float(np.sqrt(weight @ (deviation - mean) ** 2)))}
