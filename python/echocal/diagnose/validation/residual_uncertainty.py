"""What the model leaves unexplained of rows that its sizes are not fitted to.

docs/method/checks.md, Eq. 31a.
"""

import warnings

import numpy as np

from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.validation.gain import HeldOut
from echocal.model import Model, ResidualUncertainty
from echocal.observations.quantization_grid import FINEST_STEP

__all__ = ["residual_uncertainty"]

_ENOUGH = 50_000  # rows: the standard deviation of so many is known to 0.3 %


def residual_uncertainty(
    table: Table, model: Model, held: HeldOut, scheme: str
) -> ResidualUncertainty | None:
    """Measure the residual uncertainty of a model on rows of a table; None where they do not show any.

    Errors below the finest step of a device are those of arithmetic: of rows that were computed, or of a
    reading that never changes, whose step nothing tells.

    Parameters
    ----------
    table : Table
    model : Model
        With the covariance of its parameters, whose part of the errors is not counted twice.
    held : HeldOut
        Errors of these rows with the causes of the model.
    scheme : str
        How the rows were chosen.
    """
    known = np.flatnonzero(held.known)
    rows = known[:: -(-len(known) // _ENOUGH) or 1]
    with warnings.catch_warnings(action="ignore"):  # of domains, told elsewhere
        distance = table.correct(model, rows)
        given = {**table.conditions, **table.bound(model)}
        conditions = {name: column[rows] for name, column in given.items() if name in model.reads}
        bare = model.with_residual_uncertainty(None)
        own = np.nan_to_num(bare.standard_uncertainty(distance, **conditions)) ** 2
    found = ResidualUncertainty.measured(held.error[rows], distance, own, scheme, 12**0.5 * table.rounding)
    return None if found is None or found.of(found.high) < FINEST_STEP / 12**0.5 else found
