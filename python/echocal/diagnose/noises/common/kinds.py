"""What the file of a noise hands to the registry: one of four kinds of entries."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.noises.common.trace import Likelihood, Trace
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.causes import NoThresholds
from echocal.diagnose.settings.noises import NoiseSettings

__all__ = ["FittedNoise", "NoiseEntry", "NuisanceNoise", "OffsetNoise", "Offsets", "Quantization", "Values"]
__all__ += ["mean_and_spread"]

Column = NDArray[np.float64]
Matrix = NDArray[np.floating[Any]]
Values = dict[str, tuple[float, float]]
"""Value and standard uncertainty of each parameter, by name."""


@dataclass(frozen=True, kw_only=True)
class NoiseEntry:
    """A cause that changes the distribution of the readings.

    Attributes
    ----------
    facts : CauseFacts
    draw : callable
        What the noise does to a table: changes it in place. The tests plant the noise with it.
    thresholds : object
        Defaults of the numbers that decide about it.
    """

    facts: CauseFacts
    draw: Callable[[Columns, np.random.Generator], None]
    thresholds: object = NoThresholds()


@dataclass(frozen=True, kw_only=True)
class Quantization(NoiseEntry):
    """A noise that is read off a column before anything is fitted.

    Attributes
    ----------
    detect : callable
        Hands back the step and its evidence, or None.
    imitates : tuple of str
        Ids of fitted noises that this quantization imitates. They are not tried beside it.
    """

    detect: Callable[[View, NoiseSettings], Finding | None]
    imitates: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class FittedNoise(NoiseEntry):
    """A noise with a likelihood of its own. Such noises exclude each other.

    Attributes
    ----------
    fit : callable
        Log likelihood of the residuals of one hypothesis, less the cost of its free parameters; or
        None where the residuals have no sign of it.
    removes_nuisance : bool
        Whether `fit` uses `Trace.innovation`, without the nuisance noises; else at `Trace.left`.
    offsets : callable or None
        Expected error of each row of the trace [m], for a noise whose mean is not zero: an effect would
        take it up. None where it is not known.
    in_steps : tuple of str
        Ids of effects that shift a row by whole steps of this noise. `offsets` has what they vary
        within a segment.
    """

    fit: Callable[[Trace, NoiseSettings], Likelihood | None]
    removes_nuisance: bool = False
    offsets: Callable[[Trace, NoiseSettings], Column | None] | None = None
    in_steps: tuple[str, ...] = ()


def mean_and_spread(values: Matrix, weight: Matrix) -> tuple[float, float]:
    """Mean of a parameter over the noises that have it, by their probabilities, and its spread."""
    weight = np.where(values > 0.0, weight, 0.0) / max(float(weight[values > 0.0].sum()), 1e-300)
    mean = float(weight @ values)
    return mean, float(np.sqrt(weight @ (values - mean) ** 2))


def _nothing(values: Values, degrees: float) -> tuple[tuple[str, ...], str]:
    return (), ""


@dataclass(frozen=True, kw_only=True)
class NuisanceNoise(NoiseEntry):
    """A noise that every hypothesis on the mean includes.

    Attributes
    ----------
    concerns : callable
        Whether one of the noises of `echocal.diagnose.inference.noise` is this cause.
    parameters : callable
        Its parameters from these noises, the probability of each, and the variance [m^2].
    because : callable
        A sentence on the parameters that a person can check.
    rivals : callable
        What looks the same, from the parameters and the degrees of freedom, and a note on it.
    is_answer : bool
        Whether a verdict counts it; else it is listed only.
    of_stations : bool
        Whether it is an error of stations: rows that are grouped by the levels of a column have none.
    """

    concerns: Callable[[Noise], bool]
    parameters: Callable[[tuple[Noise, ...], Matrix, float], Values]
    because: Callable[[Values], str]
    rivals: Callable[[Values, float], tuple[tuple[str, ...], str]] = _nothing
    is_answer: bool = True
    of_stations: bool = False


@dataclass(frozen=True, eq=False)
class Offsets:
    """Offsets of placements or of targets that a noise explains, and the causes beside them.

    Attributes
    ----------
    finding : Finding
    case : Case
        The same table, the offsets subtracted from its residuals, or its rows grouped by what has an offset.
        The readings are as they were.
    inference : Inference
        Hypotheses on what is left.
    """

    finding: Finding
    case: Case
    inference: Inference


@dataclass(frozen=True, kw_only=True)
class OffsetNoise(NoiseEntry):
    """A noise that adds an offset to each placement of the target, or to each target.

    Attributes
    ----------
    find : callable
        Compares the hypotheses of a case with the same hypotheses beside the offsets; None where the offsets
        are no more probable than not.
    """

    find: Callable[[Case, Inference], Offsets | None]
