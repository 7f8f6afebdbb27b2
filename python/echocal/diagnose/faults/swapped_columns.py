"""Temperature and humidity exchanged."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.crossing import Crossing, at_crossing, crossings, refined
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations import Observations
from echocal.observations.quantiles import median

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_AROUND = 6  # rows before and after a seam that are compared
_CANDIDATES = 12  # largest jumps that are looked at, besides the change of roughness
_ENOUGH = 20_000  # steps that tell which ones are none
_PART = 1000  # rows of which the largest jump is looked at first


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: float = threshold(30, "1", "rows of a table; judgement")
    before: float = threshold(15, "1", "rows before a seam that tell how rough the columns are; judgement")
    outlier: float = threshold(8.0, "1", "scales beyond which a step says no more; judgement")
    fits: float = threshold(3.0, "1", "scales that the levels may differ by across the seam; judgement")
    level: float = threshold(12.0, "1", "largest log likelihood of a difference of levels; judgement")
    witnesses: float = threshold(
        60.0, "1", "rows after the seam that count as independent: neighbors are alike; judgement"
    )
    cap: float = threshold(40.0, "1", "largest log Bayes factor; judgement")
    echoes: float = threshold(
        40.0, "1", "largest log Bayes factor of echo times that fit the reference better, or worse; judgement"
    )
    crossing: Crossing = field(default_factory=Crossing)


FACTS = CauseFacts(
    id="swapped_columns",
    kind="gross",
    sentence="Temperature and humidity changed places, in all rows or from some row on.",
    signature="from one row to the next the temperature goes on as the humidity in percent, and vice versa",
    source="range test; CATALOGUE",
    parameters=(Quantity("first_row", "1", "first row with the columns exchanged"),),
    check="look at the header of the logger's file, and whether its program changed",
    prior=0.005,
    formula="T' = h in percent, h' = T, from first_row on or up to it",
    needs=("temperature", "relative_humidity"),
    repair="exchanges the columns back in the rows concerned",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Look for a row from which on the two columns go on as each other."""
    warm = view.observations.conditions["temperature"]
    percent = 100.0 * view.observations.conditions["relative_humidity"]
    known = np.flatnonzero(np.isfinite(warm) & np.isfinite(percent))
    if len(known) < own.fewest:
        return None
    seam, evidence = _seam((some(warm, known), some(percent, known)), own)
    if not np.isfinite(evidence):
        return None
    edge = int(known[seam])
    swapped = np.arange(len(warm)) >= edge
    after, before = (_by_echoes(view, part, own) for part in (swapped, ~swapped))
    if before > after or (before == after and _drier(warm, percent, ~swapped)):
        swapped = ~swapped
    evidence = min(evidence, own.cap) + max(before, after)
    if evidence <= 0.0:
        return None
    first = int(np.flatnonzero(swapped)[0])
    because = (
        f"from row {edge} to {edge + 1} the temperature goes from {warm[edge - 1]:.1f} to {warm[edge]:.1f}, "
        f"the humidity from {percent[edge - 1]:.1f} to {percent[edge]:.1f}; each goes on as the other did; "
        f"exchanged back in {listed(swapped)}"
    )
    return Found(swapped, min(evidence, own.cap), because, (first + 1,), _exchanged(view, swapped))


