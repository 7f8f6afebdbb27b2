"""Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction."""

from echocal import _interrupt as _interrupt  # isort: skip  # first: Ctrl-C may come during the rest
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from echocal.correct import correct_files

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
    "correct_files",
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


def __getattr__(name: str) -> Any:
    """Import what takes long to import when it is asked for."""
    if name == "correct_files":
        from echocal.correct import correct_files

        return correct_files
    message = f"module 'echocal' has no attribute '{name}'"
    raise AttributeError(message)
