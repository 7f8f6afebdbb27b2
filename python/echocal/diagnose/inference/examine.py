"""Build the columns of every candidate, and pass over the rows once."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import effect_candidates
from echocal.diagnose.candidates.scene import Scene
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


def examine(
    table: Table, base: Base, folds: Folds, seed: int, settings: Settings, offsets: Column | None = None
) -> Case:
    """Build the columns and pass over them once.

    The residual is that of docs/method.md, Eq. 1; the columns are those of Eq. 2. `offsets` are
    those of placements that a noise explains [m]; they are subtracted from the residual (Eq. 18a).
    """
    distance = table.distance(base.model())
    groups = None if table.reference is not None else table.groups
    residual = table.indication - base.expected(distance, table.conditions)
    if offsets is not None:
        residual = residual - offsets
    scene = Scene(
        base,
        distance,
        table.conditions,
        table.distance,
        groups,
        residual,
        settings,
        table.echoes,
        table.stated_speed,
        table.thermometers,
    )
    found = Candidates(scene.columns())
    found.columns.slope()  # first: what a group's own level adds
    effect_candidates(found, scene)
    order, rows = table.order, np.flatnonzero(folds.fit[folds.blocks])
    found.aside = set_aside(scene, order, table.known, table.extra, rows, len(found.columns))
    recorded = {**table.known, **table.extra}
    against = {name: column for name, column in recorded.items() if name not in found.aside}
    term_candidates(found, against, settings.terms, known_distance=groups is None)
    found.columns.store(residual)  # last: what is to be explained
    sums = Sums.gather(found.columns, order, folds.blocks, at_first(order, settings.noise_models))
    sums = drop_infinite(found, sums)
    drop_invisible(found, sums, residual, settings.priors)
    if sums.correlations == (WHITE,):
        others = that_may_be_there(found.columns, sums, residual, settings.noise_models)
        sums = sums.with_correlations(found.columns, others) if others else sums
    return Case(table, base, found, residual, sums, folds, seed, settings, offsets=offsets)
