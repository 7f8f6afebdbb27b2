"""The model of a diagnosis under a stated condition that no cause corrects: its air has the condition."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from echocal.diagnose.preprocess.base import Presumed
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.model import Model

__all__ = ["without_presumed"]


def without_presumed(diagnosis: Diagnosis, presumed: Mapping[str, Presumed]) -> Diagnosis:
    """Put stated conditions into the air of the model, unless it has the cause that they are wrong."""
    found = {cause.id for cause in diagnosis.causes if cause.in_model}
    model = diagnosis.model
    for id_, one in presumed.items():
        if id_ not in found and id_ in model.effects:
            model = _assumed(model, id_, one)
    return diagnosis if model is diagnosis.model else replace(diagnosis, model=model)


def _assumed(model: Model, id_: str, one: Presumed) -> Model:
    """The same model of the air, its condition a value and no effect."""
    kept = [at for at, name in enumerate(model.parameter_names) if not name.startswith(f"{id_}.")]
    covariance = None if model.covariance is None or not kept else model.covariance[np.ix_(kept, kept)]
    return Model(
        model.law,
        {name: own for name, own in model.effects.items() if name != id_},
        air={**model.air, one.quantity: one.value},
        covariance=covariance,
        provenance=model.provenance,
        shape=model.shape,
        columns=model.given_columns,
        residual_uncertainty=model.residual_uncertainty,
    )
