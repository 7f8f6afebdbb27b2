"""The shape that the model leaves: fitted to what remains beside it, with its band."""

from dataclasses import replace

import numpy as np

from echocal.diagnose.evidence.case import Case
from echocal.diagnose.evidence.noise import Noise
from echocal.diagnose.evidence.sums import Sums
from echocal.diagnose.evidence.weigh import Hypothesis, Stack, weigh
from echocal.diagnose.judging.gain import errors
from echocal.diagnose.signals.candidates import UNKNOWN, Variant
from echocal.diagnose.signals.columns import Columns
from echocal.diagnose.signals.unexplained import Basis, column_of
from echocal.diagnose.terms.parts import Unexplained
from echocal.diagnose.terms.sentences import spoken
from echocal.model import Model, Shape

__all__ = ["with_its_shape"]

_KNOTS = 65


def with_its_shape(case: Case, found: Unexplained, model: Model, noise: Noise) -> Unexplained:
    """Fit the shape to what the model leaves of the rows that a fit may see.

    Only the part that no cause of the model takes up is the shape's: where a cause and a shape
    could both be it, the cause has it.
    """
    table, fit = case.table, case.folds.fit
    left = np.nan_to_num(errors(table, model, fit[case.folds.blocks]))
    against = column_of(found.against, table.against())
    basis = Basis.of(found.against, against)
    waves = basis.at(against)
    columns = Columns(case.base.plain, left, table.conditions, None)
    for column in (np.ones_like(left), *waves, left):
        columns.store(column)
    gathered = Sums.gather(columns, case.sums.order, case.folds.blocks, [noise.remembers])
    free = tuple(range(1, len(waves) + 1))
    variant = Variant(UNKNOWN, free=free, bounds=((-np.inf, np.inf),) * len(free), against=found.against)
    stack = Stack.of([gathered.whiten(noise, fit)], gathered.degrees(fit))
    weighed = weigh(Hypothesis((variant,), 1.0), stack)
    at = np.linspace(basis.low, basis.high, _KNOTS)
    design = np.stack(basis.at(at), axis=1)
    shift = design @ weighed.mean
    rows = fit[case.folds.blocks]  # of an unknown level the mean is the level's, else it is what is left
    shift += float(np.mean(left[rows] - np.interp(against[rows], at, shift)))
    variance = np.einsum("ki,ij,kj->k", design, weighed.covariance, design)
    shape = Shape(
        _quantity(found.against),
        tuple(at.tolist()),
        tuple(shift.tolist()),
        tuple(np.sqrt(np.maximum(variance, 0.0)).tolist()),
    )
    rms = float(np.std(shape.of(against)))
    return replace(found, shape=shape, rms_m=rms, description=described(found.against, rms))


def described(against: str, rms: float) -> str:
    """Say what is left, in words."""
    column = "the rows, as sessions that differ would," if against == "row" else spoken(against)
    return (
        f"a smooth remainder of {1e3 * rms:.1f} mm (rms) that follows {column} and that no "
        "effect of the catalogue accounts for; it is not part of the model unless asked for"
    )


def _quantity(name: str) -> str:
    return "elapsed_time" if name == "time" else name
