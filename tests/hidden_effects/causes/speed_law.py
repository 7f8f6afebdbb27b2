"""What the air does to the speed of sound, and which law the device believes."""

import numpy as np

from hidden_effects import gas
from hidden_effects.causes.registry import cause
from hidden_effects.world import World, linear

Shape = np.random.Generator


@cause()
def speed_intercept(world: World, size: float, _: Shape) -> None:
    world.faster = world.faster + 1.0 * size


@cause()
def speed_slope(world: World, size: float, _: Shape) -> None:
    world.faster = world.faster + 0.02 * size * world.air


@cause(size="fixed")
def linear_speed_law(world: World, _: float, __: Shape) -> None:
    world.real_air = True


@cause(size="fixed")
def fixed_speed(world: World, _: float, shape: Shape) -> None:
    usual = shape.choice([340.0, 343.0, 344.8, 350.9])
    world.device = usual if shape.random() < 0.5 else shape.uniform(338.0, 352.0)


@cause(size="fixed")
def double_correction(world: World, _: float, __: Shape) -> None:
    world.law_error = world.law_error * linear(world.recorded) / 343.4


@cause(size="fixed", needs="humidity")
def humidity(world: World, _: float, __: Shape) -> None:
    """At the pressure that everybody assumes: thin air is a cause of its own."""
    wet = gas.speed(world.air, world.rows.humidity)
    world.faster = world.faster + wet - gas.speed(world.air)


@cause(size="positive", most=2.0)
def unrecorded_humidity(world: World, size: float, _: Shape) -> None:
    world.hidden.add("humidity")
    world.faster = world.faster + gas.speed(world.air, min(0.5 * size, 1.0)) - gas.speed(world.air)


@cause(size="positive", most=300.0)
def gas_composition(world: World, size: float, _: Shape) -> None:
    richer = gas.speed(world.air, co2=4e-4 + 1e-3 * size)
    world.faster = world.faster + richer - gas.speed(world.air)


@cause(size="fixed", needs="weather", shows="pressure")
def pressure(world: World, _: float, __: Shape) -> None:
    """Thin air at the recorded humidity holds a larger part of vapor."""
    thin = gas.speed(world.air, world.rows.humidity, world.rows.pressure)
    world.faster = world.faster + thin - gas.speed(world.air, world.rows.humidity)


@cause(size="fixed", needs="weather", shows="pressure")
def pressure_sqrt_law(world: World, _: float, __: Shape) -> None:
    world.law_error = world.law_error * np.sqrt(world.rows.pressure / 101325.0)


@cause(size="fixed", needs="weather", shows="wind")
def wind_along(world: World, _: float, __: Shape) -> None:
    part = (world.rows.wind / world.speed()) ** 2
    world.path = world.path / (1 - part)


@cause(size="fixed", needs="weather", shows="wind")
def wind_across(world: World, _: float, __: Shape) -> None:
    part = (world.rows.wind / world.speed()) ** 2
    world.path = world.path / np.sqrt(1 - part)
