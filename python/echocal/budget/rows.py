"""Some rows of observations."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.observations import Observations

__all__ = ["some"]


def some(observations: Observations, places: NDArray[np.int64]) -> Observations:
    """The observations of some rows."""

    def of(columns: Mapping[str, Any]) -> dict[str, Any]:
        return {name: values[places] for name, values in columns.items()}

    def optional(values: Any) -> Any:
        return None if values is None else values[places]

    return replace(
        observations,
        echo_time=observations.echo_time[places],
        conditions=of(observations.conditions),
        reference_distance=optional(observations.reference_distance),
        unusable=observations.unusable[places],
        reading=optional(observations.reading),
        time=optional(observations.time),
        labels=of(observations.labels),
        extra=of(observations.extra),
        thermometers=of(observations.thermometers),
    )
