"""Names that mean the same to any judge: exact aliases, and classes by geometry."""

from functools import cache

import numpy as np

from hidden_effects.cases import Case, by_snr, planted
from hidden_effects.causes import CAUSES

EXACT = (
    frozenset({"speed_intercept", "temperature_offset"}),
    frozenset({"speed_slope", "temperature_gain"}),
    frozenset({"clock_error", "reference_scale", "oblique_target", "interrupt_loss"}),
    frozenset({"wind_along", "wind_across"}),
)
"""Causes whose columns are the same at first order with the linear law, whatever is measured."""

SAME_DIRECTION = 0.99
"""Cosine between two columns from which on a design cannot be asked to tell them apart."""

EITHER_SIGN = frozenset({"fixed_delay"})
"""Planted with one sign, but of either sign in the field: firmware may subtract too long a delay."""


@cache
def label(id_: str) -> str:
    """One name for each exact class."""
    return min(next((group for group in EXACT if id_ in group), {id_}))


def labels(ids: object) -> tuple[str, ...]:
    """Names of a set of causes, exact aliases merged."""
    return tuple(sorted({label(str(id_)) for id_ in ids}))  # type: ignore[attr-defined]


def same_class(case: Case, truth: str, named: str) -> bool:
    """Whether the rows of a case see both causes in one direction, at the size that is there."""
    if label(truth) == label(named):
        return True
    if truth not in CAUSES or named not in CAUSES:
        return False
    if CAUSES[truth].kind != "mean" or CAUSES[named].kind != "mean":
        return False
    if not CAUSES[named].needs <= case.rows.offers:
        return False
    seed = case.spec.seed
    column = planted(case.rows, {truth: case.sizes[truth]}, seed).shift()
    strength = float(np.sqrt(np.mean(column**2)))
    fixed = CAUSES[named].size == "fixed"
    size = 1.0 if fixed else by_snr(case.rows, named, strength / 1.5e-3, seed)
    other = planted(case.rows, {named: size}, seed).shift()
    scale = float(np.sqrt(np.mean(other**2)))
    if strength == 0.0 or scale == 0.0:
        return False
    cosine = float(np.mean(column * other) / (strength * scale))
    if fixed:  # no size can make up for another strength
        return cosine >= SAME_DIRECTION and 0.8 < scale / strength < 1.25
    one_sign = CAUSES[named].size == "positive" and named not in EITHER_SIGN
    return (cosine if one_sign else abs(cosine)) >= SAME_DIRECTION
