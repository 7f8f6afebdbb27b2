"""The timer's frequency."""

import numpy as np

from hidden_effects.causes.registry import cause
from hidden_effects.world import World

Shape = np.random.Generator


@cause()
def clock_error(world: World, size: float, _: Shape) -> None:
    world.clock = world.clock * (1 + 3e-3 * size)


@cause()
def clock_temperature_coefficient(world: World, size: float, _: Shape) -> None:
    world.clock = world.clock * (1 + 20e-6 * size * (world.air - 25.0))


@cause(size="positive", most=10.0)
def interrupt_loss(world: World, size: float, _: Shape) -> None:
    world.clock = world.clock * (1 - 5.8e-3 * size)