def _seam(columns: tuple[Column, Column], settings: Thresholds) -> tuple[int, float]:
    """Row from which on the columns go on as each other, and the evidence for that."""
    rows = len(columns[0])
    steps = np.empty((2, rows - 1))
    for column, own in zip(columns, steps, strict=True):
        np.abs(np.subtract(column[1:], column[:-1], out=own), out=own)
    sample = steps[:, :: max(1, rows // _ENOUGH)]
    floor = 0.02 + 0.02 * np.median(sample, axis=1, keepdims=True)
    rough = steps[0] + floor[0]
    rough /= steps[1] + floor[1]
    np.log(rough, out=rough)
    rough -= rough.mean()
    change = np.abs(np.cumsum(rough, out=rough), out=rough)
    jump = steps.sum(axis=0)
    changed = int(np.argmax(change)) + 1
    rows_of_crossings = crossings(columns, _CANDIDATES)
    seams = {refined(columns, changed), *(1 + _largest(jump)).tolist(), *rows_of_crossings}
    inside = sorted(row for row in seams if settings.before < row < rows - 2)
    until = _until(steps, inside)
    scored = [(*_evidence(columns, steps, until[row], row, settings), row) for row in inside]
    _, evidence, row = max(scored, default=(-np.inf, -np.inf, 0))
    return row, evidence - float(np.log(rows))


def _until(steps: Column, rows: list[int]) -> dict[int, Column]:
    """Steps of each column summed up to the one before the one that leads to each of some rows."""
    found, total, first = {}, np.zeros(2), 0
    for row in rows:
        total = total + steps[:, first : row - 1].sum(axis=1)
        found[row], first = total, row - 1
    return found


def _largest(jump: Column) -> NDArray[np.int64]:
    """Positions of the largest jumps."""
    count = min(_CANDIDATES, len(jump))
    parts = len(jump) // _PART
    least = -np.inf
    if parts > count:  # at least so many jumps are as large as the largest ones of some parts
        largest = jump[: parts * _PART].reshape(parts, _PART).max(axis=1)
        least = np.partition(largest, -count)[-count]
    among = np.flatnonzero(jump >= least)
    return np.asarray(among[np.argpartition(-jump[among], count - 1)[:count]])


def _evidence(
    columns: tuple[Column, Column], steps: Column, until: Column, row: int, settings: Thresholds
) -> tuple[float, float]:
    """Log likelihood ratio of the rows from `row` on: exchanged against as they stand; and what of it counts.

    Steps from row to row are Laplace distributed, with the scales of the rows before; the levels
    across the seam must fit too. `steps` are those of both columns, and `until` their sums before.
    """
    sides = (slice(row - _AROUND, row), slice(row, row + _AROUND))
    ends = np.array([[median(column[side]) for side in sides] for column in columns])
    straight, crossed = np.abs(ends[:, 1] - ends[:, 0]), np.abs(ends[::-1, 1] - ends[:, 0])
    most = 2 * until / (row - 1)  # no median is larger than twice the mean
    if (crossed / _wide(most)).max() > settings.fits:
        return -np.inf, -np.inf
    first, last = max(0, row - _ENOUGH), row + _ENOUGH  # rows around that tell enough
    usual = np.array([median(own[first : row - 1]) for own in steps])
    straight, crossed = straight / _wide(usual), crossed / _wide(usual)
    if crossed.max() > settings.fits:
        return -np.inf, -np.inf
    scale = _scale(usual)
    after = steps[:, row:last]
    stays, changes = (
        float(np.minimum(after / s[:, None], settings.outlier).sum()) for s in (scale, scale[::-1])
    )
    part = min(1.0, settings.witnesses / max(after.shape[1], 1))  # neighbors are no independent witnesses
    roughness = float(part * (stays - changes))
    if straight.max() <= settings.fits:  # where the columns cross, their levels go on either way
        around = (columns[0][first:last], columns[1][first:last])
        evidence = at_crossing(around, row - first, roughness, settings.crossing)
        return max(roughness, evidence), evidence
    levels = float(np.minimum(straight, settings.level).sum() - np.minimum(crossed, settings.level).sum())
    return roughness + levels, roughness + levels


def _by_echoes(view: View, swapped: Mask, settings: Thresholds) -> float:
    """Log Bayes factor of the exchange from recorded echo times: they know the air, readings do not."""
    reference, rows = view.reference, view.good & swapped
    if reference is None or view.observations.reading is not None or not rows.any():
        return 0.0
    others = view.good & ~swapped
    center = median((view.indication - reference)[others]) if others.any() else 0.0
    looks = (view, view.after(_exchanged(view, swapped)))
    misfits = [np.abs(look.indication - reference - center)[rows] for look in looks]
    as_it_is, exchanged = (median(misfit[np.isfinite(misfit)]) + view.scatter for misfit in misfits)
    independent = min(settings.witnesses, float(rows.sum()))
    evidence = 0.5 * independent * float(np.log(as_it_is / exchanged))
    return float(np.clip(evidence, -settings.echoes, settings.echoes))


def _scale(median: Column) -> Column:
    """Scale of a Laplace distribution of steps."""
    return np.asarray(median / np.log(2) + 0.05)


def _wide(median: Column) -> Column:
    """How far levels may differ across a seam, for its evidence to be one."""
    return 3 * _scale(median) + 2.0


def _drier(warm: Column, percent: Column, rows: Mask) -> bool:
    """Whether it is the other part that has the colder, more humid air of this planet."""
    return float(np.nanmedian(warm[rows])) > float(np.nanmedian(percent[rows]))


def _exchanged(view: View, rows: Mask) -> Observations:
    warm, humid = (view.observations.conditions[name] for name in FACTS.needs)
    return with_values(view, rows, FACTS.id, temperature=100.0 * humid, relative_humidity=warm / 100.0)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Exchange temperature and humidity from some row on."""
    first = int(random.integers(60, len(table["temperature_C"]) - 60))
    warm, humid = table["temperature_C"].copy(), table["humidity_percent"].copy()
    table["temperature_C"][first:], table["humidity_percent"][first:] = humid[first:], warm[first:]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
