"""Whether a scale error may be that of the stated reading speed: the device may convert with another one."""

from echocal.diagnose.inference.case import Case
from echocal.diagnose.validation.proportion import proportion
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
        factor, part = proportion(case.signal(claim.variant, claim.mean), to=table.reference)
        if part < settings.proportional or len(claim.mean) != 1:
            continue
        found = stated * (1.0 + factor)
        width = stated * abs(factor) * float(claim.deviation[0] / abs(claim.mean[0]))
        usual = min(_usual_speeds(), key=lambda speed: abs(speed - found))
        if usual != stated and abs(usual - found) <= max(settings.alike_speeds * width, _ROUNDED):
            said[claim.cause] = (
                f"readings of a device that converts with {usual:g} m/s, and not with the stated "
                f"{stated:g} m/s, have the same error: {found:.2f} +/- {width:.2g} m/s by these rows. So "
                f"{claim.cause} is not named. Read the speed in the firmware or the manual, or try "
                f"--reading-speed {usual:g}"
            )
    return said


def _usual_speeds() -> tuple[float, ...]:
    """Speeds that devices convert with [m/s]."""
    (speed,) = (p for p in find_effect("fixed_speed").parameters if p.name == "speed")
    return (_AT_FREEZING, *speed.known)
