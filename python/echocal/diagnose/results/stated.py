"""A diagnosis under a stated condition: how far its results depend on the value that nobody recorded."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from echocal.diagnose.findings.parts import Cause
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.at import shifted, uncertain
from echocal.observations.correction import corrected_distance

__all__ = ["with_stated"]


def with_stated(
    diagnosis: Diagnosis,
    observations: Observations,
    competing: Mapping[str, str],
    again: Callable[[Observations], Diagnosis],
) -> Diagnosis:
    """Add the uncertainty of stated conditions to the parameters, and say whether the causes depend on it.

    The table is diagnosed once more with each condition one standard uncertainty lower and higher. The
    parameters take the change of the corrected distances (JCGM 100:2008, 5.1.3, note 2). `competing` are the
    causes, by quantity, that a stated condition is wrong: the causes were compared under each value of such a
    condition, and where the model has this cause, the uncertainties of its parameters have it already.
    """
    for quantity, uncertainty in uncertain(observations).items():
        if quantity in competing:
            if competing[quantity] not in diagnosis.model.effects:
                diagnosis = _wider(diagnosis, _change(diagnosis.model, observations, quantity, uncertainty))
            continue
        low, high = (again(shifted(observations, quantity, step)) for step in (-uncertainty, uncertainty))
        change = _change(diagnosis.model, observations, quantity, uncertainty)
        note = _note(quantity, diagnosis, low, high)
        diagnosis = replace(_wider(diagnosis, change), notes=(note, *diagnosis.notes))
    return diagnosis


def _wider(diagnosis: Diagnosis, change: Mapping[str, float]) -> Diagnosis:
    """The diagnosis with a further uncertainty of its parameters."""
    causes = tuple(_widened(cause, change) for cause in diagnosis.causes)
    return replace(diagnosis, causes=causes, model=_model(diagnosis.model, change))


def _note(quantity: str, diagnosis: Diagnosis, low: Diagnosis, high: Diagnosis) -> str:
    what = quantity.replace("_", " ")
    if _claims(low) == _claims(diagnosis) == _claims(high):
        return (
            f"the verdict is the same with the {what} one standard uncertainty lower or higher than stated; "
            "the standard uncertainties of the parameters include this"
        )
    return (
        f"the verdict depends on the stated {what}: one standard uncertainty lower it is {_said(low)}, "
        f"higher it is {_said(high)}"
    )


def _claims(diagnosis: Diagnosis) -> tuple[str, frozenset[str]]:
    return diagnosis.verdict, frozenset(cause.id for cause in diagnosis.causes)


def _said(diagnosis: Diagnosis) -> str:
    named = ", ".join(cause.id for cause in diagnosis.causes)
    return f"'{diagnosis.verdict}'{f' ({named})' if named else ''}"


def _change(model: Model, observations: Observations, quantity: str, uncertainty: float) -> dict[str, float]:
    """Change of each parameter, by ``effect.parameter``, that a higher condition makes up for.

    Least squares over the rows: the tangents of the parameters take the change of the corrected distances.
    """
    bare = model.without_shape()
    if not bare.parameter_names or bare.columns:
        return {}
    with warnings.catch_warnings(action="ignore"):
        near, far = (
            corrected_distance(shifted(observations, quantity, step), bare)
            for step in (-uncertainty, uncertainty)
        )
        distance = corrected_distance(observations, bare)
        rows = np.isfinite(near) & np.isfinite(far) & np.isfinite(distance)
        given = {name: values[rows] for name, values in observations.conditions.items() if name in bare.reads}
        jacobian = bare.jacobian(distance[rows], **given)
    if not rows.any():
        return {}
    tangents = jacobian[:, 1:]
    if observations.reference_distance is None:  # the level is free
        tangents = np.column_stack([tangents, jacobian[:, 0]])
    scale = np.abs(tangents).max(axis=0)
    scale[scale == 0.0] = 1.0
    moved = jacobian[:, 0] * 0.5 * (far - near)[rows]
    found = np.linalg.lstsq(tangents / scale, moved, rcond=None)[0] / scale
    return dict(zip(bare.parameter_names, found.tolist(), strict=False))


def _widened(cause: Cause, change: Mapping[str, float]) -> Cause:
    parameters = [
        replace(
            p,
            standard_uncertainty=float(
                np.hypot(p.standard_uncertainty, change.get(f"{cause.id}.{p.name}", 0.0))
            ),
        )
        for p in cause.parameters
    ]
    return replace(cause, parameters=tuple(parameters))


def _model(model: Model, change: Mapping[str, float]) -> Model:
    """The model with a wider covariance."""
    if model.covariance is None or not change:
        return model
    steps = np.array([change[name] for name in model.parameter_names])
    return model.with_covariance(model.covariance + np.outer(steps, steps))
