"""A table with the columns of its candidates and the sums over its rows."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.variant import Candidates, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, HypothesisFit, Stack
from echocal.diagnose.inference.least_squares import averaged_out, ridge
from echocal.diagnose.inference.noise import Convection, Noise, NoiseCorrelation, noises
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings

__all__ = ["Case"]

_SPREAD = 0.1  # of the mean distance: closer distances do not show noise that grows with them


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
    stacks : dict
        Whitened products that were made before, by noise and blocks.
    probable : tuple of Noise, or None
        Noises that are considered; None for all that the table allows.
    offsets : ndarray, shape (n,), or None
        Offsets of placements, of the level or of single rows that a noise explains [m]. The residual is
        without them, the table is not.
    remarks : tuple of str
        Sentences for the user on what was done to the residual.
    moving : str
        How the target moved although its distance is said to be constant; else empty.
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
    stacks: dict[tuple[Noise, bytes], Stack] = field(default_factory=dict, repr=False)
    probable: tuple[Noise, ...] | None = None
    offsets: NDArray[np.float64] | None = None
    remarks: tuple[str, ...] = ()
    moving: str = ""

    @cached_property
    def row_folds(self) -> Folds:
        """The folds of the rows of which the table has units."""
        return self.folds if self.table.members is None else self.folds.of_rows(self.table.unit)

    @cached_property
    def rows_without_offsets(self) -> Table:
        """The rows with readings that have no offsets."""
        rows = self.table.rows
        if self.offsets is None:
            return rows
        return replace(rows, indication=rows.indication - self.offsets[self.table.unit])

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
            for noise in noises(
                self.settings.noise_models, self.at_stations, found, self.at_levels, self.has_slow_air
            )
            if self.sums.has(noise)
        )

    @cached_property
    def usual_noises(self) -> tuple[Noise, ...]:
        """Those that do not depend on the distance, whether summed or not: each kind with all its prior."""
        settings, slow = self.settings.noise_models, self.has_slow_air
        return noises(settings, self.at_stations, levels=self.at_levels, slow_air=slow)

    @property
    def has_slow_air(self) -> bool:
        """Whether the air along the path may differ from that at the thermometer, slowly."""
        return bool(self.found.slow_air)

    @cached_property
    def at_stations(self) -> bool:
        """Whether rows are at several stations, each of which may err by itself."""
        return not self.sums.flat_level and len(np.unique(self.sums.cell_group)) > 1

    @property
    def at_levels(self) -> bool:
        """Whether these are no stations, but the levels of a column."""
        return bool(self.table.grouped_by)

    @property
    def base_in_air(self) -> Base:
        """The base with the medians of the recorded air, which a model assumes where none is given."""
        return replace(self.base, air={**self.base.air, **self.table.air()})

    @property
    def at_distances(self) -> bool:
        """Whether rows are at known distances that differ: noise may grow with them."""
        reference = self.table.reference
        return reference is not None and float(np.ptp(reference)) > _SPREAD * float(reference.mean())

    def left(self, fit: HypothesisFit, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Residual of the base less what a hypothesis makes of it, at some rows [m]."""
        variants = fit.hypothesis.variants
        fixed = [v.offset for v in variants if v.offset is not None]
        free = [column for v in variants for column in v.free]
        sizes = np.concatenate([np.ones(len(fixed)), fit.mean])
        return np.asarray(self.residual[rows] - sizes @ self.found.columns.at([*fixed, *free], rows))

    def with_correlations(self, correlations: Sequence[NoiseCorrelation]) -> "Case":
        """The same, the rows summed for more noises: one more pass over them."""
        return replace(self, sums=self.sums.with_correlations(self.found.columns, correlations), stacks={})

    def stack(self, blocks: NDArray[np.bool_]) -> Stack:
        """Whitened products over some blocks, one per noise; those of a fold's few noises are kept."""
        stack = self._stack(self.noises, blocks)
        if self.probable is not None:
            key = blocks.tobytes()
            self.stacks.update(((one.noises[0], key), one) for one in stack.each())
        return stack

    def whitened(self, noise: Noise, blocks: NDArray[np.bool_]) -> Stack:
        """The same of one noise, made once."""
        key = noise, blocks.tobytes()
        if key not in self.stacks:
            self.stacks[key] = self._stack((noise,), blocks)
        return self.stacks[key]

    def _stack(self, noises: tuple[Noise, ...], blocks: NDArray[np.bool_]) -> Stack:
        degrees, kelvin = self.sums.degrees(blocks), np.array([noise.slow_air for noise in noises])
        if not kelvin.any():
            products, log_weight = self.sums.whiten_all(noises, blocks)
            return Stack(self.without_slow_air(products), log_weight, degrees, noises)
        still = [replace(noise, slow_air=0.0, prior=1.0) for noise in noises]
        each = list(dict.fromkeys(still))  # the same for each difference of the air
        places = {noise: place for place, noise in enumerate(each)}
        at = [places[noise] for noise in still]
        products, log_weight = self.sums.whiten_all(each, blocks)
        # the columns are of one kelvin; without a difference, none is taken out
        with np.errstate(divide="ignore"):
            variance = ridge(products, degrees)[1][at] / kelvin**2
        own, every = self.found.slow_air, range(products.shape[-1])
        products, more = averaged_out(products, own, every, at, variance)
        priors = np.log([noise.prior for noise in noises])
        return Stack(products, log_weight[at] + priors + more, degrees, noises)

    def without_slow_air(self, products: NDArray[np.float64]) -> NDArray[np.float64]:
        """Products in which air that differs from the thermometer explains nothing: the same, changed."""
        if self.has_slow_air:
            own = list(self.found.slow_air)
            products[..., own, :] = products[..., :, own] = 0.0
        return products

    def slow_air_in(
        self, residual: NDArray[np.float64], blocks: NDArray[np.bool_], noise: Noise
    ) -> NDArray[np.float64]:
        """Most probable part of air that differs from the thermometer in a residual of some blocks [m]."""
        if not noise.slow_air:
            return np.zeros_like(residual)
        own = list(self.found.slow_air)
        parts = self.found.columns.at(own)
        columns = Columns(self.base.plain, np.ones_like(residual), {}, None)
        for column in (self.found.columns[0], *parts, residual):
            columns.store(column)
        order, last = self.sums.order, len(own) + 1
        sums = Sums.gather(columns, order, self.folds.blocks, [noise.correlation])
        products = sums.whiten(noise, blocks).products
        variance = ridge(products, sums.degrees(blocks))[1]
        among = products[1:last, 1:last] + variance / noise.slow_air**2 * np.eye(len(own))
        return np.asarray(np.linalg.solve(among, products[1:last, last]) @ parts)
