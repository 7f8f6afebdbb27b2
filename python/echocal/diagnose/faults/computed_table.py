"""A table that nobody measured."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

_SAMPLE = 1000  # rows of a first look


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    scatter: float = threshold(2e-5, "m", "scatter that no such sensor has: 0.1 us of echo time; judgement")
    usual: float = threshold(3e-4, "m", "least scatter of a real sensor; HC-SR04s on a bench")
    rounding: float = threshold(
        2e-4, "m", "step of the readings above which rounding may hide the scatter of a sensor; argument"
    )
    spare: int = threshold(
        12, "1", "rows more than the coefficients of the smooth law that is fitted; judgement"
    )


FACTS = CauseFacts(
    id="computed_table",
    kind="gross",
    sentence="The readings were computed by a formula; nobody measured them.",
    signature="readings follow a smooth law of distance and temperature to the last digit, without scatter",
    source="argument: an echo detector with a threshold scatters by a part of its 25 us period",
    parameters=(Quantity("scatter", "m", "standard deviation around a smooth law"),),
    check="repeat one reading ten times: a sensor gives different values",
    prior=0.01,
    formula="reading' = f(distance, temperature), rounded",
    needs=("reference_distance",),
    repair="none: a law that was computed can be compared with another one; it is no evidence on a sensor",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Fit a smooth law of distance and temperature; its residuals are at most the rounding."""
    reference = view.reference
    if reference is None or view.resolution > own.rounding:
        return None
    rows = np.flatnonzero(view.good)
    limit = max(own.scatter, 0.4 * view.resolution)
    if len(rows) > _SAMPLE:  # a sensor's scatter shows in few rows
        few = _fitted(view, reference, rows[:: len(rows) // _SAMPLE], own)
        if few is None or few[0] > 3.0 * limit:
            return None
    fitted = _fitted(view, reference, rows, own)
    if fitted is None or fitted[0] > limit:
        return None
    scatter, freedom = fitted
    evidence = freedom * float(np.log(own.usual / max(scatter, 1e-7)))
    because = (
        f"the readings of {len(rows)} rows differ from a smooth law of distance and temperature by "
        f"{1e6 * scatter:.1f} um (standard deviation); a sensor scatters by {1e6 * own.usual:.0f} um and more"
    )
    mask = np.zeros(len(view), dtype=bool)
    mask[rows] = True
    return Found(mask, evidence, because, (scatter,), view.observations, share=0.0)


def _fitted(view: View, reference: np.ndarray, rows: np.ndarray, own: Thresholds) -> tuple[float, int] | None:
    """Scatter around a smooth law [m], and the rows less the coefficients; None if it cannot be fitted."""
    design = _design(reference[rows], None if view.temperature is None else view.temperature[rows])
    if len(rows) < design.shape[1] + own.spare:
        return None
    error = (view.indication - reference)[rows]
    if not np.isfinite(error).all() or not np.isfinite(design).all():
        return None
    center = design.mean(axis=0)
    scale = np.sqrt(((design - center) ** 2).sum(axis=0))
    kept = scale > 1e-9 * np.sqrt(len(rows))
    unit = np.column_stack([np.ones(len(rows)), (design - center)[:, kept] / scale[kept]])
    left = error - unit @ np.linalg.lstsq(unit, error, rcond=None)[0]
    freedom = len(rows) - unit.shape[1]
    return float(np.sqrt(left @ left / freedom)), freedom


def _design(distance: np.ndarray, temperature: np.ndarray | None) -> np.ndarray:
    """Smooth functions of distance and temperature: every law of sound speed is one of them to 1 um."""
    columns = [distance, distance**2, distance**3]
    if temperature is not None:
        warm = (temperature - 25.0) / 25.0
        columns += [warm, warm**2, *(distance * warm**power for power in range(1, 6))]
    return np.column_stack(columns)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Compute the readings with another law of the speed of sound."""
    temperature, distance = table["temperature_C"], table.get("distance_m", table["reading_m"])
    slope = random.uniform(0.59, 0.61)
    table["reading_m"][:] = np.round(
        distance * (331.4 + 0.6 * temperature) / (331.3 + slope * temperature), 6
    )


FAULT = Fault(FACTS, detect, spoil, Thresholds())
