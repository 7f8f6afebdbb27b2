"""Whether a told gain is true: the model corrects another campaign of the same sensor and the same causes."""

import numpy as np

import echocal
from echocal.errors import EchocalError
from hidden_effects.bench.truth import PARAMETERS
from hidden_effects.bench.world import Case, Column, error

Record = dict[str, object]

_STRAY = 0.1  # m, beyond which a reading is of another echo: no model of the mean corrects it


def told(answer: dict[str, object]) -> list[float] | None:
    """Root mean squares [m] of the base and the model, as the diagnosis tells them of held-out rows."""
    gain = answer["gain"]
    assert isinstance(gain, dict | None)
    return None if gain is None else [float(gain["rms_before_m"]), float(gain["rms_after_m"])]


def fresh(case: Case, model: echocal.Model) -> list[float] | None:
    """The same of a campaign that the engine never saw; None where the model cannot be applied there."""
    before = error(case.again)
    try:
        after = error(case.again, model)
    except EchocalError:
        return None
    seen = np.isfinite(before) & np.isfinite(after) & (np.abs(before) < _STRAY)
    if not seen.any():
        return None
    return [_rms(column[seen], level="distance_m" not in case.again.table) for column in (before, after)]


def _rms(values: Column, *, level: bool) -> float:
    """Root mean square, about the mean where the level is not known."""
    return float(np.sqrt(np.mean((values - values.mean() if level else values) ** 2)))


def scores(case: Case, causes: list[dict[str, object]]) -> dict[str, float]:
    """z-scores of the sizes of planted causes that the diagnosis names by their own name."""
    found: dict[str, float] = {}
    for id_, size in case.spec.sizes.items():
        if id_ not in PARAMETERS:
            continue
        name, parameter, value = PARAMETERS[id_]
        for cause in causes:
            if cause["id"] != name:
                continue
            for one in cause["parameters"]:  # type: ignore[attr-defined]
                if one["name"] == parameter and one["standard_uncertainty"]:
                    away = one["value"] - value(case.made, size)
                    found[id_] = float(away / one["standard_uncertainty"])
    return found
