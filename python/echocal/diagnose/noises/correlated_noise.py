"""Autocorrelated noise."""

import numpy as np

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises.common.kinds import NuisanceNoise, Values, mean_and_spread

__all__ = ["NOISE"]

_LIKELY = 0.5  # probability from which on autocorrelation is said to grow with the distance
_TURNS = 20  # correlation times in a table, below which autocorrelation looks like a slow function
_NOTE = (
    "; an effect outside the catalogue that changes with the rows would look the same: measure some of "
    "them again, in another order"
)

FACTS = CauseFacts(
    id="correlated_noise",
    kind="noise",
    sentence="The noise is autocorrelated: neighboring rows err alike, as in drifting cells of warm air.",
    signature="autocorrelation of what the causes leave, in row order",
    source="arendst/Tasmota PR #4488: slow oscillation of a static target",
    parameters=(
        Quantity(
            "autoregression",
            "1",
            "coefficient from one row to the next",
            (0.0, 1.0),
            "half on 0; else one of 18, 11 of them with a moving average",
        ),
        Quantity(
            "growth",
            "1",
            "autocorrelated variance over the rest at one meter, where it grows with distance",
            (0.0, None),
            "0.1 to 3, or with air that is alike along the whole path 0.3 to 100; rows at several distances",
        ),
    ),
    check="repeat the rows in a random order",
    prior=0.05,
    formula="e_i = autoregression e_(i-1) + white noise; with growth: the variance of e grows by growth d, "
    "or by growth d^2 where the air is alike along the whole path",
)


def concerns(noise: Noise) -> bool:
    """Whether a noise model is this cause."""
    return noise.rho != 0.0


def parameters(noises: tuple[Noise, ...], share: np.ndarray, variance: float) -> Values:
    """Mean and spread of the coefficient, and of the growth where there is one."""
    rho = np.array([noise.rho for noise in noises])
    found = {"autoregression": mean_and_spread(rho, share)}
    growth = np.array([noise.growth if noise.rho else 0.0 for noise in noises])
    if share[growth > 0.0].sum() > _LIKELY * share[rho > 0.0].sum():
        found["growth"] = mean_and_spread(growth, share)
    return found


def because(values: Values) -> str:
    """Say how strongly successive rows are correlated."""
    follows = f"with a coefficient of {values['autoregression'][0]:.2f} (autocorrelation in row order)"
    if "growth" in values:
        return f"what the causes leave follows the rows before {follows}, the more the farther the target"
    return f"what the causes leave follows the row before {follows}"


def rivals(values: Values, degrees: float) -> tuple[tuple[str, ...], str]:
    """Noise with a long correlation time is a function of the row like any other."""
    rows = 1 / (1 - values["autoregression"][0])
    return ((UNKNOWN,), _NOTE) if _TURNS * rows > degrees else ((), "")


def draw(table: Columns, random: np.random.Generator) -> None:
    """Let neighboring rows err alike."""
    white = random.normal(0.0, 1e-3, len(table["reading_m"]))
    slow = np.zeros_like(white)
    for row in range(1, len(slow)):
        slow[row] = 0.8 * slow[row - 1] + white[row]
    table["reading_m"] += slow


NOISE = NuisanceNoise(
    facts=FACTS,
    draw=draw,
    concerns=concerns,
    parameters=parameters,
    because=because,
    rivals=rivals,
    is_answer=False,
)
