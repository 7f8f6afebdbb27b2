"""The shape that the model leaves: fitted to what remains beside it, with its band."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from echocal.diagnose.candidates import UNKNOWN, Variant
from echocal.diagnose.case import Case
from echocal.diagnose.claims import Claim, resized, sizes, without
from echocal.diagnose.columns import Columns
from echocal.diagnose.evidence import Hypothesis, Stack, Weighed, weigh
from echocal.diagnose.gain import errors
from echocal.diagnose.noise import Noise
from echocal.diagnose.parts import Unexplained
from echocal.diagnose.sentences import spoken
from echocal.diagnose.sums import Sums
from echocal.diagnose.unexplained import Basis, column_of
from echocal.model import Model, Shape

__all__ = ["told_apart", "with_its_shape"]

_KNOTS = 65
_BLURRED = 3.0  # times as uncertain beside the shape as without it


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


def told_apart(best: Weighed, claimed: Sequence[Claim], stack: Stack) -> tuple[Weighed, list[Claim]]:
    """Size the causes without the shape beside them where the data cannot share out between the two.

    Beside a shape against the column that a cause shows in, the cause's size is nearly free: then
    the cause has all that it can explain, and the shape the rest.
    """
    bare = without(best.hypothesis, UNKNOWN)
    if bare.causes == best.hypothesis.causes or not claimed:
        return best, list(claimed)
    weighed = weigh(bare, stack)
    own = sizes(weighed)
    blurred = any((c.deviation > _BLURRED * own[c.cause][1]).any() for c in claimed)
    if not blurred:
        return best, list(claimed)
    return weighed, resized(claimed, weighed)


def _quantity(name: str) -> str:
    return "elapsed_time" if name == "time" else name
