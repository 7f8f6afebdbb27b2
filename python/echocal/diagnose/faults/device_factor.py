"""A constant of the device or its program that is wrong by a factor."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echocal.concise import concise
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.ratio import log_free, log_usual
from echocal.diagnose.faults.common.repair import divided
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View, least_absolute
from echocal.diagnose.settings.faults import FaultSettings
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_ENOUGH = 20_000  # rows that are enough for a line
_FEWEST = 5  # rows; of fewer, a line says little about their scatter
_INSIDE = 4.0  # robust standard deviations from the line: the others are outliers
_LEAST = 1e-5  # m, below the scatter of such sensors

FACTS = CauseFacts(
    id="device_factor",
    kind="gross",
    sentence="The timer or a constant of the program is wrong by a factor.",
    signature="reading / reference is the same at all distances, far from 1, and the ratio of no two units",
    source="forum.arduino.cc 469281: always 1.50 between two ways to time an echo; arendst/Tasmota #18743: "
    "4 times the distance",
    parameters=(Quantity("factor", "1", "reading over what it should be"),),
    check="look up the clock frequency, the timer's divider and the constants of the device's program",
    prior=0.01,
    formula="reading' = factor * reading, in every row",
    needs=("reference_distance",),
    repair="divides readings and echo times by the factor",
)


class _Line(NamedTuple):
    """Readings as a line over what the distance is along the beam.

    Attributes
    ----------
    factor, uncertainty : float
        Slope, and its standard uncertainty.
    scatter : float
        Robust standard deviation around it [m].
    shared : float
        Part of the rows whose own ratio is near the slope.
    """

    factor: float
    uncertainty: float
    scatter: float
    shared: float


def detect(view: View, _: object, settings: FaultSettings) -> Found | None:
    """Compare the slope of the readings over the reference with 1.

    A recorded angle may make the distance along the beam longer or shorter in proportion. So the slope is
    fitted over the distance itself, over distance / cos(angle) and over distance cos(angle).
    """
    if view.reference is None or view.given is not None:
        return None
    near, usual = settings.factor.near, np.exp(settings.factor.spread)
    low, high = view.ratios
    if not (high > usual or low < 1 / usual):
        return None
    lines = [line for line in _lines(view, near) if line.shared >= settings.factor.most]
    if not lines:
        return None
    likely = np.array([-len(view) * np.log(line.scatter) for line in lines])
    with_it = [log_free(float(np.log(line.factor))) for line in lines]
    without = [
        log_usual(float(np.log(line.factor)), settings.factor, line.uncertainty / line.factor)
        for line in lines
    ]
    evidence = np.logaddexp.reduce(likely + with_it) - np.logaddexp.reduce(likely + without)
    if evidence < 0.0:  # a usual error of scale is more probable, which the glance above has not looked for
        return None
    found = lines[int(likely.argmax())]
    because = (
        f"readings are {found.factor:.2f} times the reference distance, at all distances "
        f"({concise(found.factor, found.uncertainty)}); the rest of the diagnosis divides them by that"
    )
    every = np.ones(len(view), dtype=bool)
    repaired = divided(view, every, FACTS.id, found.factor)
    return Found(every, float(evidence), because, ((found.factor, found.uncertainty),), repaired)


def _lines(view: View, near: float) -> Iterator[_Line]:
    """Lines over each length that the distance may be along the beam, that rise as a factor does."""
    assert view.reference is not None
    known = np.flatnonzero(np.isfinite(view.indication) & np.isfinite(view.reference) & (view.indication > 0))
    known = known[:: max(1, len(known) // _ENOUGH)]
    reference, indication = view.reference[known], view.indication[known]
    if len(known) < _FEWEST or np.ptp(reference) == 0:
        return  # one distance does not tell a factor from a wrong reference
    angle = view.observations.conditions.get("angle")
    cosine = np.ones(1) if angle is None else np.cos(angle[known])
    for power in (0,) if angle is None else (0, -1, 1):
        with np.errstate(all="ignore"):
            along = reference * cosine**power
        if np.isfinite(along).all() and (line := _line(along, indication, near)) is not None:
            yield line


def _line(along: Column, indication: Column, near: float) -> _Line | None:
    """Fit a line: least absolute deviations, then least squares without outliers.

    It goes through zero, unless an offset is worth its parameter by the BIC (Schwarz 1978).
    """
    columns = np.stack([np.ones_like(along), along])
    left = indication - least_absolute(columns, indication) @ columns
    scatter = max(MAD_TO_SD * float(np.median(np.abs(left))), _LEAST)
    inside = np.abs(left) <= _INSIDE * scatter
    columns, values = columns[:, inside], indication[inside]
    if not np.ptp(columns[1]) > 0:
        return None
    covariance = scatter**2 * np.linalg.inv(columns @ columns.T)
    offset, factor = covariance @ (columns @ values) / scatter**2
    uncertainty = covariance[1, 1] ** 0.5
    if offset**2 < covariance[0, 0] * np.log(len(values)):
        square = float(columns[1] @ columns[1])
        factor, uncertainty = columns[1] @ values / square, scatter / square**0.5
    if factor <= 0.0:
        return None
    shared = float(np.mean(np.abs(np.log(indication / (factor * along))) < near))
    return _Line(float(factor), float(uncertainty), scatter, shared)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Multiply all readings, as the wrong clock frequency does."""
    table["reading_m"] = table["reading_m"] * random.choice([0.64, 1.2, 1.5, 3.9, 4.0])


FAULT = Fault(FACTS, detect, spoil)
