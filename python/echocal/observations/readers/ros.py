"""Topics that ``rostopic echo -p`` prints: fields of messages, whose units the message definitions fix."""

from dataclasses import replace

import pandas as pd

from echocal.observations.found import Found

__all__ = ["step"]

_UNITS = {"range": "m", "temperature": "degC", "fluid_pressure": "Pa", "illuminance": "lux"}
"""sensor_msgs/Range, Temperature, FluidPressure, Illuminance (ROS 1 and 2, common_interfaces)."""


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Units of the fields of sensor messages."""
    names = [str(name) for name in table.columns]
    if "%time" not in names and not any(name.startswith(("field.header", "header.stamp")) for name in names):
        return table, found
    units = {name: _UNITS[last] for name in names if (last := name.rpartition(".")[2]) in _UNITS}
    return table, replace(found, units={**units, **found.units})
