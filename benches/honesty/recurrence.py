"""Whether another window of a record can know a name that one window gives, and what it says instead."""

from collections import Counter
from typing import Any

from common import LIKELY, Record, share, told

import numpy as np  # isort: skip  (common limits the threads first)
import records
from numpy.typing import NDArray
from records import Asked
from scipy.signal import lfilter

import echocal

Column = NDArray[np.float64]

EXPECTED = 8.0
"""Expected log likelihood ratio from which on a window can know: four standard deviations."""

_SURE = 3.0
"""Standard uncertainties within which two sizes agree."""


def questions(table: Any, name: str, giver: Asked, own: Asked, before: Column) -> list[Record]:
    """Compare each name of one window with what another window can show.

    Parameters
    ----------
    table : DataFrame
        The window that is asked.
    name : str
        Its record.
    giver, own : Asked
        What the window that names, and the window that is asked, say.
    before : ndarray
        Distances by the base in the window that is asked, at the rows that its diagnosis used [m].

    Returns
    -------
    list of Record
        For each name: `expected` log likelihood ratio; `ratio`, the size there over the size of the other
        window, with its standard uncertainty; `said`, what the window says.
    """
    found = []
    for cause in told(giver.said["causes"]):
        effects = {cause["id"]: giver.model.effects[cause["id"]]}
        base = giver.base
        bound = {q: c for q, c in giver.model.columns.items() if q in echocal.Model(base.law, effects).reads}
        alone = echocal.Model(base.law, effects, air=base.air, columns=bound)
        added = before - records.corrected(table, alone, name)[own.rows]
        known = np.isfinite(added) & np.isfinite(before)
        square, ratio = _gls(added[known], before[known], own.groups[known], own.said["noise_model"])
        found.append(
            {
                "id": cause["id"],
                "expected": 0.5 * square,
                "ratio": ratio,
                "uncertainty": float(np.hypot(square**-0.5, _relative(cause) * ratio)) if square else None,
                "said": _said(cause, own.said),
            }
        )
    return found


def _gls(added: Column, before: Column, groups: NDArray[np.int64], noise: Record) -> tuple[float, float]:
    """Squared signal to noise of a column beside free levels, and the coefficient of what is there."""
    _, place = np.unique(groups, return_inverse=True)
    levels = np.eye(place.max() + 1)[place]

    def white(columns: Column) -> Column:
        rho, theta = noise["autoregression"], noise["moving_average"]
        return np.asarray(lfilter([1.0, -rho], [1.0, -theta], columns, axis=0)[1:])

    of_levels = white(levels)
    both = white(np.column_stack([added, before - before.mean()]))
    rest = both - of_levels @ np.linalg.lstsq(of_levels, both, rcond=None)[0]
    square = float(rest[:, 0] @ rest[:, 0])
    ratio = float(rest[:, 0] @ rest[:, 1]) / square if square > 0.0 else 0.0
    return square / noise["standard_deviation_m"] ** 2, ratio


def _relative(cause: Record) -> float:
    """Standard uncertainty of a size over the size; 0 where theory fixes it."""
    parts = [p["standard_uncertainty"] / abs(p["value"]) for p in cause["parameters"] if p["value"]]
    return float(max(parts, default=0.0))


def _said(cause: Record, other: Record) -> str:
    """What a window says of a cause: the first that holds."""
    own = {cause["id"], *cause["indistinguishable_from"]}
    effects = [c for c in other["causes"] if c["kind"] == "effect"]
    alike = [c for c in effects if own & {c["id"], *c["indistinguishable_from"]}]
    if any(c["id"] == cause["id"] for c in told(effects)):
        return "named"
    if told(alike):
        return "its class is named"
    if any(c["in_model"] for c in alike):
        return "in the model, not named"
    if any(c["probability"] > LIKELY for c in alike):
        return "probable, not in the model"
    if own & set(other["refuted"]):
        return "refuted"
    if any(c["in_model"] for c in effects):
        return "another cause in the model"
    return "an unexplained term" if other["unexplained"] else "improbable"


def counted(found: list[Record]) -> Record:
    """Figures of all questions, and of those that the asked window can know."""
    able = [one for one in found if one["expected"] >= EXPECTED]
    kinds: dict[str, Counter[str]] = {}
    for one in found:
        kinds.setdefault(_kind(one), Counter())[one["said"]] += 1

    def named(some: list[Record]) -> Record | None:
        return share(sum(one["said"] in {"named", "its class is named"} for one in some), len(some))

    agree = [one for one in able if _kind(one) == "agrees"]
    return {
        "can_know": named(able),
        "agrees": named(agree),
        "kinds": {kind: dict(counts.most_common()) for kind, counts in sorted(kinds.items())},
    }


def _kind(one: Record) -> str:
    """What the rows of the asked window show of the cause."""
    if one["expected"] < EXPECTED:
        return "cannot know"
    own = _SURE * one["uncertainty"]
    if abs(one["ratio"] - 1.0) <= own:
        return "agrees"
    return "absent" if abs(one["ratio"]) <= own else ("opposite" if one["ratio"] < 0.0 else "another size")
