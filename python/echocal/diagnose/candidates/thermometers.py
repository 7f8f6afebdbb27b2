"""Forms of a cause that reads a further thermometer: one for each thermometer of the table."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from echocal.diagnose.candidates.scene import Scene
from echocal.diagnose.candidates.variant import Candidates, Variant
from echocal.quantities import FROM_THERMOMETERS
from echocal.registry import Effect

__all__ = ["bound_forms", "no_thermometer", "read_from_thermometers"]

_MOST = 8  # thermometers that are tried: each takes two columns of the sums


def read_from_thermometers(effect: Effect) -> str:
    """Quantity that an effect reads from a further thermometer; empty where it reads none."""
    return next((name for name in effect.requires if name in FROM_THERMOMETERS), "")


def no_thermometer(scene: Scene) -> str:
    """Why no further thermometer of a table can be read; empty where one can."""
    if not scene.table.thermometers:
        return "not recorded: a further thermometer"
    if _complete(scene):
        return ""
    return "not recorded in every row: a further thermometer"


def bound_forms(
    found: Candidates,
    effect: Effect,
    quantity: str,
    scene: Scene,
    forms: Callable[[Candidates, Effect, Scene], list[Variant]],
) -> list[Variant]:
    """Forms of an effect for each thermometer that has a value in every row.

    The columns of a diagnosis know one value of each quantity, so those of each thermometer are computed
    apart and added by their values.

    Parameters
    ----------
    found : Candidates
        Extended in place.
    quantity : str
        What it reads from a further thermometer.
    forms : callable
        Makes the forms for a table that has the quantity.
    """
    variants = []
    chosen = _chosen(scene)
    for name, column in scene.table.thermometers.items():
        if rows := int(np.isnan(column).sum()):
            found.unread[name] = f"no value in {rows} of {len(column)} rows"
        elif name not in chosen:
            found.unread[name] = "it differs less as the residual does than others"
    for name in chosen:
        own = scene.bound(quantity, name)
        apart = Candidates(own.columns())
        for variant in forms(apart, effect, own):
            free = tuple(found.columns.store(column) for column in apart.columns.at(variant.free))
            variants.append(replace(variant, free=free, bound=((quantity, name),)))
    return variants


def _chosen(scene: Scene) -> list[str]:
    """Thermometers that are tried: all, or those whose difference from the first correlates best."""
    able = _complete(scene)
    if len(able) <= _MOST:
        return able
    left = scene.leftover - scene.leftover.mean()

    def alike(name: str) -> float:
        apart = scene.table.thermometers[name] - scene.conditions["temperature"]
        apart = apart - apart.mean()
        size = float(apart @ apart)
        return float(left @ apart) ** 2 / size if size > 0.0 else 0.0

    return sorted(able, key=alike, reverse=True)[:_MOST]


def _complete(scene: Scene) -> list[str]:
    """Thermometers that have a value in every row."""
    return [name for name, column in scene.table.thermometers.items() if np.isfinite(column).all()]
