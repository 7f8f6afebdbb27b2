"""A table with the columns of its candidates and the sums over its rows."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import Candidates, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack
from echocal.diagnose.inference.noise import Convection, Noise, NoiseCorrelation, noises
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings

__all__ = ["Case"]


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
    settings : Settings
    signals : dict
        What was made before, by columns and sizes.
    hypotheses : dict
        Hypotheses that were made before, by forms and prior.
    fits : dict
        Fits to some blocks under one noise that were made before, by noise, blocks and hypothesis.
    probable : tuple of Noise, or None
        Noises that are considered; None for all that the table allows.
    offsets : ndarray, shape (n,), or None
        Offsets of placements or of the level that a noise explains [m]. The residual is without them, the
        table is not.
    remarks : tuple of str
        Sentences for the user on what was done to the residual.
    """

    table: Table
    base: Base
    found: Candidates
    residual: NDArray[np.float64]
    sums: Sums
    folds: Folds
    seed: int
    settings: Settings
    signals: dict[tuple[Any, ...], NDArray[np.float64]] = field(default_factory=dict, repr=False)
    hypotheses: dict[tuple[tuple[int, ...], float], Hypothesis] = field(default_factory=dict, repr=False)
    fits: dict[tuple[Any, ...], HypothesisFit] = field(default_factory=dict, repr=False)
    probable: tuple[Noise, ...] | None = None
    offsets: NDArray[np.float64] | None = None
    remarks: tuple[str, ...] = ()

    @cached_property
    def table_without_offsets(self) -> Table:
        """The table with readings that have no offsets."""
        if self.offsets is None:
            return self.table
        return replace(self.table, indication=self.table.indication - self.offsets)

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
        if self.probable is not None:
            return self.probable
        found = tuple(one for one in self.sums.correlations if isinstance(one, Convection))
        return tuple(
            noise
            for noise in noises(self.settings.noise_models, self.at_stations, found, self.at_levels)
            if self.sums.has(noise)
        )

    @property
    def usual_noises(self) -> tuple[Noise, ...]:
        """Those that do not depend on the distance, whether summed or not: each kind with all its prior."""
        return noises(self.settings.noise_models, self.at_stations, levels=self.at_levels)

    @property
    def at_stations(self) -> bool:
        """Whether rows are at several stations, each of which may err by itself."""
        return not self.sums.flat_level and len(np.unique(self.sums.cell_group)) > 1

    @property
    def at_levels(self) -> bool:
        """Whether these are no stations, but the levels of a column."""
        return bool(self.table.grouped_by)

    @property
    def at_distances(self) -> bool:
        """Whether rows are at known distances that differ: noise may grow with them."""
        reference = self.table.reference
        least = self.settings.noise_models.distance_spread
        return reference is not None and float(np.ptp(reference)) > least * float(reference.mean())

    def left(self, fit: HypothesisFit, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Residual of the base less what a hypothesis makes of it, at some rows [m]."""
        variants = fit.hypothesis.variants
        fixed = [v.offset for v in variants if v.offset is not None]
        free = [column for v in variants for column in v.free]
        sizes = np.concatenate([np.ones(len(fixed)), fit.mean])
        return np.asarray(self.residual[rows] - sizes @ self.found.columns.at([*fixed, *free], rows))

    def with_correlations(self, correlations: Sequence[NoiseCorrelation]) -> "Case":
        """The same, the rows summed for more noises: one more pass over them."""
        return replace(self, sums=self.sums.with_correlations(self.found.columns, correlations))

    def stack(self, blocks: NDArray[np.bool_]) -> Stack:
        """Whitened products over some blocks, one per noise."""
        products, log_weight = self.sums.whiten_all(self.noises, blocks)
        return Stack(products, log_weight, self.sums.degrees(blocks), self.noises)
