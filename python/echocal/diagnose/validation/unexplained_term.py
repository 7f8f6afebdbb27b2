"""The unexplained term: fitted to the residuals of the model, with its uncertainty, and validated."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.unexplained_terms import HOUR, Basis, column_of, degrees_of
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.findings.parts import OF_THIS_TABLE, Unexplained
from echocal.diagnose.findings.sentences import spoken
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, fit_hypothesis
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.validation.gain import errors, on_common_rows
from echocal.diagnose.validation.judges import Judge
from echocal.diagnose.validation.validate import Validation
from echocal.model import Model, Shape
from echocal.quantities import BY_COLUMN

__all__ = ["with_its_function"]

_KNOTS = 65


def with_its_function(
    case: Case, found: Unexplained, judgment: Validation, judge: Judge, noise: Noise
) -> Unexplained:
    """Fit the unexplained term to the residuals of the model.

    The term gets only what no cause of the model explains: where a cause and the term could both
    explain a part, the cause has it. Where later readings have the column, the error on
    cross-validated or held-out rows decides whether the term may extend the model.
    """
    shape = _shape(case, found.against, judgment.model, case.folds.fit, noise)
    if shape is None:
        return found
    rms = float(np.std(shape.of(column_of(found.against, case.table.against()))))
    found = replace(found, shape=shape, rms_m=rms)
    if found.against not in OF_THIS_TABLE:

        def extended(blocks: NDArray[np.bool_]) -> Model:
            model = judgment.fitted(blocks)
            return model.with_shape(_shape(case, found.against, model, blocks, noise))

        errors_of = (judge.extended(model) for model in (judgment.fitted, extended))
        without, with_it = on_common_rows(*errors_of)
        found = replace(found, rms_without_m=without.rms, rms_with_m=with_it.rms)
    return replace(found, description=described(found, judgment.gain.judged_rows))


def _shape(case: Case, name: str, model: Model, blocks: NDArray[np.bool_], noise: Noise) -> Shape | None:
    """Fit a smooth function to the residuals of a model in some blocks; None if the column is constant."""
    table, rows = case.table, blocks[case.folds.blocks]
    left = np.nan_to_num(errors(table, model, rows))
    against = column_of(name, table.against())
    basis = Basis.of(name, against[rows], case.settings.terms)  # constant outside the range of these rows
    if not basis.low < basis.high:
        return None
    most = degrees_of(against, case.settings.terms, further=name in table.extra)
    waves = basis.at(against) if name == HOUR else basis.at(against)[: max(most, 1)]
    columns = Columns(case.base.plain, left, table.conditions, None)
    for column in (np.ones_like(left), *waves, left):
        columns.store(column)
    gathered = Sums.gather(columns, case.sums.order, case.folds.blocks, [noise.correlation])
    free = tuple(range(1, len(waves) + 1))
    variant = Variant(UNKNOWN, free=free, bounds=((-np.inf, np.inf),) * len(free), against=name)
    stack = Stack.of([gathered.whiten(noise, blocks)], gathered.degrees(blocks))
    fit = fit_hypothesis(Hypothesis((variant,), 1.0), stack)
    at = np.linspace(basis.low, basis.high, _KNOTS)
    design = np.stack(basis.at(at)[: len(waves)], axis=1)
    shift = design @ fit.mean
    # the mean: of what remains, or zero, where the level is unknown and has it
    shift += float(np.mean(left[rows] - np.interp(against[rows], at, shift)))
    variance = np.einsum("ki,ij,kj->k", design, fit.covariance, design)
    return Shape(
        _quantity(name),
        tuple(at.tolist()),
        tuple(shift.tolist()),
        tuple(np.sqrt(np.maximum(variance, 0.0)).tolist()),
    )


def described(found: Unexplained, rows: str) -> str:
    """Describe the term; `rows` says which rows its errors are of."""
    column = "the row number (sessions that differ look like this)"
    text = (
        f"a residual of {1e3 * found.rms_m:.1f} mm (RMS) remains, as a smooth function of "
        f"{column if found.against == 'row' else spoken(found.against)}. "
        "No effect of the catalogue explains it"
    )
    if found.rms_with_m is None or found.rms_without_m is None:
        return f"{text}. The model cannot include it, because later readings have no such column"
    figures = f"{1e3 * found.rms_without_m:.2f} mm without it and {1e3 * found.rms_with_m:.2f} mm with it"
    if found.extends:
        return f"{text}. The model can include it on request: on {rows}, the RMS error is {figures}"
    return f"{text}. The model cannot include it: on {rows}, the RMS error is {figures}"


def _quantity(name: str) -> str:
    return BY_COLUMN[name].id if name in BY_COLUMN else name
