"""Calibration: parameters from measured data, with covariance and standard uncertainties."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal._verb import callable_as
from echocal.arrays import Column
from echocal.calibrate.problem import LOSSES, Columns, Form, Parameter, Problem, solve
from echocal.calibrate.regression import Chain, Regression
from echocal.calibrate.result import Calibration, Estimate, Prediction
from echocal.errors import DataError, UsageError
from echocal.model import Model, ResidualUncertainty
from echocal.observations import Observations
from echocal.observations.at import sentences, shifted, uncertain
from echocal.observations.given import observed
from echocal.observations.quantization_grid import find_grid

__all__ = ["Calibration", "Estimate", "Form", "Parameter", "Prediction", "Regression", "calibrate"]

callable_as(__name__)


def calibrate(
    observations: Any,
    model: Model | Form,
    fit: Sequence[str] | None = None,
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    standard_uncertainty: ArrayLike | None = None,
    loss: str = "linear",
    loss_scale: float | None = None,
    **table: Any,
) -> Calibration:
    """Estimate parameters from measured data by bounded, robust least squares.

    Parameters
    ----------
    observations : Observations, path, DataFrame, or mapping of str to array_like
        The data; a physical model needs reference distances. Everything but `Observations` is read with
        `echocal.read_observations`.
    model : Model or Form
        A physical model, or a data-driven form such as `Regression`.
    fit : sequence of str
        Parameters of the physical model to estimate: ``"fixed_delay.delay"``,
        ``"fixed_delay"`` for all of its parameters, ``"law.intercept"``, ``"law.slope"``.
        A form that is not a model always fits all of its own.
    bounds : mapping of str to tuple of float, optional
        Narrower bounds by parameter, instead of those of the registry.
    standard_uncertainty : array_like, shape () or (n,), optional
        Known standard uncertainty of the observations, in the unit of the response [m]. Without
        it the scatter is estimated from the residuals.
    loss : {"linear", "soft_l1", "huber", "cauchy"}
        Loss function. All but ``linear`` limit the influence of large residuals.
    loss_scale : float, optional
        Residual at which the loss turns robust [m, or standard uncertainties where these are
        given]; by default the scatter that the median absolute residual suggests.
    **table
        Arguments of `echocal.read_observations`: ``columns``, ``missing``, ... The default of
        ``reading_speed`` is the law of the model.

    Returns
    -------
    Calibration
        Estimates with covariance; its ``model`` is the calibrated `Model` (or `Regression`).

    Raises
    ------
    UsageError
        If a name or an option is unknown.
    ModelError
        If the rows cannot identify a parameter; the message names the parameters that they cannot separate.
    DataError
        If rows are too few or hold no number.

    References
    ----------
    .. [1] JCGM 100:2008 (GUM), section 5 and annex H.3.
    .. [2] P. J. Huber, Robust Statistics, Wiley 1981, section 7.6.

    Examples
    --------
    >>> import numpy as np
    >>> from echocal import Model, calibrate
    >>> from echocal.observations import Observations
    >>> distance = np.array([0.5, 1.0, 2.0, 3.0])
    >>> echo = Model("linear").time_of_flight(distance, temperature=20.0) + 30e-6
    >>> data = Observations(echo, {"temperature": np.full(4, 20.0)}, distance, np.full(4, ""))
    >>> found = calibrate(data, Model("linear"), fit=["fixed_delay.delay"])
    >>> round(found["fixed_delay.delay"].value * 1e6, 6)
    30.0
    """
    form = _form(model, fit)
    observations = observed(observations, calibrate, table, model.law if isinstance(model, Model) else "")
    if loss not in LOSSES:
        raise UsageError(f"unknown loss '{loss}'; known: {', '.join(LOSSES)}")
    if loss_scale is not None and not 0.0 < loss_scale < np.inf:
        raise UsageError(f"loss_scale must be finite and above 0, but is {loss_scale:g}")
    parameters = _bounded(form.parameters, bounds or {})
    used = observations.usable
    sigma = _sigma(standard_uncertainty, len(observations))
    _require_rows(int(used.sum()), len(parameters), known=sigma is not None)
    response = form.observed(observations)
    columns = {name: column[used] for name, column in form.columns(observations).items()}
    _require_numbers({"the response": response[used], **columns}, used)
    rows_sigma = None if sigma is None else sigma[used]
    solution = solve(Problem(form, response[used], columns, parameters, rows_sigma), loss, loss_scale)
    covariance = solution.covariance
    for quantity, uncertainty in uncertain(observations).items():
        low, high = (
            calibrate(
                shifted(observations, quantity, step), model, fit, bounds=bounds,
                standard_uncertainty=standard_uncertainty, loss=loss, loss_scale=loss_scale,
            ).values
            for step in (-uncertainty, uncertainty)
        )  # fmt: skip
        change = 0.5 * (high - low)  # JCGM 100:2008, 5.1.3, note 2
        covariance = covariance + np.outer(change, change)
    residuals = np.full(len(observations), np.nan)
    residuals[used] = -solution.residuals
    found = Calibration(
        form=form,
        parameters=parameters,
        values=solution.values,
        covariance=covariance,
        residuals=residuals,
        residual_standard_deviation=solution.residual_standard_deviation,
        r_squared=_r_squared(response[used], residuals[used], centered=form.has_intercept),
        rows={
            "total": len(observations),
            "used": int(used.sum()),
            "unusable": observations.unusable_counts,
        },
        loss=loss,
        model=form.fitted(solution.values, covariance),
        notes=tuple(sentences(observations.stated)),
    )
    if isinstance(found.model, Model):
        free = max(int(used.sum()) - len(parameters), 1)
        left = residuals[used] * np.sqrt(used.sum() / free)
        far, step = columns["distance"], _step(observations, columns["distance"])
        known = ResidualUncertainty.measured(left, far, 0.0, "the rows of the calibration", step)
        own = found.model.with_residual_uncertainty(known)
        return replace(found, model=own.with_provenance({"calibration": found.to_dict()}))
    return found


def _step(observations: Observations, distance: Column) -> float:
    """Step of the readings, or of the echo times as a distance [m]; 0 where they have none."""
    values = observations.echo_time if observations.reading is None else observations.reading
    grid = find_grid(values[observations.usable])
    return 0.0 if grid is None else grid.step * float(np.median(distance / values[observations.usable]))


def _form(model: Model | Form, fit: Sequence[str] | None) -> Form:
    if not isinstance(model, Model):
        if isinstance(model, str | Path):
            message = f"calibrate begins with a Model, got {model!r}; Model('cramer'), or Model.load(path)"
            raise UsageError(message)
        if fit is not None:
            raise UsageError("fit= names parameters of a physical model; this form fits all of its own")
        return model
    if fit is None or isinstance(fit, str):
        raise UsageError(f"say what to fit as a list, e.g. fit=['zero_error.offset']; got {fit!r}")
    return Chain(model, fit)


def _bounded(parameters: Sequence[Parameter], bounds: Mapping[str, tuple[float, float]]) -> list[Parameter]:
    names = [parameter.name for parameter in parameters]
    for name, (low, high) in bounds.items():
        if name not in names or not low < high:
            raise UsageError(
                f"bounds of '{name}' ({low:g}, {high:g}): want low < high, for one of {', '.join(names)}"
            )
    return [replace(p, bounds=bounds.get(p.name, p.bounds)) for p in parameters]


def _sigma(given: ArrayLike | None, rows: int) -> Column | None:
    if given is None:
        return None
    sigma: Column = np.asarray(given, dtype=np.float64)
    if sigma.shape not in ((), (rows,)) or not np.all(sigma > 0.0):
        got = f"{float(sigma):g}" if sigma.ndim == 0 else f"shape {sigma.shape}"
        raise UsageError(f"standard_uncertainty wants one positive number or {rows} of them; got {got}")
    return np.broadcast_to(sigma, (rows,))


def _require_rows(rows: int, parameters: int, *, known: bool) -> None:
    enough = parameters if known else parameters + 1
    if rows < enough:
        raise DataError(f"{parameters} parameters need at least {enough} usable rows; the data has {rows}")


def _require_numbers(columns: Columns, used: NDArray[np.bool_]) -> None:
    for name, column in columns.items():
        wrong = np.flatnonzero(~np.isfinite(column))
        if len(wrong):
            row = np.flatnonzero(used)[wrong[0]] + 1
            message = f"{name} has {len(wrong)} rows without a number, first at row {row}; mark them unusable"
            raise DataError(message)


def _r_squared(observed: Column, residuals: Column, *, centered: bool) -> float:
    total = observed - observed.mean() if centered else observed
    return float(1.0 - residuals @ residuals / (total @ total))
