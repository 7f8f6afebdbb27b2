"""What a model gains outside its fitted range: at other distances, temperatures, humidities."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.findings.parts import Shifted
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.selection.claims import columns_of, effects_of, without
from echocal.diagnose.validation.gain import errors
from echocal.model import Model
from echocal.observations.quantiles import quantiles
from echocal.quantities import QUANTITIES

__all__ = ["shifted"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_ALONG = ("distance", *(name for name, facts in QUANTITIES.items() if facts.judged_outside))
_INNER = (0.2, 0.8)  # quantiles: the model is fitted inside, and its error is measured outside
_FEWEST = 5  # distinct values of a column that has a middle range
_MOST, _RUN = 100_000, 1000  # most rows that are used, and rows of a run


def shifted(case: Case, hypothesis: Hypothesis, causes: Sequence[str], noise: Noise) -> tuple[Shifted, ...]:
    """Fit to the middle range of each column, and measure the error of the rows outside.

    The rows of a fold are similar to the fitted ones, so a wrong cause costs little there; under
    other conditions it costs more. A column with few values, or with few rows outside its middle
    range, is left out.

    Parameters
    ----------
    case : Case
    hypothesis : Hypothesis
        What is fitted.
    causes : sequence of str
        Effects of the hypothesis that the model has.
    noise : Noise
    """
    if not causes:
        return ()
    hypothesis = without(hypothesis, UNKNOWN)  # a term holds in its own range only
    found = []
    recorded, seen = case.table.against(), _seen(case)
    for name in (name for name in _ALONG if name in recorded):
        one = _along(case, hypothesis, causes, noise, name, recorded[name][seen], seen)
        if one is not None:
            found.append(one)
    return tuple(found)


def _along(
    case: Case,
    hypothesis: Hypothesis,
    causes: Sequence[str],
    noise: Noise,
    name: str,
    column: Column,
    seen: Labels,
) -> Shifted | None:
    """Fit to the middle range of one column, given at the rows that are used."""
    if np.isnan(column).any() or not _varies(column, _FEWEST):
        return None
    low, high = quantiles(column, _INNER)
    middle = (low <= column) & (column <= high)
    inside, outside = seen[middle], seen[~middle]
    if min(len(inside), len(outside)) < case.settings.rows.fewest:
        return None
    model = _fit(case, hypothesis, causes, noise, inside)
    before, after = (_rms(case, one, inside, outside) for one in (case.base.plain, model))
    if not np.isfinite(before) or not np.isfinite(after):
        return None  # the rows outside have no level inside
    return Shifted(name, low, high, len(outside), before, after)


def _varies(column: Column, fewest: int) -> bool:
    """Whether a column has enough values; the first rows are mostly enough to decide."""
    return any(len(np.unique(some)) >= fewest for some in (column[:_RUN], column))


def _seen(case: Case) -> Labels:
    """Rows that are not held out; of very many rows, evenly spread runs."""
    count = len(case.table)
    firsts = np.arange(0, count, _RUN * (1 + count // _MOST))
    rows = (firsts[:, None] + np.arange(_RUN)).ravel()
    rows = rows[: np.searchsorted(rows, count)]
    return np.asarray(rows[case.folds.fit[case.folds.blocks[rows]]])


def _fit(case: Case, hypothesis: Hypothesis, causes: Sequence[str], noise: Noise, at: Labels) -> Model:
    """The model with the causes, fitted to some rows."""
    table = case.table
    used = [0, *sorted({c for v in hypothesis.variants for c in v.columns}), len(case.found.columns) - 1]
    given = {name: column[at] for name, column in table.conditions.items()}
    columns = Columns(case.base.plain, np.ones(len(at)), given, None)
    for column in case.found.columns.at(used, at):
        columns.store(column)
    order = case.sums.order.at(at)
    groups = np.unique(order.groups, return_inverse=True)[1].astype(np.int64)
    blocks = np.zeros(len(at), dtype=np.int64)
    sums = Sums.gather(columns, replace(order, groups=groups), blocks, [noise.correlation])
    moved = replace(hypothesis, variants=tuple(_moved(v, used) for v in hypothesis.variants))
    fitted = fit_hypothesis(moved, Stack.of([sums.whiten(noise)], sums.degrees(np.array([True]))))
    return case.base.model(effects_of(fitted, causes), columns=columns_of(fitted, causes))


def _moved(variant: Variant, used: Sequence[int]) -> Variant:
    """The same form over a selection of columns."""
    offset = None if variant.offset is None else used.index(variant.offset)
    return replace(variant, offset=offset, free=tuple(used.index(column) for column in variant.free))


def _rms(case: Case, model: Model, inside: Labels, outside: Labels) -> float:
    table = case.table
    if table.reference is not None:
        error = table.correct(model, outside) - table.reference[outside]
    else:
        level_from = np.zeros(len(table), dtype=bool)
        level_from[inside] = True
        error = errors(table, model, level_from)[outside]
    known = np.isfinite(error)
    return float(np.sqrt(np.mean(error[known] ** 2))) if known.any() else np.nan
