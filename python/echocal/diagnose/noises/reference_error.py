"""An error of the reference that all rows of a station share."""

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.noises.common.kinds import NuisanceNoise, Values, mean_and_spread

__all__ = ["NOISE"]

FACTS = CauseFacts(
    id="reference_error",
    kind="noise",
    sentence="The reference distance of each station is off by an error of its own: the tape, the hand.",
    signature="what the causes leave steps from station to station",
    source="a steel tape of class II, 0.5 to 2 mm (general knowledge)",
    parameters=(
        Quantity(
            "standard_deviation",
            "m",
            "of the errors of the stations",
            (0.0, None),
            "half on 0; else variance 0.1, 1 or 10 times the noise's",
        ),
    ),
    check="measure the distances again, with another instrument",
    prior=0.05,
    formula="e_i = b_j + white noise in every row i of station j, b_j normal with standard_deviation",
    needs=("reference_distance",),
)


def concerns(noise: Noise) -> bool:
    """Whether a noise model is this cause."""
    return noise.station_ratio > 0.0


def parameters(noises: tuple[Noise, ...], share: np.ndarray, variance: float) -> Values:
    """Mean and spread of the standard deviation over the noises with an error per station."""
    deviation = np.sqrt(variance * np.array([noise.station_ratio for noise in noises]))
    return {"standard_deviation": mean_and_spread(deviation, share)}


def because(values: Values) -> str:
    """Say how far the stations are off."""
    return (
        f"the means of the stations scatter by {1e3 * values['standard_deviation'][0]:.2f} mm beyond what "
        "their rows explain"
    )


def draw(table: Columns, random: np.random.Generator) -> None:
    """Put the target at twelve stations, and each some millimeters beside its mark."""
    station = np.arange(len(table["reading_m"])) * 12 // len(table["reading_m"])
    error = table["reading_m"] - table["distance_m"]
    table["distance_m"] = np.linspace(0.4, 3.8, 12)[station]
    table["reading_m"] = table["distance_m"] + error + random.normal(0.0, 4e-3, 12)[station]


NOISE = NuisanceNoise(
    facts=FACTS, draw=draw, concerns=concerns, parameters=parameters, because=because, of_stations=True
)
