"""What the thermometer says beside the truth."""

import numpy as np

from hidden_effects import thermometer
from hidden_effects.causes.registry import cause
from hidden_effects.world import World

Shape = np.random.Generator


@cause()
def temperature_offset(world: World, size: float, _: Shape) -> None:
    world.recorded = world.recorded - 1.0 * size


@cause(most=20.0)
def temperature_gain(world: World, size: float, _: Shape) -> None:
    world.recorded = world.recorded / (1 + 0.03 * size)


@cause(size="positive", needs="time")
def temperature_lag(world: World, size: float, _: Shape) -> None:
    world.recorded = thermometer.lagging(world.recorded, world.rows.seconds, 150.0 * max(size, 1e-6))


@cause(size="fixed", needs="time")
def temperature_timestamp_shift(world: World, _: float, shape: Shape) -> None:
    late = int(shape.integers(1, 6))
    world.recorded = np.concatenate([np.full(late, world.recorded[0]), world.recorded[:-late]])


@cause(size="positive", needs="time")
def temperature_self_heating(world: World, size: float, shape: Shape) -> None:
    rise = thermometer.warming(world.rows.seconds, 1.0 * size, shape.uniform(120.0, 1800.0))
    world.recorded = world.recorded + rise


@cause(size="positive", needs="days", shows="radiation")
def temperature_radiation(world: World, size: float, shape: Shape) -> None:
    warm = thermometer.in_the_sun(
        world.rows.radiation, world.rows.seconds, 3.0 * size, shape.uniform(60, 1200)
    )
    world.recorded = world.recorded + warm


@cause()
def temperature_gradient(world: World, size: float, _: Shape) -> None:
    """The thermometer hangs at the sensor; the air on the way is warmer by distance."""
    world.air = world.air + 0.4 * size * world.path
