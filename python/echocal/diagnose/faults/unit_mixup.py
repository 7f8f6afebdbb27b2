"""Readings and references in different units."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.ratio import divided, factor_of
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

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
    0.3048: "feet where m are meant",
    1 / 0.3048: "m where feet are meant",
}

_LEAST = min(abs(float(np.log(factor))) for factor in _UNITS)
_FEWEST = 3  # rows of one factor: one or two are typing errors
_MOST = 0.45  # part of the rows; of more, nobody knows which unit is the right one
_WILD = 0.15  # of the log ratio, beyond which a row is wild
_SHARED = 0.8  # part of the wild rows that must share the factor
_CLOSE = 0.02  # of the log ratio, beside the noise: what laws and thermometers do to it
_RANGE = 8.0  # of the log ratio, in which a wild row may lie anywhere

FACTS = CauseFacts(
    id="unit_mixup",
    kind="gross",
    sentence="Readings and reference distances stand in different units, in all rows or in some.",
    signature="reading / reference = 2.54, 10, 25.4, 100, 1000, 0.3048, or one over these, to a few percent",
    source="jeremylindsayni/Bifrost.Arduino.Sensors.HCSR04 #5: 332 m/s commented as 3320 cm/s",
    parameters=(
        Quantity("factor", "1", "reading over what it should be"),
        Quantity("rows", "1", "rows concerned"),
    ),
    check="look up in the device's program which unit it prints",
    prior=0.01,
)


def detect(view: View) -> Finding | None:
    """Compare the median ratio of reading and reference with the ratios of units, then row by row."""
    found = factor_of(view, (2.0, 0.5, *_UNITS))
    if found is None or found.value not in _UNITS:
        return max(_some(view), key=lambda finding: finding.log_bayes, default=None)
    because = (
        f"readings are {found.ratio:.4g} times the reference distance (median of all rows), as if one of the "
        f"columns were in another unit: {_UNITS[found.value]}"
    )
    return Finding(
        FACTS,
        found.log_bayes,
        f"{because}; the rest of the diagnosis divides them by {found.value:.4g}",
        (
            Parameter("factor", found.value, 0.0, "1"),
            Parameter("rows", float(view.observations.usable.sum()), 0.0, "1"),
        ),
        view.observations.usable,
        divided(view, found.value, "reading_m"),
    )


def _some(view: View) -> Iterator[Finding]:
    """Rows that agree with the others once divided by a unit's factor: cm among m, ms among us."""
    if _near(view):
        return
    expected = _expected(view)
    with np.errstate(all="ignore"):
        log_ratio = np.log(view.indication / expected)
        width = _CLOSE + 5 * view.scatter / expected
    judged = np.isfinite(log_ratio) & np.isfinite(width)
    wild = judged & (np.abs(log_ratio) > _WILD)
    if wild.sum() > _MOST * judged.sum():
        return
    far = np.flatnonzero(judged & (np.abs(log_ratio) > _LEAST - width))
    for factor, story in _UNITS.items():
        rows = far[np.abs(log_ratio[far] - np.log(factor)) < width[far]]
        count = len(rows)
        if count < max(_FEWEST, _SHARED * wild.sum()):
            continue
        near = np.zeros(len(judged), dtype=bool)
        near[rows] = True
        # rivals are wild rows, which lie anywhere
        evidence = float(np.log(_RANGE / (2 * width[near])).sum() - np.log(len(_UNITS)) - count)
        because = (
            f"{listed(near)} read {np.exp(np.median(log_ratio[near])):.4g} times what the other rows say, as "
            f"if written in another unit ({story}); divided by {factor:.4g} there"
        )
        parameters = (Parameter("factor", factor, 0.0, "1"), Parameter("rows", float(count), 0.0, "1"))
        repaired = divided(view, np.where(near, factor, 1.0), "reading_m")
        yield Finding(FACTS, min(evidence, 60.0), because, parameters, near, repaired)


def _near(view: View) -> bool:
    """Whether no row is wild, nor anything near another unit."""
    least = float(np.fmin.reduce(view.expected))
    return (
        view.reference is not None
        and least > 0
        and 1.01 * view.farthest < -np.expm1(-_WILD) * least
        and _CLOSE + 5 * view.scatter / least < 0.9 * (_LEAST - _WILD)
    )


def _expected(view: View) -> NDArray[np.float64]:
    """What each row should read, also of rows that are out of range [m]."""
    if view.reference is not None:
        return view.expected
    rows, known = np.arange(len(view)), np.isfinite(view.expected)
    return np.interp(rows, rows[known], view.expected[known]) if known.any() else view.expected
