"""Echoes noticed late by a busy program."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.trace import Likelihood, Trace
from echocal.diagnose.settings.noises import NoiseSettings

__all__ = ["NOISE"]

Column = NDArray[np.float64]

_LATE = np.geomspace(0.2, 0.98, 9)  # part of the standard deviation that the tail makes
_KERNEL = np.geomspace(0.7, 1.4, 5)  # of the normal part, around what the rest of the variance leaves

FACTS = CauseFacts(
    id="polling_jitter",
    kind="noise",
    sentence="The program notices the echo late, by an exponentially distributed time.",
    signature="readings skewed to the long side: a sharp lower edge, a long upper tail",
    source="polled echoes on a Raspberry Pi, 10 us to 1 ms (general knowledge; compare pigpio)",
    parameters=(
        Quantity(
            "mean",
            "s",
            "mean delay",
            (0.0, None),
            "0.2 to 0.98 of the standard deviation, even in the logarithm",
        ),
    ),
    check="time the echo with an interrupt, a capture unit or pigpio instead of a loop",
    prior=0.04,
    formula="e = x c / 2 + noise; x exponentially distributed with the mean, the noise normal",
)


def fit(trace: Trace, settings: NoiseSettings) -> Likelihood | None:
    """Convolve a normal distribution with an exponential one, over a grid of both widths."""
    left = trace.left
    second = float(np.mean(left**2)) if not trace.free_mean else float(np.var(left))
    spread = float(np.std(left))
    skew = float(np.mean((left - left.mean()) ** 3)) / max(spread, 1e-12) ** 3
    chance = np.sqrt(6 / len(left))  # standard error of a skewness of nothing
    if skew < settings.worth * chance:
        return None
    logs, tails = [], []
    for part in _LATE:
        tail = part * spread
        for factor in _KERNEL:
            width = factor * np.sqrt(max(spread**2 - tail**2, 1e-4 * spread**2))
            level = float(left.mean()) - tail if trace.free_mean else 0.0
            logs.append(float(_density(left - level, tail, width).sum()))
            tails.append(tail)
    total = np.array(logs)
    if not trace.free_mean:  # without a level, the mean itself says how late
        tail = max(
            float(left.mean()), spread * np.cbrt(0.5 * settings.worth * chance)
        )  # shorter ones never show
        for factor in _KERNEL:
            width = factor * np.sqrt(max(second - 2 * tail**2, 1e-2 * second))
            total = np.append(total, float(_density(left, tail, width).sum()))
            tails.append(tail)
    best = int(total.argmax())
    share = np.exp(total - total[best])
    share /= share.sum()
    mean = float(share @ tails)
    speed = 0.5 * float(np.median(trace.speed))
    low, high = (1e3 * float(np.quantile(left, q) - np.median(left)) for q in (0.01, 0.99))
    because = (
        f"what the causes leave is skewed: 1 % of the rows are {-low:.1f} mm or more below the median, "
        f"1 % {high:.1f} mm or more above"
    )
    cost = 0.5 * np.log(len(left)) * (3 if trace.free_mean else 2)
    uncertainty = max(float(np.sqrt(share @ (np.array(tails) - mean) ** 2)), mean / np.sqrt(len(left)))
    return Likelihood(float(total[best] - cost), {"mean": (mean / speed, uncertainty / speed)}, because)


def _density(values: Column, tail: float, width: float) -> Column:
    """Log density of a normal plus an exponential variable."""
    from scipy.special import log_ndtr  # takes long to import

    near = (values - width**2 / tail) / width
    return np.asarray(-np.log(tail) + 0.5 * (width / tail) ** 2 - values / tail + log_ndtr(near))


def draw(table: Columns, random: np.random.Generator) -> None:
    """Notice each echo 50 us late on average."""
    late = random.exponential(50e-6, len(table["reading_m"]))
    table["reading_m"] += 0.5 * (331.4 + 0.6 * table["temperature_C"]) * late


NOISE = FittedNoise(facts=FACTS, draw=draw, fit=fit)
