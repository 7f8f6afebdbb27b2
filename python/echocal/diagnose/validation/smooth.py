"""The smooth correction: chosen and fitted in each fold, and judged by rows that neither has seen."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.splines import Spline, splines
from echocal.diagnose.findings.parts import SmoothCorrection
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.smoothing import Smoother, values_of
from echocal.diagnose.validation.gain import REACHABLE, errors, intervals, on_common_rows
from echocal.diagnose.validation.judges import Judge
from echocal.diagnose.validation.residual_uncertainty import residual_uncertainty
from echocal.diagnose.validation.validate import Validation
from echocal.model import Model, Shape, Smooth
from echocal.observations.quantiles import quantiles, spread

__all__ = ["smooth_correction"]

Mask = NDArray[np.bool_]
Choice = Callable[[Mask], Smooth | None]

_KNOTS = 65


def smooth_correction(
    case: Case, judgment: Validation, judge: Judge, noise: Noise
) -> SmoothCorrection | None:
    """Fit a smooth correction to what the model leaves, and measure its gain.

    Parameters
    ----------
    case : Case
    judgment : Validation
        The model.
    judge : Judge
        Rows that neither the choice nor the fit of the correction sees.
    noise : Noise
        With which rows are weighted.

    Returns
    -------
    SmoothCorrection or None
        None if the columns leave nothing to reach, or if no column is fit for it.
    """
    gain = judgment.gain
    reachable = gain.rms_after_m**2 - gain.rms_floor_m**2
    if not reachable > REACHABLE * gain.rms_after_m**2:
        return None
    able = splines(case.table, case.found.terms, case.settings.terms)
    if not able:
        return None
    models = judge.models(judgment.fitted, kept=bool(judgment.kept))
    choice = _choice(case, able, judgment, judge, models, noise)
    whole = choice(case.folds.fit)
    found = SmoothCorrection(
        tried=tuple(spline.against for spline in able), smooth=whole, scheme=judge.scheme
    )
    if whole is None:
        return found
    folds: list[tuple[str, ...]] = []

    def extended(blocks: Mask) -> Model:
        own = choice(blocks)
        folds.append(() if own is None else own.columns)
        return models(blocks).with_shape(own)

    before, after = on_common_rows(judge.extended(models), judge.extended(extended))
    unit = case.table.unit if judge.held is None else judge.held.unit
    gained, removed = intervals(before, after, unit, noise.rho, case.seed)
    given = {spline.against: values_of(case.table, spline.against) for spline in able}
    judging = case.table if judge.held is None else judge.held
    residual = residual_uncertainty(judging.rows, judgment.model, after, judge.scheme)
    return replace(
        found,
        smooth=replace(whole, residual_uncertainty=residual),
        rms_before_m=before.rms,
        rms_after_m=after.rms,
        held_out_rows=int(before.known.sum()),
        interval_95=gained,
        variance_removed=1.0 - (after.rms / before.rms) ** 2 if before.rms > 0.0 else 0.0,
        variance_removed_interval_95=removed,
        chosen_by_folds=tuple(folds),
        rows_outside=int(whole.outside(given).sum()),
    )


def _choice(
    case: Case,
    able: tuple[Spline, ...],
    judgment: Validation,
    judge: Judge,
    models: Callable[[Mask], Model],
    noise: Noise,
) -> Choice:
    """The correction that some blocks choose and fit."""
    folds = case.folds
    seen = [folds.fit, *(folds.fit & ~held for held in folds.held if judge.held is None)]
    seen = seen if judgment.kept else seen[:1]  # the base is one model
    residuals = []
    for blocks in seen:
        left = np.nan_to_num(errors(case.table, models(blocks), blocks[folds.blocks]))
        residuals.append(left - case.slow_air_in(left, blocks, noise))
    smoother = Smoother.of(case, able, residuals, noise)
    places = {blocks.tobytes(): place for place, blocks in enumerate(seen)}
    first = smoother.places[-1].stop

    def choice(blocks: Mask) -> Smooth | None:
        residual = first + places.get(blocks.tobytes(), 0)
        weights = smoother.chosen(blocks, folds.within(blocks).held, residual)
        if not weights:
            return None
        found = smoother.fitted(blocks, weights, residual)
        rows = blocks[folds.blocks]
        terms = []
        for place, mean, covariance in found.splines:
            at = _knots(case, smoother.splines[place], rows)
            if not (np.diff(at) > 0.0).all():  # the column does not vary in these rows
                return None
            shift, band = smoother.curve(place, at, mean, covariance)
            against = smoother.splines[place].against
            terms.append(Shape(against, *(tuple(values.tolist()) for values in (at, shift, band))))
        return Smooth(found.offset, tuple(terms))

    return choice


def _knots(case: Case, spline: Spline, rows: Mask) -> NDArray[np.float64]:
    """Values of the column between which the correction holds, in some rows."""
    if spline.periodic:
        return np.linspace(spline.low, spline.high, _KNOTS)
    column = spread(values_of(case.table, spline.against)[rows])
    low, high = quantiles(column, case.settings.terms.range)
    return np.linspace(low, high, _KNOTS)
