"""Noise that grows with the distance."""

import numpy as np

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.noises.trace import KERNELS, Likelihood, Trace, log_density, scale_of

__all__ = ["FACTS", "fit"]

_GROWTH = np.geomspace(0.05, 20.0, 9)  # 1/m
_MATTERS = 1.5  # scatter far over scatter near, below which it is no verdict
_WORTH = 2.0  # standard errors of the correlation from which on a fit is tried
_LEAST_SPREAD = 0.1  # part of the mean distance

FACTS = CauseFacts(
    id="noise_growth",
    kind="noise",
    sentence="The scatter of the readings grows with the distance.",
    signature="standard deviation s (1 + k d)",
    source="arduino.stackexchange 77711: 2 mm at 1.26 m; enesbcs/rpieasy #49: 1 to 4 mm",
    parameters=(
        Quantity("scatter", "m", "standard deviation at no distance"),
        Quantity("growth", "1/m", "growth with the distance"),
    ),
    check="repeat readings at a near and a far target",
    prior=0.05,
)


def fit(trace: Trace) -> Likelihood | None:
    """Profile the growth; None where all distances are alike."""
    distance = trace.distance
    if np.ptp(distance) < _LEAST_SPREAD * distance.mean():
        return None
    rise = np.corrcoef(np.abs(trace.innovation), distance)[0, 1] * np.sqrt(len(trace))
    if not rise > _WORTH:
        return None
    # what was learned of one row tells of the next by its innovation, of nearly the same distance
    wide = 1 + np.outer(_GROWTH, distance)
    level, widening = trace.innovation / wide, np.log(wide).sum(axis=1)
    scales = np.stack([scale_of(level, freedom) for freedom in KERNELS])
    each = zip(scales, KERNELS, strict=True)
    logs = np.stack([log_density(level, s[:, None], freedom).sum(axis=1) - widening for s, freedom in each])
    profile = np.logaddexp.reduce(logs, axis=0) - np.log(len(KERNELS))
    best = int(profile.argmax())
    share = np.exp(profile - profile[best])
    share /= share.sum()
    mean = float(np.exp(share @ np.log(_GROWTH)))
    spread = mean * float(np.sqrt(share @ (np.log(_GROWTH) - np.log(mean)) ** 2))
    kernel = int(logs[:, best].argmax())
    near, far = (distance <= np.quantile(distance, 0.25)), (distance >= np.quantile(distance, 0.75))
    scatter = [1e3 * float(np.std(trace.left[rows])) for rows in (near, far)]
    told = (
        f"the nearest quarter of the rows scatters by {scatter[0]:.2f} mm, the farthest {scatter[1]:.2f} mm "
        "(standard deviation of what the causes leave)"
    )
    average = float(np.logaddexp.reduce(profile) - np.log(len(_GROWTH)))
    sigma = float(scales[kernel, best])
    parameters = {"scatter": (sigma, sigma / np.sqrt(2 * len(trace))), "growth": (mean, spread)}
    return Likelihood(
        average - 0.5 * np.log(len(trace)), parameters, told, scatter[1] > _MATTERS * scatter[0]
    )
