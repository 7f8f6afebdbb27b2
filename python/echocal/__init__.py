"""Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction."""

from echocal.domain import DEPARTURES, departures
from echocal.errors import BoundError, DataError, DomainWarning, EchocalError, ModelError, UsageError
from echocal.model import Model

__all__ = [
    "DEPARTURES",
    "BoundError",
    "DataError",
    "DomainWarning",
    "EchocalError",
    "Model",
    "ModelError",
    "UsageError",
    "departures",
]
