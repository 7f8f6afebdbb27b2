"""Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction."""

from echocal import _interrupt as _interrupt  # isort: skip  # first: Ctrl-C may come during the rest
from echocal import firmware
from echocal._core import __version__, absorption, distance, error, speed_of_sound, time_of_flight
from echocal.calibrate import Calibration, Regression, calibrate
from echocal.diagnose import Diagnosis, diagnose, diagnose_many, gross_faults, noises, row_faults
from echocal.domain import DEPARTURES, DOMAIN_VIOLATIONS, departures, domain_violations
from echocal.errors import (
    BoundError,
    DataError,
    DataWarning,
    DisagreementWarning,
    DomainWarning,
    EchocalError,
    ModelError,
    UsageError,
)
from echocal.model import Model
from echocal.observations import Observations, read_observations
from echocal.registry import effects
from echocal.sweep import sweep
from echocal.verify import Verification, verify, verify_model

__all__ = [
    "DEPARTURES",
    "DOMAIN_VIOLATIONS",
    "BoundError",
    "Calibration",
    "DataError",
    "DataWarning",
    "Diagnosis",
    "DisagreementWarning",
    "DomainWarning",
    "EchocalError",
    "Model",
    "ModelError",
    "Observations",
    "Regression",
    "UsageError",
    "Verification",
    "__version__",
    "absorption",
    "calibrate",
    "departures",
    "diagnose",
    "diagnose_many",
    "distance",
    "domain_violations",
    "effects",
    "error",
    "firmware",
    "gross_faults",
    "noises",
    "read_observations",
    "row_faults",
    "speed_of_sound",
    "sweep",
    "time_of_flight",
    "verify",
    "verify_model",
]
