"""Which of many further columns an unexplained term is tried against."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.unexplained_terms import degrees_of, smooth_functions
from echocal.diagnose.inference.innovation import likeliest
from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.inference.quick_fit import QuickFit, scores
from echocal.diagnose.preprocess.order import Order

__all__ = ["MEASURE", "set_aside"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

MEASURE = (
    "how well a smooth curve against the column alone fits one of two residuals: without an offset, a scale "
    "and the temperature, or without smooth curves against all known quantities"
)
"""What they are chosen by, in words."""

_COLUMNS = 420  # that fit into 1 GB (docs/diagnose.md); of more, a shortlist of the further ones is tried
_LEAST = 8  # further columns on the shortlist
_ROWS = 20_000  # from which the further columns are chosen
_RUN = 97  # of them that follow each other: a prime, so that no period of a table is missed
_WHITE = Noise(0.0, 0.0, 0.0, 1.0)


def set_aside(
    scene: Scene,
    order: Order,
    known: Mapping[str, Column],
    further: Mapping[str, Column],
    rows: Labels,
    others: int,
) -> tuple[str, ...]:
    """List the further columns that no term is tried against; none where they are few.

    Each column is compared with two residuals, and the best columns of either stay. The first is
    without an offset, a scale and the temperature; it assumes nothing else. The second is without
    smooth curves against all known quantities, and whitened: a small effect shows there that a
    large one, or autocorrelated noise, hides in the first.

    Parameters
    ----------
    scene : Scene
    order : Order
    known : mapping of str to ndarray, shape (n,)
        What a term is tried against in any case: influence quantities, distance, rows or time.
    further : mapping of str to ndarray, shape (n,)
    rows : ndarray of int
        Rows that a fit may see.
    others : int
        Columns that there are already.

    Returns
    -------
    tuple of str
        The next best comes first.
    """
    terms = scene.settings.terms
    able = [name for name, column in further.items() if degrees_of(column, terms, further=True)]
    others += sum(degrees_of(column, terms) for column in known.values())
    most = max((_COLUMNS - others) // max(terms.degrees), _LEAST)
    if len(able) <= most:
        return ()
    rows = rows[np.arange(len(rows)) // _RUN % -(-len(rows) // _ROWS) == 0]
    order = order.at(rows)
    functions = smooth_functions(known, rows, terms)
    first = QuickFit.of(scene, rows, order, [], _WHITE)
    second = QuickFit.of(scene, rows, order, functions, _WHITE)
    noise = likeliest(second.residual, order, scene.settings.noise_models)
    second = QuickFit.of(scene, rows, order, functions, noise)
    found = np.array([scores(name, further[name][rows], (first, second), terms) for name in able])
    places = np.argsort(np.argsort(-found, axis=0, kind="stable"), axis=0).min(axis=1)
    return tuple(able[at] for at in np.argsort(places, kind="stable")[most:])
