"""Air along the path that differs from that at the thermometer, slowly."""

import numpy as np

from echocal._core import speed_of_sound
from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises.common.kinds import NuisanceNoise, Values, mean_and_spread

__all__ = ["NOISE"]

FACTS = CauseFacts(
    id="slow_air",
    kind="noise",
    sentence="The air along the path and that at the thermometer differ, and the difference changes slowly.",
    signature="an error in proportion to the distance that changes over minutes to hours",
    source="WMO-No. 8, annex 1.A: 0.1 K at the best thermometers; a room has layers of air",
    parameters=(
        Quantity(
            "difference",
            "K",
            "standard deviation of the difference over hours",
            (0.0, None),
            "half on 0; else 0.1 or 0.3 K",
        ),
    ),
    check="a second thermometer in the sound path",
    prior=0.05,
    formula="path at T + T'; T' normal, its correlation half exp(-t / 600 s), half exp(-t / 3600 s), "
    "less its mean over the table",
    needs=("elapsed_time",),
)


def concerns(noise: Noise) -> bool:
    """Whether a noise model is this cause."""
    return noise.slow_air > 0.0


def parameters(noises: tuple[Noise, ...], share: np.ndarray, variance: float) -> Values:
    """Mean and spread of the standard deviation of the difference."""
    return {"difference": mean_and_spread(np.array([noise.slow_air for noise in noises]), share)}


def because(values: Values) -> str:
    """Say how the error changes."""
    return (
        "the error in proportion to the distance changes in the course of the table, as a difference of "
        f"some {values['difference'][0]:.1g} K does"
    )


def rivals(values: Values, degrees: float) -> tuple[tuple[str, ...], str]:
    """Any slow function of time looks the same where targets were measured one after the other."""
    del values, degrees
    return (UNKNOWN,), (
        "; an effect outside the catalogue that changes with time would look the same: measure again"
    )


def draw(table: Columns, random: np.random.Generator) -> None:
    """Let the air along the path come and go by one kelvin within a quarter of an hour."""
    rows = len(table["reading_m"])
    table["time_s"] = np.linspace(0.0, 900.0, rows)
    wave = np.sin(2.0 * np.pi * (np.linspace(0.0, 1.0, rows) + random.uniform()))
    recorded, true = (speed_of_sound(table["temperature_C"] + warmer) for warmer in (0.0, wave))
    table["reading_m"] = np.array(table["reading_m"] * recorded / true)


NOISE = NuisanceNoise(
    facts=FACTS,
    draw=draw,
    concerns=concerns,
    parameters=parameters,
    because=because,
    rivals=rivals,
    is_answer=False,
)
