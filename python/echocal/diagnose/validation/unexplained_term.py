"""The shape that the model leaves: fitted to what remains beside it, with its band, and judged."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.unexplained_terms import Basis, column_of
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.findings.parts import OF_THIS_TABLE, Unexplained
from echocal.diagnose.findings.sentences import spoken
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.validation.gain import errors, measure
from echocal.diagnose.validation.refute import Validation
from echocal.model import Model, Shape
from echocal.quantities import BY_COLUMN

__all__ = ["with_its_function"]

_KNOTS = 65


def with_its_function(case: Case, found: Unexplained, judgment: Validation, noise: Noise) -> Unexplained:
    """Fit the shape to what the model leaves of the rows that a fit may see.

    Only the part that no cause of the model takes up is the shape's: where a cause and a shape
    could both be it, the cause has it. Where later readings have its column, so that it can extend
    the model, rows never fitted say whether it should.
    """
    shape = _shape(case, found.against, judgment.model, case.folds.fit, noise)
    rms = float(np.std(shape.of(column_of(found.against, case.table.against()))))
    found = replace(found, shape=shape, rms_m=rms)
    if found.against not in OF_THIS_TABLE:

        def extended(blocks: NDArray[np.bool_]) -> Model:
            model = judgment.fitted(blocks)
            return model.with_shape(_shape(case, found.against, model, blocks, noise))

        after = measure(case.table, case.folds, extended).rms
        found = replace(found, rms_without_m=judgment.gain.rms_after_m, rms_with_m=after)
    return replace(found, description=described(found))


def _shape(case: Case, name: str, model: Model, blocks: NDArray[np.bool_], noise: Noise) -> Shape:
    """Fit a shape to what a model leaves in the rows of some blocks."""
    table, rows = case.table, blocks[case.folds.blocks]
    left = np.nan_to_num(errors(table, model, rows))
    against = column_of(name, table.against())
    basis = Basis.of(name, against[rows], case.settings.terms)  # held flat outside what these rows saw
    waves = basis.at(against)
    columns = Columns(case.base.plain, left, table.conditions, None)
    for column in (np.ones_like(left), *waves, left):
        columns.store(column)
    gathered = Sums.gather(columns, case.sums.order, case.folds.blocks, [noise.correlation])
    free = tuple(range(1, len(waves) + 1))
    variant = Variant(UNKNOWN, free=free, bounds=((-np.inf, np.inf),) * len(free), against=name)
    stack = Stack.of([gathered.whiten(noise, blocks)], gathered.degrees(blocks))
    fit = fit_hypothesis(Hypothesis((variant,), 1.0), stack)
    at = np.linspace(basis.low, basis.high, _KNOTS)
    design = np.stack(basis.at(at), axis=1)
    shift = design @ fit.mean
    # of an unknown level the mean is the level's, else it is what is left
    shift += float(np.mean(left[rows] - np.interp(against[rows], at, shift)))
    variance = np.einsum("ki,ij,kj->k", design, fit.covariance, design)
    return Shape(
        _quantity(name),
        tuple(at.tolist()),
        tuple(shift.tolist()),
        tuple(np.sqrt(np.maximum(variance, 0.0)).tolist()),
    )


def described(found: Unexplained) -> str:
    """Say what is left, in words."""
    column = "the rows, as sessions that differ would," if found.against == "row" else spoken(found.against)
    text = (
        f"a smooth remainder of {1e3 * found.rms_m:.1f} mm (rms) that follows {column} and that no "
        "effect of the catalogue accounts for; it is not part of the model unless asked for"
    )
    if found.rms_with_m is None or found.rms_without_m is None:
        return text
    figures = f"{1e3 * found.rms_without_m:.2f} mm without it, {1e3 * found.rms_with_m:.2f} mm with it"
    if found.extends:
        return f"{text} (on rows never fitted: {figures})"
    bare = text.partition(" unless")[0]
    return f"{bare} and cannot be, for it makes rows never fitted no better ({figures})"


def _quantity(name: str) -> str:
    return BY_COLUMN[name].id if name in BY_COLUMN else name
