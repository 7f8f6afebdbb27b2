"""Temperature and humidity exchanged."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.likelihood import by_echoes
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.quantization_grid import find_grid
from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations import Observations

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_CANDIDATES = 12  # largest jumps that are looked at, and crossings, besides the change of roughness
_WINDOWS = (30, 15, 8)  # rows on each side: the line of the middle one, and whether it bends
_FITS = [np.linalg.pinv(np.stack([np.ones(n), np.arange(n)], axis=1)) for n in _WINDOWS]
_NEAR = 60  # rows around a change of roughness in which the seam is looked for
_ENOUGH = 3_000  # rows on each side that tell enough
_MARGIN = 8  # rows beside a seam whose steps do not count, as the seam may be some rows off
_FLOOR = np.array([0.5, 0.01])  # level, and its change per row, to which nobody knows them
_ALIKE = 0.95  # largest autocorrelation of 30 rows with a line taken off, which lowers it by 0.1
_COLDEST, _HOTTEST = -60.0, 60.0  # degC, of air: the record is 57 degC (WMO, 1913)


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    line: float = threshold(
        20.0, "1", "largest log likelihood of a line that goes on as the other column's; judgement"
    )
    roughness: float = threshold(
        8.0, "1", "largest log likelihood of a change of roughness: that of air changes too; judgement"
    )
    step: float = threshold(
        20.0, "1", "log Bayes factor of steps of the values that are exchanged, or that stay; judgement"
    )
    range: float = threshold(
        8.0, "1", "log Bayes factor of temperatures that no air has, one way but not the other; judgement"
    )


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
    warm, humid = (view.observations.conditions[name] for name in FACTS.needs)
    known = np.flatnonzero(np.isfinite(warm) & np.isfinite(humid))
    if len(known) < 2 * _WINDOWS[0]:
        return None
    columns = np.stack([some(warm, known), 100.0 * some(humid, known)])
    evidence, seam = _likeliest(columns, own)
    if not np.isfinite(evidence):
        return None
    edge = int(known[seam])
    swapped = np.arange(len(warm)) >= edge
    after, before = (by_echoes(view, _exchanged(view, part), part) for part in (swapped, ~swapped))
    hotter = float(np.median(columns[0, :seam])) > float(np.median(columns[1, :seam]))
    if before > after or (before == after and hotter):  # the air of this planet has more percent than degrees
        swapped = ~swapped
    evidence += max(before, after) - float(np.log(len(known)))
    at, percent = [edge - 1, edge], 100.0 * humid
    because = (
        f"from row {edge} to {edge + 1} the temperature goes from {warm[at[0]]:.1f} to {warm[at[1]]:.1f}, "
        f"the humidity from {percent[at[0]]:.1f} to {percent[at[1]]:.1f}; each goes on as the other did; "
        f"exchanged back in {listed(swapped)}"
    )
    first = int(np.flatnonzero(swapped)[0])
    return Found(swapped, evidence, because, (first + 1,), _exchanged(view, swapped))


def _seams(columns: Column) -> list[int]:
    """Rows at which the columns may change places: jumps, crossings, and a change of roughness."""
    steps = np.abs(np.diff(columns))
    jump = steps.sum(axis=0)
    rows = set((1 + np.argpartition(-jump, min(_CANDIDATES, len(jump) - 1))[:_CANDIDATES]).tolist())
    crossed = np.flatnonzero(np.diff(columns[0] > columns[1])) + 1
    apart = crossed[np.append(True, np.diff(crossed) > _WINDOWS[0])[: len(crossed)]]
    rows |= set(apart[:: -(-len(apart) // _CANDIDATES) or 1].tolist())
    steps += 0.02 + 0.02 * np.median(steps[:, :: max(1, len(jump) // _ENOUGH)], axis=1, keepdims=True)
    rough = np.log(steps[0] / steps[1])
    rows.add(_refined(columns, 1 + int(np.abs(np.cumsum(rough - rough.mean())).argmax())))
    return sorted(row for row in rows if _WINDOWS[0] <= row <= columns.shape[1] - _WINDOWS[0])


def _refined(columns: Column, row: int) -> int:
    """The row near a change of roughness from which on each column's steps are best those of the other."""
    first, last = max(row - _NEAR, 1), min(row + _NEAR, columns.shape[1] - 1)
    before = np.abs(np.diff(columns[:, :row])).mean(axis=1, keepdims=True) + 1e-9
    steps = np.abs(np.diff(columns[:, first - 1 : last]))
    own, other = (steps / before).sum(axis=0), (steps / before[::-1]).sum(axis=0)
    across = (np.abs(columns[::-1, first:last] - columns[:, first - 1 : last - 1]) / before).sum(axis=0)
    return first + int(np.argmin(np.cumsum(own) - own + across + other.sum() - np.cumsum(other)))


