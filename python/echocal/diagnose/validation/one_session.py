"""Whether a model may be that of one short session: of air that differed from the thermometer."""

import numpy as np

from echocal.diagnose.inference.case import Case
from echocal.diagnose.validation.proportion import proportion
from echocal.model import Model
from echocal.registry import find_effect

__all__ = ["ONE_SESSION", "of_one_session"]

ONE_SESSION = "all rows are of one session"

_OFFSET = "temperature_offset"


def of_one_session(case: Case, model: Model, without: Model | None = None) -> str:
    """Compare what a model corrects with air that differs from the thermometer for a whole session.

    Folds of one session share its air, so they cannot refute such a model: docs/method.md, section 7, "One
    session".

    Parameters
    ----------
    case : Case
    model : Model
        The base with its causes, or a model with a smooth correction.
    without : Model, optional
        The same without them; default: the base.

    Returns
    -------
    str
        What both do; empty if the model corrects more, or something else, than such air does, and where
        the table is longer, its times or distances are not recorded, or its clock stands still.
    """
    time, table, settings = case.table.conditions.get("elapsed_time"), case.table, case.settings
    if time is None or table.reference is None or not case.base.allows(find_effect(_OFFSET)):
        return ""
    if not 0.0 < np.ptp(time) <= max(settings.noise_models.slow_air_times):
        return ""
    kelvin = max(settings.noise_models.slow_airs)
    warmer = case.base.model({_OFFSET: {"offset": kelvin}})
    plain = case.base.model()
    base, one, before, after = (table.correct(m) for m in (plain, warmer, without or plain, model))
    known = np.isfinite(one - base) & np.isfinite(after - before)
    air, moved = (one - base)[known], (after - before)[known]
    factor, part = proportion(moved, to=air)
    if part < settings.validation.session_alike or abs(factor) > settings.validation.session_air:
        return ""
    rms = [1e3 * float(np.sqrt(np.mean(each**2))) for each in (moved, air)]
    return (
        f"{ONE_SESSION} of {np.ptp(time) / 60:.0f} min, and the correction is {rms[0]:.2f} mm (RMS). Air "
        f"that is {kelvin:g} K warmer or colder than the thermometer for as long does {rms[1]:.2f} mm. To "
        "see what lasts, measure in another session"
    )
