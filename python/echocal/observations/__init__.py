"""Measured data: read, checked, in SI units, every row accounted for."""

from echocal.observations.reading import read_observations
from echocal.observations.table import Observations

__all__ = ["Observations", "read_observations"]