def _likeliest(columns: Column, own: Thresholds) -> tuple[float, int]:
    """Log Bayes factor of an exchange from the likeliest row on, and this row.

    The steps of the values are looked for only where they may make a row the likeliest one: that takes long.
    """
    seams = sorted(((*_continued(columns, row, own), row) for row in _seams(columns)), reverse=True)
    best = -np.inf, 0
    for log, rough, row in seams:
        if log + max(own.step, own.roughness) < best[0]:
            break
        if np.isfinite(log):
            best = max(best, (log + (own.step * _steps(*_around(columns, row)) or rough), row))
    return best


def _around(columns: Column, row: int) -> tuple[Column, int]:
    """Rows on each side of a row that tell enough, and its place among them."""
    return columns[:, max(0, row - _ENOUGH) : row + _ENOUGH], min(row, _ENOUGH)


def _continued(columns: Column, row: int, own: Thresholds) -> tuple[float, float]:
    """Log Bayes factor of an exchange from a row on, without that of roughness, and that of roughness.

    The level and the slope go on in one way only, unless the columns cross in parallel. The temperatures that
    air has may decide too, and the roughness, where the steps of the values do not.
    """
    columns, row = _around(columns, row)
    sides = [[_line(column[:row][::-1], -1.0), _line(column[row:], 1.0)] for column in columns]
    misfit = [
        sum(
            float((((a - b) ** 2) / (u + v)).sum())
            for (a, u), (b, v) in ((sides[which][0], sides[(which + other) % 2][1]) for which in (0, 1))
        )
        for other in (0, 1)
    ]
    straight, exchanged = np.minimum(misfit, 2 * own.line)
    if exchanged == 2 * own.line:
        return -np.inf, 0.0
    before, after = np.abs(np.diff(columns[:, :row])), np.abs(np.diff(columns[:, row:]))
    scale = np.median(before, axis=1, keepdims=True) / np.log(2) + 0.05  # of a Laplace distribution
    rough = float((np.minimum(after / scale, 8.0) - np.minimum(after / scale[::-1], 8.0)).sum())
    rough = float(np.clip(rough, -own.roughness, own.roughness))
    return 0.5 * float(straight - exchanged) + own.range * _ranges(columns, row), rough


def _line(values: Column, direction: float) -> tuple[Column, Column]:
    """Level and slope at a seam of the rows from it on, and their variances: of the noise, and of a bend."""
    fits = np.array([fit @ values[: fit.shape[1]] for fit in _FITS])
    left = values[: _WINDOWS[0]] - fits[0, 0] - fits[0, 1] * np.arange(_WINDOWS[0])
    alike = float(left[1:] @ left[:-1]) / max(float(left @ left), 1e-12) + 0.1
    alike = min(max(alike, 0.0), _ALIKE)
    noise = float(left.var()) * (1 + alike) / (1 - alike)
    each = np.array([[4 * noise / n, 12 * noise / n**3] for n in _WINDOWS])
    bends = [np.maximum((fits[1] - fits[k]) ** 2 - each[1] - each[k], 0.0) for k in (0, 2)]
    return fits[1] * [1.0, direction], each[1] + bends[0] + bends[1] + _FLOOR**2


def _steps(columns: Column, row: int) -> int:
    """Whether the numbers of one column have the step of the other from the row on: 1, or -1 if not."""
    warm, humid = (_step(column[: row - _MARGIN]) for column in columns)
    if np.isclose(warm, humid, rtol=0.1):
        return 0
    warm_after, humid_after = (_step(column[row + _MARGIN :]) for column in columns)
    same = np.allclose((warm, humid), (warm_after, humid_after), rtol=0.1)
    return -int(same) or int(np.allclose((warm, humid), (humid_after, warm_after), rtol=0.1))


def _step(values: Column) -> float:
    """Step of some values; 0 where they have none."""
    grid = find_grid(values) if len(values) else None
    return 0.0 if grid is None else grid.step


def _ranges(columns: Column, row: int) -> int:
    """Whether only an exchange, or only none, has temperatures that air has: 1, or -1."""
    odd = (columns > _HOTTEST) | (columns < _COLDEST)
    (warm, humid), (warm_after, humid_after) = odd[:, :row].sum(axis=1), odd[:, row:].sum(axis=1)
    stays, exchanged = warm + warm_after, min(warm + humid_after, humid + warm_after)
    return int(exchanged == 0 < stays) - int(stays == 0 < exchanged)


def _exchanged(view: View, rows: Mask) -> Observations:
    warm, humid = (view.observations.conditions[name] for name in FACTS.needs)
    return with_values(view, rows, FACTS.id, temperature=100.0 * humid, relative_humidity=warm / 100.0)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Exchange temperature and humidity from some row on."""
    first = int(random.integers(60, len(table["temperature_C"]) - 60))
    warm, humid = table["temperature_C"].copy(), table["humidity_percent"].copy()
    table["temperature_C"][first:], table["humidity_percent"][first:] = humid[first:], warm[first:]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
