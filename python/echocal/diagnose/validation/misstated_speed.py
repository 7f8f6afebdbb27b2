"""Whether a scale error may be that of the stated reading speed: the device may convert with another one."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.case import Case
from echocal.diagnose.selection.claims import Claim
from echocal.diagnose.validation.validate import Validation
from echocal.registry import find_effect

__all__ = ["misstated_speed"]

_AT_FREEZING = 331.4
"""Speed of rangers that leave the temperature to the logger [m/s]: Campbell Scientific, SR50A manual."""

_ROUNDED = 0.05
"""Half the last digit of such speeds [m/s]."""


def misstated_speed(case: Case, validation: Validation) -> dict[str, str]:
    """Compare a claimed error in proportion to the distance with the speeds that devices convert with.

    Echo times from a reading and a wrong speed are too long, or too short, by one factor. No column shows
    where this factor comes from.

    Parameters
    ----------
    case : Case
    validation : Validation

    Returns
    -------
    dict of str to str
        A sentence on each cause in the model that such a speed would explain as well.
    """
    table, settings = case.table, case.settings.validation
    try:
        stated = float(table.stated_speed)
    except ValueError:  # none, or one that depends on the air
        return {}
    if table.reference is None:
        return {}
    said = {}
    for claim in validation.kept:
        scale = _scale(case, claim, table.reference, settings.proportional)
        if scale is None:
            continue
        factor, uncertainty = scale
        found, width = stated * (1.0 + factor), stated * uncertainty
        usual = min(_usual_speeds(), key=lambda speed: abs(speed - found))
        if usual != stated and abs(usual - found) <= max(settings.alike_speeds * width, _ROUNDED):
            said[claim.cause] = (
                f"readings of a device that converts with {usual:g} m/s, and not with the stated "
                f"{stated:g} m/s, have the same error: {found:.2f} +/- {width:.2g} m/s by these rows. So "
                f"{claim.cause} is not named. Read the speed in the firmware or the manual, or try "
                f"--reading-speed {usual:g}"
            )
    return said


def _scale(
    case: Case, claim: Claim, distance: NDArray[np.float64], proportional: float
) -> tuple[float, float] | None:
    """Error of a claim over the distance, and its standard uncertainty; None if there is no proportion."""
    signal = case.signal(claim.variant, claim.mean)
    square, total = float(distance @ distance), float(signal @ signal)
    factor = float(distance @ signal) / square
    left = signal - factor * distance
    if total == 0.0 or float(left @ left) > proportional**2 * total or len(claim.mean) != 1:
        return None
    return factor, abs(factor) * float(claim.deviation[0] / abs(claim.mean[0]))


def _usual_speeds() -> tuple[float, ...]:
    """Speeds that devices convert with [m/s]."""
    (speed,) = (p for p in find_effect("fixed_speed").parameters if p.name == "speed")
    return (_AT_FREEZING, *speed.known)
