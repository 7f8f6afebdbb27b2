"""Whether a cause of an implausible size would do something else in air that the table does not have."""

import numpy as np

from echocal.diagnose.inference.case import Case
from echocal.model import Model
from echocal.quantities import QUANTITIES

__all__ = ["differs_in_untried_air"]


def differs_in_untried_air(case: Case, model: Model) -> bool:
    """Compare what a model corrects in the air of the table with other air, where the table has one air only.

    Within a kelvin, a wrong gain of the thermometer is as good as a wrong offset, or a wrong clock. Elsewhere
    it is not, and no row of the table can tell.

    Parameters
    ----------
    case : Case
    model : Model
        The base with the causes.
    """
    table, settings = case.table, case.settings.validation
    row = [int(np.argsort(table.indication)[len(table) // 2])]
    given = {**table.conditions, **table.bound(model)}
    for name in sorted(model.reads & table.conditions.keys()):
        facts = QUANTITIES[name]
        wide = settings.untried_span * (facts.field_range[1] - facts.field_range[0])
        if not facts.judged_outside or np.ptp(table.conditions[name]) >= wide:
            continue
        here = float(np.median(table.conditions[name]))
        moved = []
        for value in (here, here - wide / 2, here + wide / 2):
            air = {n: c[row] for n, c in given.items() if n in model.reads}
            air[name] = np.clip([value], *facts.possible)
            read = table.indication[row]
            plain = case.base.model()
            before = plain.correct(read, **{n: c for n, c in air.items() if n in plain.reads})
            moved.append(float((model.correct(read, **air) - before)[0]))
        if max(moved) - min(moved) > settings.untried_share * abs(moved[0]):
            return True
    return False
