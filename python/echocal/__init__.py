"""Name what an ultrasonic distance sensor gets wrong, measure the gain, ship the correction."""

from echocal import _interrupt as _interrupt  # isort: skip  # first: Ctrl-C may come during the rest
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from echocal._accessors import register
from echocal._core import __version__, absorption, distance, error, speed_of_sound, time_of_flight

if TYPE_CHECKING:
    from echocal import firmware
    from echocal.budget import Budget, budget
    from echocal.calibrate import Calibration, Regression, calibrate
    from echocal.correct import Corrected, correct, correct_files
    from echocal.diagnose import Diagnosis, diagnose, diagnose_many, gross_faults, row_faults
    from echocal.diagnose.noises import noises
    from echocal.domain import DOMAIN_VIOLATIONS, domain_violations
    from echocal.emulation import Emulation, emulate, error_parts
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
    from echocal.estimator import EchoCorrector
    from echocal.fleet import diagnose_fleet
    from echocal.model import Model
    from echocal.observations import Observations, read_observations
    from echocal.registry import effects
    from echocal.sweep import sweep
    from echocal.verify import Verification, verify, verify_model
    from echocal.watch import watch
    from echocal.waveforms import EchoTimes, echo_times, read_waveforms

__all__ = [
    "DOMAIN_VIOLATIONS",
    "BoundError",
    "Budget",
    "Calibration",
    "Corrected",
    "DataError",
    "DataWarning",
    "Diagnosis",
    "DisagreementWarning",
    "DomainWarning",
    "EchoTimes",
    "EchocalError",
    "Emulation",
    "Model",
    "ModelError",
    "Observations",
    "Regression",
    "UsageError",
    "Verification",
    "__version__",
    "absorption",
    "budget",
    "calibrate",
    "correct",
    "correct_files",
    "diagnose",
    "diagnose_fleet",
    "diagnose_many",
    "distance",
    "domain_violations",
    "echo_times",
    "effects",
    "emulate",
    "error",
    "error_parts",
    "firmware",
    "gross_faults",
    "noises",
    "read_observations",
    "read_waveforms",
    "row_faults",
    "speed_of_sound",
    "sweep",
    "time_of_flight",
    "verify",
    "verify_model",
    "watch",
]
if find_spec("sklearn") is not None:  # else nothing that lists the names could import it
    __all__ += ["EchoCorrector"]

_HOMES = {
    "budget": ("Budget",),
    "calibrate": ("Calibration", "Regression"),
    "correct": ("Corrected", "correct_files"),
    "diagnose": ("Diagnosis", "diagnose_many", "gross_faults", "noises", "row_faults"),
    "domain": ("DOMAIN_VIOLATIONS", "domain_violations"),
    "emulation": ("Emulation", "emulate", "error_parts"),
    "errors": (
        "BoundError",
        "DataError",
        "DataWarning",
        "DisagreementWarning",
        "DomainWarning",
        "EchocalError",
        "ModelError",
        "UsageError",
    ),
    "estimator": ("EchoCorrector",),
    "fleet": ("diagnose_fleet",),
    "model": ("Model",),
    "observations": ("Observations", "read_observations"),
    "registry": ("effects",),
    "verify": ("Verification", "verify_model"),
    "waveforms": ("EchoTimes", "echo_times", "read_waveforms"),
}
"""Module of each name that is imported when it is asked for: pandas and SciPy take a second."""

_MODULES = {"budget", "calibrate", "correct", "diagnose", "firmware", "sweep", "verify", "watch"}
"""Modules that are public; all but ``firmware`` are called, see `echocal._verb`."""

_HOME = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import what takes long to import when it is asked for."""
    if name in _MODULES:
        return import_module(f"echocal.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'echocal' has no attribute '{name}'")
    found = getattr(import_module(f"echocal.{_HOME[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """The public names alone, also of what is not imported yet."""
    return sorted(__all__)


register()
