"""Why a cause is claimed: a comparison that a user can check in the data."""

from functools import reduce

import numpy as np

from echocal.diagnose.findings.sentences import Recorded, first_against_others, tendency
from echocal.diagnose.inference.case import Case
from echocal.diagnose.selection.claims import Claim, parameters
from echocal.diagnose.validation.validate import Validation
from echocal.registry import find_effect

__all__ = ["because"]

_OUT_AND_BACK = 2e4  # us/cm times m/s: two ways of 1 cm at 1 m/s take 20,000 us


def because(case: Case, claim: Claim, validation: Validation, recorded: Recorded) -> str:
    """Compare what a cause predicts with the data."""
    signal = case.signal(claim.variant, claim.mean)
    beside = [c for c in validation.claims if c is not claim] if claim in validation.claims else []
    left = reduce(np.subtract, (case.signal(c.variant, c.mean) for c in beside), case.residual)
    if "position_in_group" in find_effect(claim.cause).reads:
        return first_against_others(left, signal, case.table.conditions["position_in_group"])
    said = tendency(left, signal, recorded)
    return f"{said}; {_divisors(case, claim)}" if claim.cause == "fixed_speed" else said


def _divisors(case: Case, claim: Claim) -> str:
    """Say what a sketch divides by that has a fixed speed, and what fits."""
    device = parameters(claim.variant, claim.mean)["speed"]
    distance = case.table.distance(case.base.plain)
    air = float(np.mean(case.base.plain.speed_of_sound(distance, **case.table.conditions)))
    used, fits = (_OUT_AND_BACK / speed for speed in (device, air))
    return (
        f"a sketch with this speed divides microseconds by {used:.3g}; {fits:.3g} fits the mean of these rows"
    )
