"""Everything between the rows and the verdict."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.effects import UNKNOWN, Candidates, Scene, Variant, effect_candidates
from echocal.diagnose.candidates.unexplained_terms import shape_candidates
from echocal.diagnose.findings.sentences import Recorded
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.inference.autocorrelation import at_first, that_may_be_there
from echocal.diagnose.inference.hypothesis import Stack, Weighed
from echocal.diagnose.inference.noise import FINEST, WHITE, Convection, Noise, noises
from echocal.diagnose.inference.shortlist import set_aside
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.preprocess.scene import Table

__all__ = ["INVISIBLE", "Case", "examine"]

INVISIBLE = "cannot show in these data"
"""Why a cause was left out that no size would make visible."""

_VISIBLE = 0.5  # signal over noise, summed over rows
_SPREAD = 0.1  # of the distances, part of their mean, from which on noise may be seen to grow with them


@dataclass(frozen=True)
class Case:
    """A table, the columns of its candidates and the sums over its rows.

    Attributes
    ----------
    table : Table
    base : Base
    found : Candidates
    residual : ndarray, shape (n,)
        Reading less what the base simulation predicts [m].
    sums : Sums
    folds : Folds
    seed : int
    signals : dict
        What was made before, by columns and sizes.
    """

    table: Table
    base: Base
    found: Candidates
    residual: NDArray[np.float64]
    sums: Sums
    folds: Folds
    seed: int
    signals: dict[tuple[Any, ...], NDArray[np.float64]] = field(default_factory=dict, repr=False)

    @cached_property
    def recorded(self) -> Recorded:
        """Columns that what a cause adds may follow."""
        return Recorded(self.table.against())

    def signal(self, variant: Variant, mean: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """What a cause adds to every reading [m]; not to be written to, for it is made once."""
        key = variant.columns, variant.offset, mean.tobytes()
        if key not in self.signals:
            fixed = [] if variant.offset is None else [variant.offset]
            factors = np.concatenate([np.ones(len(fixed)), mean])
            self.signals[key] = self.found.columns.combined([*fixed, *variant.free], factors)
        return self.signals[key]

    @property
    def noises(self) -> tuple[Noise, ...]:
        """Noises that the table allows."""
        found = [memory for memory in self.sums.memories if isinstance(memory, Convection)]
        return tuple(noise for noise in noises(self.at_stands, found) if self.sums.has(noise))

    @property
    def usual_noises(self) -> tuple[Noise, ...]:
        """Those that do not depend on the distance, whether summed or not: each kind with all its prior."""
        return noises(self.at_stands)

    @property
    def at_stands(self) -> bool:
        """Whether rows are at several stands, each of which may err by itself."""
        return not self.sums.flat_level and len(np.unique(self.sums.cell_group)) > 1

    @property
    def at_distances(self) -> bool:
        """Whether rows are at known distances that differ: noise may grow with them."""
        reference = self.table.reference
        return reference is not None and float(np.ptp(reference)) > _SPREAD * float(reference.mean())

    def left(self, weighed: Weighed, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Residual of the base less what a hypothesis makes of it, at some rows [m]."""
        variants = weighed.hypothesis.variants
        fixed = [v.offset for v in variants if v.offset is not None]
        free = [column for v in variants for column in v.free]
        sizes = np.concatenate([np.ones(len(fixed)), weighed.mean])
        return np.asarray(self.residual[rows] - sizes @ self.found.columns.at([*fixed, *free], rows))

    def stack(self, blocks: NDArray[np.bool_]) -> Stack:
        """Whitened products over some blocks, one per noise."""
        products, log_weight = self.sums.whiten_all(self.noises, blocks)
        return Stack(products, log_weight, self.sums.degrees(blocks), self.noises)


def examine(table: Table, base: Base, folds: Folds, seed: int) -> Case:
    """Build the columns and pass over them once."""
    distance = table.distance(base.model())
    groups = None if table.reference is not None else table.groups
    residual = table.indication - base.expected(distance, table.conditions)
    scene = Scene(base, distance, table.conditions, table.distance, groups, residual, table.echoes)
    found = Candidates(scene.columns())
    found.columns.slope()  # first: what a group's own level adds
    effect_candidates(found, scene)
    order, rows = _order(table), np.flatnonzero(folds.fit[folds.blocks])
    found.aside = set_aside(scene, order, table.known(), table.extra, rows, len(found.columns))
    against = {name: column for name, column in table.against().items() if name not in found.aside}
    shape_candidates(found, against, known_distance=groups is None)
    found.columns.store(residual)  # last: what is to be explained
    sums = Sums.gather(found.columns, order, folds.blocks, at_first(order))
    _drop_infinite(found, sums)
    _drop_invisible(found, sums, residual)
    if sums.memories == [WHITE] and (others := that_may_be_there(found.columns, sums, residual)):
        sums.remember(found.columns, others)
    return Case(table, base, found, residual, sums, folds, seed)


def _order(table: Table) -> Order:
    distance = table.indication if table.reference is None else table.reference
    return Order(table.starts, table.groups, distance, flat_level=table.reference is None)


def _drop_infinite(found: Candidates, sums: Sums) -> None:
    """Drop causes whose columns are not finite in these data."""
    finite = sums.clear_infinite()
    if finite.all():
        return
    broken = {v.cause for v in found.variants if not finite[list(v.columns)].all()}
    found.skipped.update(dict.fromkeys(broken, "not finite in these data"))
    found.variants[:] = [v for v in found.variants if v.cause not in broken]


def _drop_invisible(found: Candidates, sums: Sums, residual: NDArray[np.float64]) -> None:
    """Drop causes that could not show in these data even at three times their usual size.

    Weighing them would only spread probability over causes that nobody can see.
    """
    used = np.ones(len(sums.rows), dtype=bool)
    products = sums.whiten(Noise(0.0, 0.0, 0.0, 1.0), used).products
    variance = min(_of_steps(residual, sums.order), products[-1, -1] / sums.degrees())
    shape = Geometry(products, max(variance, FINEST**2))
    visible = 3 * shape.visibilities(found.variants) > _VISIBLE
    kept = {v.cause for v, shows in zip(found.variants, visible, strict=True) if shows or v.cause == UNKNOWN}
    for variant in found.variants:
        if variant.cause not in kept:
            found.skipped[variant.cause] = INVISIBLE
    found.variants[:] = [v for v in found.variants if v.cause in kept]


def _of_steps(residual: NDArray[np.float64], order: Order) -> float:
    """Variance of the noise alone [m^2], whatever slow effects there are: half the mean square step."""
    steps = np.diff(residual)[~order.starts[1:]]
    return float(np.nansum(steps**2)) / 2 / max(len(steps), 1)
