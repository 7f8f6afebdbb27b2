"""Time zero and geometry."""

import numpy as np

from hidden_effects.causes.registry import cause
from hidden_effects.world import World

Shape = np.random.Generator


@cause(size="positive")
def fixed_delay(world: World, size: float, _: Shape) -> None:
    world.later = world.later + 30e-6 * size


@cause()
def zero_error(world: World, size: float, _: Shape) -> None:
    world.path = world.path + 5e-3 * size


@cause()
def reference_scale(world: World, size: float, _: Shape) -> None:
    world.reference = world.reference * (1 + 1e-3 * size)


@cause(needs="stands", repeats=False)
def reference_error(world: World, size: float, shape: Shape) -> None:
    stands = world.rows.stand.max() + 1
    world.reference = world.reference + 1.5e-3 * size * shape.normal(size=stands)[world.rows.stand]


@cause(size="positive", most=5.0)
def oblique_target(world: World, size: float, _: Shape) -> None:
    world.path = world.path * np.cos(np.radians(5.0) * size)


@cause(size="fixed", needs="weather", shows="angle")
def recorded_angle(world: World, _: float, __: Shape) -> None:
    world.path = world.path * np.cos(world.rows.angle)


@cause(size="positive", most=4.0, needs="distances")
def transducer_spacing(world: World, size: float, _: Shape) -> None:
    world.path = np.hypot(world.path, 0.013 * size)


@cause(size="positive", needs="distances")
def beam_edge(world: World, size: float, shape: Shape) -> None:
    """Beyond some distance a nearer edge inside the cone answers first."""
    edge = shape.uniform(1.0, 1.6)
    beyond = np.maximum(world.path - edge, 0.0)
    world.path = world.path - 8e-3 * size * (beyond > 0) * (1 + beyond)
