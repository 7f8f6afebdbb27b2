"""Readings and references that differ by a known factor."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings, SharedFactor
from echocal.observations import Observations

__all__ = ["FARTHEST", "Factor", "divided", "factor_of", "log_free", "log_usual", "multiplied_reference"]

FARTHEST = 100.0
"""Distance that no echo in air comes back from [m]."""


@dataclass(frozen=True)
class Factor:
    """A factor between readings and references that most rows share."""

    value: float
    ratio: float
    log_bayes: float


def factor_of(view: View, factors: tuple[float, ...], settings: FaultSettings) -> Factor | None:
    """The factor that turns readings into references, if one of these does.

    Rows out of physical range take part: a wrong unit is what puts them there.
    """
    if view.reference is None:
        return None
    (low, high), limits = view.ratios, settings.factor
    beyond = 1.0001 * float(np.exp(limits.near))
    if all(low > factor * beyond or high < factor / beyond for factor in factors):
        return None  # no row is near any of them
    with np.errstate(all="ignore"):
        log_ratio = np.log(view.indication / view.reference)
    log_ratio = log_ratio[np.isfinite(log_ratio) & view.measured]
    if len(log_ratio) == 0:
        return None
    center = float(np.median(log_ratio))
    nearest = min(factors, key=lambda factor: abs(center - np.log(factor)))
    known = log_usual(center - float(np.log(nearest)), limits)
    shared = float(np.mean(np.abs(log_ratio - np.log(nearest)) < limits.near))
    if known < log_free(center) or shared < limits.most:
        return None  # any factor at all is as probable
    evidence = float(np.clip(known - log_usual(center, limits), -settings.cap, settings.cap))
    return Factor(nearest, float(np.exp(center)), evidence)


def log_usual(off: float, limits: SharedFactor, uncertainty: float = 0.0) -> float:
    """Log density of a log ratio that laws, thermometers and clocks leave."""
    width = np.hypot(limits.spread, uncertainty)
    return float(-0.5 * (off / width) ** 2 - np.log(width * np.sqrt(2 * np.pi)))


def log_free(log_ratio: float) -> float:
    """Log density of the log of a factor of which nothing is known, but that it is from 1/10 to 10."""
    widest = float(np.log(10.0))
    return -float(np.log(2 * widest)) if abs(log_ratio) <= widest else -np.inf


def divided(view: View, factor: float | NDArray[np.float64], column: str) -> Observations:
    """Divide echo times and readings; rows that were out of range only by the factor come back."""
    observations = view.observations
    reading = None if observations.reading is None else observations.reading / factor
    unusable = observations.unusable.astype(object)
    names = {observations.source_names.get(name, name) for name in ("reading", "echo_time")} | {column}
    sane: NDArray[np.bool_] = (view.indication / factor > 0) & (view.indication / factor <= FARTHEST)
    sane &= np.not_equal(factor, 1.0)
    for name in names:
        unusable[sane & (unusable == f"{name} out of range")] = ""
    return replace(
        observations,
        echo_time=observations.echo_time / factor,
        reading=reading,
        unusable=unusable.astype(str),
    )


def multiplied_reference(view: View, factor: float) -> Observations:
    """Multiply reference distances; rows that were out of range only by the factor come back."""
    observations = view.observations
    assert observations.reference_distance is not None  # there is a ratio to it
    reference = observations.reference_distance * factor
    unusable = observations.unusable.astype(object)
    name = observations.source_names.get("reference_distance", "reference_distance")
    unusable[(unusable == f"{name} out of range") & (reference > 0) & (reference <= FARTHEST)] = ""
    return replace(observations, reference_distance=reference, unusable=unusable.astype(str))
