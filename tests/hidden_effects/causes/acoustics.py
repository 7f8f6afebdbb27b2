"""The echo's strength, and what it does to the moment of detection."""

import numpy as np

from hidden_effects import echo
from hidden_effects.causes.registry import cause
from hidden_effects.world import World

Shape = np.random.Generator


@cause(size="positive")
def amplitude_walk(world: World, size: float, shape: Shape) -> None:
    """A rise of some cycles, a threshold at a small part of a near echo."""
    threshold = shape.uniform(0.005, 0.02)
    humid = world.rows.humidity
    late = echo.walk(world.path, world.air, humid, threshold, 200e-6 * size)
    world.later = world.later + late


@cause(size="positive")
def resonance_drift(world: World, size: float, shape: Shape) -> None:
    world.later = world.later + echo.detuned(world.air, shape.uniform(-12, -5), 15.0, 60e-6 * size)
