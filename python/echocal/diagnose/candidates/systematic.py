"""Errors of the speed and of the moment of arrival, which all rows of a table share."""

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.variant import Candidates

__all__ = ["systematic_columns"]


def systematic_columns(found: Candidates, scene: Scene) -> tuple[tuple[int, float], ...]:
    """Columns of these errors, each with its factor for one standard uncertainty.

    An error of the speed is that of a clock. An error of the moment of arrival is a delay.

    Returns
    -------
    tuple of (int, float)
        Those of the causes, where they compete: no further column is made.
    """
    settings = scene.settings.priors
    sizes = {
        ("clock_error", "frequency_error"): settings.scale_uncertainty,
        ("fixed_delay", "delay"): settings.arrival_uncertainty,
    }
    own = {v.cause: (v.free[0], v.scales[0]) for v in found.variants if v.cause in {id_ for id_, _ in sizes}}
    made = []
    for (id_, name), size in sizes.items():
        if id_ not in own:
            own[id_] = found.columns.tangent(id_, {name: 0.0}, name, size), size
        column, scale = own[id_]
        made.append((column, size / scale))
    return tuple(made)
