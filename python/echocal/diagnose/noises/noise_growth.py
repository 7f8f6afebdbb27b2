"""Noise that grows with the distance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.trace import KERNELS, Likelihood, Trace
from echocal.diagnose.preprocess.density import fitted
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["NOISE"]

Column = NDArray[np.float64]

_GROWTH = np.geomspace(0.05, 20.0, 9)  # 1/m


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this noise."""

    matters: float = threshold(
        1.5,
        "1",
        "scatter of the farthest over that of the nearest quarter, below which it is no verdict; judgement",
    )
    spread: float = threshold(
        0.1, "1", "range of the distances over their mean, below which nothing can be seen to grow; judgement"
    )


FACTS = CauseFacts(
    id="noise_growth",
    kind="noise",
    sentence="The scatter of the readings grows with the distance.",
    signature="the standard deviation of the farthest rows exceeds that of the nearest",
    source="arduino.stackexchange 77711: 2 mm at 1.26 m; enesbcs/rpieasy #49: 1 to 4 mm",
    parameters=(
        Quantity(
            "scatter",
            "m",
            "standard deviation at no distance",
            (0.0, None),
            "profiled; costs half a log of the rows",
        ),
        Quantity(
            "growth", "1/m", "growth with the distance", (0.05, 20.0), "nine values, even in the logarithm"
        ),
    ),
    check="repeat readings at a near and a far target",
    prior=0.05,
    formula="e = scatter (1 + growth d) z; z normal, or Student's t with 8, 4 or 2.5 degrees of freedom",
    needs=("reference_distance",),
)


def fit(trace: Trace, settings: NoiseSettings) -> Likelihood | None:
    """Profile the growth; None where all distances are alike, or nothing is left."""
    own, distance = settings.of(FACTS, Thresholds), trace.distance
    if np.ptp(distance) < own.spread * distance.mean() or not trace.innovation.any():
        return None
    if not _correlation(np.abs(trace.innovation), distance) * np.sqrt(len(trace)) > settings.worth:
        return None
    # an innovation depends on the row before, too: successive rows have nearly the same distance
    wide = 1 + np.outer(_GROWTH, distance)
    level, widening = trace.innovation / wide, np.log(wide).sum(axis=1)
    fits = [fitted(level, freedom, trace.rounding) for freedom in KERNELS]
    scales, logs = (np.array(each) for each in zip(*fits, strict=True))
    logs -= widening
    profile = np.logaddexp.reduce(logs, axis=0) - np.log(len(KERNELS))
    best = int(profile.argmax())
    share = np.exp(profile - profile[best])
    share /= share.sum()
    mean = float(np.exp(share @ np.log(_GROWTH)))
    spread = mean * float(np.sqrt(share @ (np.log(_GROWTH) - np.log(mean)) ** 2))
    kernel = int(logs[:, best].argmax())
    first, last = np.quantile(distance, (0.25, 0.75))
    scatter = [1e3 * float(np.std(trace.left[rows])) for rows in (distance <= first, distance >= last)]
    because = (
        f"the nearest quarter of the rows scatters by {scatter[0]:.2f} mm, the farthest {scatter[1]:.2f} mm "
        "(standard deviation of what the causes leave)"
    )
    average = float(np.logaddexp.reduce(profile) - np.log(len(_GROWTH)))
    sigma = float(scales[kernel, best])
    parameters = {"scatter": (sigma, sigma / np.sqrt(2 * len(trace))), "growth": (mean, spread)}
    return Likelihood(
        average - 0.5 * np.log(len(trace)), parameters, because, scatter[1] > own.matters * scatter[0]
    )


def _correlation(one: Column, other: Column) -> float:
    """Of two columns; 0 where one is constant. `numpy.corrcoef` takes five times as long for 1,000 rows."""
    one, other = one - one.mean(), other - other.mean()
    return float(one @ other) / max(float(np.sqrt((one @ one) * (other @ other))), 1e-300)


def draw(table: Columns, random: np.random.Generator) -> None:
    """Scatter farther readings more."""
    distance = table["distance_m"]
    table["reading_m"] += random.normal(0.0, 2e-3, len(distance)) * distance


NOISE = FittedNoise(facts=FACTS, draw=draw, fit=fit, removes_nuisance=True, thresholds=Thresholds())
