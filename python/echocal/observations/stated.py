"""What the uncertainty of a stated condition does: the same rows with the condition a little higher or lower."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from echocal.model import Model
from echocal.observations.echoes import DEFAULT_SPEED
from echocal.observations.table import Observations

__all__ = ["shifted", "uncertain"]


def uncertain(observations: Observations) -> dict[str, float]:
    """Standard uncertainty [SI] of the conditions that are stated with one."""
    return {name: u for name, (_, u) in observations.stated.items() if u > 0.0}


def shifted(observations: Observations, quantity: str, step: float) -> Observations:
    """The observations if a stated condition were higher by a step [SI].

    Readings that a firmware made with this condition become other echo times.
    """
    value, _ = observations.stated[quantity]
    conditions = {**observations.conditions, quantity: observations.conditions[quantity] + step}
    changed = replace(
        observations,
        conditions=conditions,
        stated={**observations.stated, quantity: (value + step, 0.0)},
        notes=(),
    )
    reading = observations.reading
    if reading is None or "echo_time" in observations.source_names:
        return changed
    firmware = Model(observations.reading_speed or DEFAULT_SPEED)
    given: Mapping[str, np.ndarray | float] = {n: v for n, v in conditions.items() if n in firmware.reads}
    return replace(changed, echo_time=firmware.time_of_flight(reading, **(given or {"temperature": 0.0})))
