"""Build the columns of every candidate, and pass over the rows once."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import effect_candidates
from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.slow_air import slow_air_columns
from echocal.diagnose.candidates.systematic import systematic_columns
from echocal.diagnose.candidates.unexplained_terms import term_candidates
from echocal.diagnose.candidates.variant import Candidates
from echocal.diagnose.inference.autocorrelation import at_first, that_may_be_there
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import WHITE
from echocal.diagnose.inference.shortlist import set_aside
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.inference.visible import drop_infinite, drop_invisible
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings

__all__ = ["examine"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_WIDE = 250  # columns of a table without slow air, which makes three times the products


def examine(
    table: Table,
    base: Base,
    folds: Folds,
    seed: int,
    settings: Settings,
    offsets: Column | None = None,
    steps: Labels | None = None,
    averaged: Mapping[str, Labels] = MappingProxyType({}),
) -> Case:
    """Build the columns and pass over them once.

    The residual is that of docs/method.md, Eq. 1; the columns are those of Eq. 2. `offsets` are those of
    placements that a noise explains [m]; docs/method/noises.md, Eq. 18a subtracts them from the residual.
    `steps` are positions of rows at which the level may change: each has a column, which is no cause.
    `averaged` has the segments in which an effect has no more than its mean, by id.
    """
    residual = table.indication - base.expected(table.distance(base.model()), table.conditions)
    if offsets is not None:
        residual = residual - offsets
    still = residual if steps is None else _without_steps(residual, table.groups, steps)
    scene = Scene(table, base, still, settings)
    found = Candidates(scene.columns())
    found.columns.slope()  # first: what a group's own level adds
    if steps is not None:
        found.steps = _step_columns(found, table, steps, settings.rows.step_height)
    effect_candidates(found, scene)
    for cause, segment in averaged.items():
        found.average(cause, segment)
    found.systematic = systematic_columns(found, scene)
    order, rows = table.order, np.flatnonzero(folds.fit[folds.blocks])
    found.aside = set_aside(scene, order, table.known, table.extra, rows, len(found.columns))
    recorded = {**table.known, **table.extra}
    against = {name: column for name, column in recorded.items() if name not in found.aside}
    term_candidates(
        found, against, settings.terms, known_distance=table.reference is not None, further=table.extra
    )
    if len(found.columns) <= _WIDE:
        found.slow_air = slow_air_columns(found, scene)
    found.columns.store(residual)  # last: what is to be explained
    sums = Sums.gather(found.columns, order, folds.blocks, at_first(order, settings.noise_models))
    sums = drop_infinite(found, sums)
    drop_invisible(found, sums, still, settings.priors)
    if sums.correlations == (WHITE,):
        others = that_may_be_there(found.columns, sums, residual, settings.noise_models)
        sums = sums.with_correlations(found.columns, others) if others else sums
    return Case(table, base, found, residual, sums, folds, seed, settings, offsets=offsets)


def _step_columns(found: Candidates, table: Table, steps: Labels, height: float) -> tuple[int, ...]:
    """Add a column for each step of the level, of one prior standard deviation."""
    slope, rows = found.columns[0], np.arange(len(table))
    after = ((rows >= step) & (table.groups == table.groups[step]) for step in steps.tolist())
    return tuple(found.columns.store(height * slope * later) for later in after)


def _without_steps(residual: Column, groups: Labels, steps: Labels) -> Column:
    """Residual less the mean of each part between two steps."""
    first = np.zeros(len(residual), dtype=np.int64)
    first[steps] = 1
    parts = np.unique((np.cumsum(first) + len(residual) * groups), return_inverse=True)[1]
    means = np.bincount(parts, residual) / np.bincount(parts)
    return np.asarray(residual - means[parts])
