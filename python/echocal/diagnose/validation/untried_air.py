"""Whether a cause of an implausible size would do something else in air that the table does not have."""

import numpy as np
from numpy.typing import NDArray

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
    table, settings, plain = case.table, case.settings.validation, case.base.plain
    row = [int(np.argsort(table.indication)[len(table) // 2])]
    read = table.indication[row]
    given = {name: column[row] for name, column in {**table.conditions, **table.bound(model)}.items()}

    def moved(air: dict[str, NDArray[np.float64]]) -> float:
        one, other = (
            m.correct(read, **{n: c for n, c in air.items() if n in m.reads}) for m in (model, plain)
        )
        return float((one - other)[0])

    for name in sorted(model.reads & table.conditions.keys()):
        facts, column = QUANTITIES[name], table.conditions[name]
        wide = settings.untried_span * (facts.field_range[1] - facts.field_range[0])
        if not facts.judged_outside or np.ptp(column) >= wide:
            continue
        around = np.median(column) + wide * np.array([0.0, -0.5, 0.5])
        here, *others = (moved({**given, name: np.clip([air], *facts.possible)}) for air in around)
        if max(here, *others) - min(here, *others) > settings.untried_share * abs(here):
            return True
    return False
