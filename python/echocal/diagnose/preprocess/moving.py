"""A target that moves although its distance is said to be constant, or to be one number."""

import numpy as np

from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings.rows import RowSettings
from echocal.keywords import keyword
from echocal.observations.quantiles import Grouped

__all__ = ["moving_target", "without_movement"]

_CENTRAL = (0.05, 0.95)  # of the rows: a few wild ones are another matter
_RAMP = 0.5  # of the usual step: between steps of a target at rest, readings change by far less


def moving_target(table: Table, settings: RowSettings, distance: float | None = None) -> str:
    """What to say where readings change by more than air and noise can at a target at rest; empty where not.

    The readings of a segment, of which each has a level of its own, may differ by what the recorded
    temperature explains and by `step_beyond_air` besides. A movement that is cut into steps leaves in each
    segment about as much as a step.

    Parameters
    ----------
    table : Table
    settings : RowSettings
    distance : float, optional
        One distance that is stated for all rows [m].
    """
    if table.reference is not None and distance is None:
        return ""
    reading, temperature = table.rows.indication, table.rows.conditions.get("temperature")
    by_segment = Grouped(table.rows.groups)
    levels = by_segment.median(reading)
    off = reading - levels[table.rows.groups]
    air = np.zeros(len(off))
    if temperature is not None:
        warmer = temperature - by_segment.median(temperature)[table.rows.groups]
        air = settings.per_kelvin * np.abs(warmer) * reading
    beyond = np.sign(off) * np.maximum(np.abs(off) - air, 0.0)
    low, high = np.quantile(beyond, _CENTRAL)
    level, steps = float(np.median(reading)), np.abs(np.diff(levels[np.isfinite(levels)]))
    usual = float(np.median(steps)) if len(steps) else np.inf
    still = high - low <= settings.step_beyond_air * level
    if still and (high - low <= _RAMP * usual or high - low <= settings.air_anyhow * level):
        return ""
    segments = "" if np.isinf(usual) else f" within the {len(steps) + 1} segments between steps"
    stated = keyword("reference_distance", distance) if distance else keyword("constant_distance", True)
    return (
        f"the target moved: {stated} says that it did not, and 90 % of the "
        f"readings differ by up to {1e3 * (high - low):.0f} mm{segments}, at about {level:.3g} m, beyond "
        "what the recorded temperature explains"
    )


def without_movement() -> str:
    """What makes a table useful whose target moves."""
    return (
        f"record the distance (a column distance_m, or {keyword('columns', {'NAME': 'reference_level_m'})}), "
        f"or give the distances of the placements ({keyword('placements')}) or the log of a reference "
        f"({keyword('reference')})"
    )
