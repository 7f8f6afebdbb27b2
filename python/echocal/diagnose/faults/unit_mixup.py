"""Readings and references in different units."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import finest, log_choices, log_constant
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.ratio import factor_of
from echocal.diagnose.faults.common.repair import divided, with_values
from echocal.diagnose.faults.common.values import expected_everywhere
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import Constant, FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_UNITS = {
    2.54: "cm where inches are meant",
    1 / 2.54: "inches where cm are meant",
    25.4: "mm where inches are meant",
    1 / 25.4: "inches where mm are meant",
    10.0: "mm where cm are meant, or a shifted decimal point",
    0.1: "cm where mm are meant, or a shifted decimal point",
    100.0: "cm where m are meant",
    0.01: "m where cm are meant",
    1000.0: "mm where m are meant, or us where ms are meant",
    0.001: "m where mm are meant, or ms where us are meant",
    0.3048: "m where feet are meant",
    1 / 0.3048: "feet where m are meant",
    3.28: "feet where m are meant, by a program that multiplies by 3.28",
}

_USUAL = 20.0
"""Farthest target of a sensor in air [m]; catalogues end at 15 m."""


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: float = threshold(3, "1", "rows of one factor: one or two are typing errors")
    most: float = threshold(0.45, "1", "part of the rows: of more, nobody knows which unit is the right one")
    outlier: float = threshold(0.15, "1", "of the log ratio, beyond which a row is an outlier; judgement")
    close: float = threshold(
        0.02, "1", "of the log ratio, beside the noise: what laws and thermometers do to it"
    )
    deviations: float = threshold(
        5.0, "1", "robust standard deviations of the noise that a row may be off by; judgement"
    )


FACTS = CauseFacts(
    id="unit_mixup",
    kind="gross",
    sentence="Readings and reference distances are in different units, in all rows or in some.",
    signature="reading / reference = 2.54, 10, 25.4, 100, 1000, 0.3048, or one over these, to a few percent",
    source="jeremylindsayni/Bifrost.Arduino.Sensors.HCSR04 #5: 332 m/s commented as 3320 cm/s",
    parameters=(
        Quantity("factor", "1", "reading over what it should be"),
        Quantity("rows", "1", "rows concerned"),
    ),
    check="look up in the device's program which unit it prints",
    prior=0.01,
    formula="reading' = factor * reading, in every row or in some",
    repair="divides readings and echo times by the factor in the rows concerned",
)


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Compare the median ratio of reading and reference with the ratios of units, then row by row."""
    found = factor_of(view, (2.0, 0.5, *_UNITS), settings.factor)
    if found is None or found.value not in _UNITS:
        return max(_some(view, own, settings), key=lambda one: one.log_bayes, default=None)
    because = (
        f"readings are {found.ratio:.4g} times the reference distance (median of all rows), as if one of the "
        f"columns were in another unit: {_UNITS[found.value]}"
    )
    every, sizes = np.ones(len(view), dtype=bool), (found.value, view.observations.usable.sum())
    if _reference_is_wrong(view):
        assert view.observations.reference_distance is not None  # there is a ratio to it
        longer = found.value * view.observations.reference_distance
        repaired = with_values(view, every, FACTS.id, reference_distance=longer)
        how = (
            f"multiplies the reference distances by {found.value:.4g}, because no echo comes back from there"
        )
    else:
        repaired, how = divided(view, every, FACTS.id, found.value), f"divides them by {found.value:.4g}"
    because = f"{because}; the rest of the diagnosis {how}"
    return Found(every, found.log_bayes, because, sizes, repaired)


def _reference_is_wrong(view: View) -> bool:
    """Whether the readings can be and the reference distances cannot; where none can, the user is asked."""
    assert view.reference is not None  # there is a ratio to it
    return bool(view.observations.usable.any()) and bool(
        0.0 < np.nanmedian(view.indication) <= _USUAL < np.nanmedian(view.reference)
    )


def _some(view: View, own: Thresholds, settings: FaultSettings) -> Iterator[Found]:
    """Rows that agree with the others once divided by a unit's factor: cm among m, ms among us."""
    if view.reference is not None and view.farthest < 0.8 * own.outlier * np.fmin.reduce(view.expected):
        return  # no row is an outlier
    expected = expected_everywhere(view)
    with np.errstate(all="ignore"):
        log_ratio = np.log(view.indication / expected)
        width = own.close + own.deviations * view.scatter / expected
    judged = np.isfinite(log_ratio) & np.isfinite(width) & view.measured
    outliers = judged & (np.abs(log_ratio) > own.outlier)
    if outliers.sum() > own.most * judged.sum():
        return
    for factor, story in _UNITS.items():
        near = outliers & (np.abs(log_ratio - np.log(factor)) < width)
        if near.sum() < own.fewest:
            continue
        noise = np.hypot(view.scatter, view.resolution / factor / 12**0.5) / expected[near]
        as_a_unit = _as_a_unit(log_ratio[near] - np.log(factor), noise, own, settings.constant)
        evidence = as_a_unit - float(np.log(len(_UNITS))) - _anyhow(view, near, settings)
        count, among = int(near.sum()), int(outliers.sum())  # in half of such tables all of them
        evidence -= float(np.log(2)) + (0.0 if count == among else log_choices(count, among))
        because = (
            f"{listed(near)} read {np.exp(np.median(log_ratio[near])):.4g} times what the other rows say, as "
            f"if written in another unit ({story}); divided by {factor:.4g} there"
        )
        yield Found(near, evidence, because, (factor, count), divided(view, near, FACTS.id, factor))


def _anyhow(view: View, rows: NDArray[np.bool_], settings: FaultSettings) -> float:
    """Log density of rows that lie anywhere, each by itself or all at one constant in place of an echo."""
    own, values = settings.constant, np.abs(view.indication[rows])
    constant = log_constant(values, finest(values, view.resolution), own) - np.log(own.range)
    each = -len(values) * np.log(own.range)
    return float(np.logaddexp(each, np.log(settings.outliers.usual) + constant))


def _as_a_unit(log_ratio: Column, width: Column, own: Thresholds, wild: Constant) -> float:
    """Log density of these log ratios less a unit's: normal around an error that the rows share."""
    weight = 1 / width**2
    shared = float(weight @ log_ratio / weight.sum())
    spread = float(np.sqrt(own.close**2 + 1 / weight.sum()))
    normal = np.exp(-0.5 * ((log_ratio - shared) / width) ** 2) / (width * np.sqrt(2 * np.pi))
    rows = float(np.log((1 - wild.wild) * normal + wild.wild / wild.range).sum())
    return rows - 0.5 * float((shared / spread) ** 2) - float(np.log(spread * np.sqrt(weight.sum())))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Write readings in another unit."""
    table["reading_m"] = table["reading_m"] * random.choice([100.0, 1 / 2.54, 25.4, 0.3048])


FAULT = Fault(FACTS, detect, spoil, Thresholds())
