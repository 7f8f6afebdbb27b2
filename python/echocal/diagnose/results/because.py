"""Why a cause is claimed: a comparison that a user can check in the data."""

from functools import reduce

import numpy as np

from echocal.diagnose.findings.sentences import Recorded, first_against_others, tendency
from echocal.diagnose.inference.case import Case
from echocal.diagnose.selection.claims import Claim
from echocal.diagnose.validation.validate import Validation
from echocal.registry import find_effect

__all__ = ["because"]


def because(case: Case, claim: Claim, validation: Validation, recorded: Recorded) -> str:
    """Compare what a cause predicts with the data."""
    signal = case.signal(claim.variant, claim.mean)
    beside = [c for c in validation.claims if c is not claim] if claim in validation.claims else []
    left = reduce(np.subtract, (case.signal(c.variant, c.mean) for c in beside), case.residual)
    if "position_in_group" in find_effect(claim.cause).reads:
        return first_against_others(left, signal, case.table.conditions["position_in_group"])
    return tendency(left, signal, recorded)
