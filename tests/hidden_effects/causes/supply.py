"""Voltage and time."""

import numpy as np

from hidden_effects.causes.registry import cause
from hidden_effects.world import World

Shape = np.random.Generator


@cause(needs="time", shows="supply")
def supply_voltage(world: World, size: float, _: Shape) -> None:
    world.later = world.later + 60e-6 * size * (5.0 - world.rows.supply)


def _elapsed(world: World) -> np.ndarray:
    seconds = world.rows.seconds
    return (seconds - seconds[0]) / np.ptp(seconds)


@cause(needs="time", repeats=False)
def drift(world: World, size: float, shape: Shape) -> None:
    """Creep of a mount: mostly straight, somewhat slower at the end."""
    world.path = world.path + 5e-3 * size * _elapsed(world) ** shape.uniform(0.85, 1.0)


@cause(needs="time", repeats=False)
def step_change(world: World, size: float, shape: Shape) -> None:
    world.path = world.path + 5e-3 * size * (_elapsed(world) > shape.uniform(0.15, 0.85))
