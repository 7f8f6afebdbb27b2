"""What a user may doubt about a claim, a sentence for each. It withholds nothing."""

from collections.abc import Iterator

import numpy as np

from echocal.diagnose.inference.case import Case
from echocal.diagnose.selection.claims import Claim
from echocal.keywords import keyword

__all__ = ["doubts_about"]

_APART = 0.05  # of the largest error, up to which it is in proportion to the distance


def doubts_about(case: Case, claim: Claim) -> Iterator[str]:
    """Other explanations that no column of the table shows.

    Parameters
    ----------
    claim : Claim
        A cause that the rows support.
    """
    table, alike = case.table, {claim.cause, *claim.rivals}
    span = np.ptp(table.conditions.get("elapsed_time", np.zeros(1)))
    if table.reference is None:
        return
    if "temperature_offset" in alike and 0.0 < span <= max(case.settings.noise_models.slow_air_times):
        yield (
            f"all rows are of one session of {span / 60:.0f} min. Air that is warmer or colder than the "
            f"thermometer for as long looks like {claim.cause}. To see what lasts, measure in another session"
        )
    if not table.stated_speed.replace(".", "", 1).isdigit():
        return
    signal = case.signal(claim.variant, claim.mean)
    part = float(signal @ table.reference / (table.reference @ table.reference))
    scales = np.abs(signal - part * table.reference).max() < _APART * np.abs(signal).max()
    if scales:
        speed = float(table.stated_speed) * (1.0 + part)
        yield (
            f"readings of a device that converts with {speed:.1f} m/s, and not with the stated "
            f"{table.stated_speed} m/s, have the same error as {claim.cause}. Read the speed in the firmware "
            f"or the manual, and give it with {keyword('reading_speed')}"
        )
