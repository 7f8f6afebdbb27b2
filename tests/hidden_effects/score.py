"""From records to figures with intervals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest

Record = dict[str, Any]


@dataclass(frozen=True)
class Figure:
    """A figure with its 95 % interval; `count` cases stand behind it."""

    value: float
    low: float
    high: float
    count: int

    def __str__(self) -> str:
        return (
            f"{self.value:.3f} [{self.low:.3f}, {self.high:.3f}] n={self.count}" if self.count else "no cases"
        )


NONE = Figure(np.nan, np.nan, np.nan, 0)


def part(records: Sequence[Record], of: Callable[[Record], bool]) -> Figure:
    """Part of the records, with Wilson's interval."""
    if not records:
        return NONE
    hits = sum(bool(of(r)) for r in records)
    interval = binomtest(hits, len(records)).proportion_ci(method="wilson")
    return Figure(hits / len(records), float(interval.low), float(interval.high), len(records))


def resampled(records: Sequence[Record], of: Callable[[Sequence[Record]], float], draws: int = 400) -> Figure:
    """Any figure of all records, with the percentile interval of resampled cases."""
    if not records:
        return NONE
    random = np.random.default_rng(0)  # of the interval, not of the cases
    picks = random.integers(len(records), size=(draws, len(records)))
    values = [of([records[i] for i in pick]) for pick in picks]
    low, high = np.nanpercentile(values, [2.5, 97.5])
    return Figure(of(records), float(low), float(high), len(records))


def reliability(records: Sequence[Record], bins: int = 10) -> list[tuple[float, float, int]]:
    """Mean probability of the first name, part that is right, and count; by bins of probability."""
    p = np.array([r["top_probability"] for r in records])
    right = np.array([r["strict"] for r in records], dtype=float)
    which = np.minimum((p * bins).astype(int), bins - 1)
    inside = [which == b for b in range(bins) if (which == b).any()]
    return [(float(p[i].mean()), float(right[i].mean()), int(i.sum())) for i in inside]


def calibration_error(records: Sequence[Record]) -> float:
    """Expected calibration error of the first name's probability."""
    return sum(abs(p - right) * n for p, right, n in reliability(records)) / len(records)


def beyond_chance(records: Sequence[Record], draws: int = 400) -> Figure:
    """Calibration error less that of perfect probabilities at this number of cases."""
    if not records:
        return NONE
    random = np.random.default_rng(0)
    p = np.array([r["top_probability"] for r in records])
    lucky = [
        [{**r, "strict": hit} for r, hit in zip(records, random.random(len(p)) < p, strict=True)]
        for _ in range(draws)
    ]
    chance = [calibration_error(drawn) for drawn in lucky]
    low, high = np.percentile(chance, [2.5, 97.5])
    error = calibration_error(records)
    rest = [max(0.0, float(error - x)) for x in (np.mean(chance), high, low)]
    return Figure(rest[0], rest[1], rest[2], len(records))


def gain(where: str) -> Callable[[Sequence[Record]], float]:
    """Part of the reachable mean square that the models remove, all cases together."""

    def pooled(records: Sequence[Record]) -> float:
        before, after = np.sum([r[where] for r in records], axis=0)
        return float(1 - after / before)

    return pooled


def f1(kind: str) -> Callable[[Sequence[Record]], float]:
    """Harmonic mean of precision and recall over all names."""

    def pooled(records: Sequence[Record]) -> float:
        hits, said, planted = np.sum([r[kind] for r in records], axis=0)
        return float(2 * hits / (said + planted))

    return pooled


def mean(of: str) -> Callable[[Sequence[Record]], float]:
    """Mean of one entry."""
    return lambda records: float(np.mean([r[of] for r in records]))
