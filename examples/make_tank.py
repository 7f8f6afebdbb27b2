"""Make the tables of docs/how-to/tank.md, simulated: a water tank whose thermometer is in the sensor's box.

The sun and the electronics warm the box; the air between sensor and water stays cool. Nothing here comes from
echocal: speed of sound and echo are those of make_warehouse.py, with its delay of the rising echo.

    python examples/make_tank.py box > tank.csv          # two weeks, the thermometer in the box alone
    python examples/make_tank.py hanging > hanging.csv   # the same, and one that hangs below the lid
    python examples/make_tank.py dips > dips.csv         # twelve levels, each measured with a dipstick, too
"""

import argparse

import numpy as np
from make_warehouse import Column, echo_times, speed_of_sound

ROWS, STEP = 672, 1800.0  # fourteen days, a row every half hour
DISTANCE, SINKS = 1.200, 0.2e-3  # from the sensor to the water [m], and how much it grows in a day [m]
DIPSTICK = 1e-3  # standard deviation of a reading of the dipstick [m]
START = np.datetime64("2024-05-01T00:00:00")


def log(kind: str, chance: np.random.Generator) -> dict[str, Column]:
    """Return two weeks in which nobody draws water."""
    elapsed = STEP * np.arange(ROWS)
    day = 2 * np.pi * elapsed / 86400.0
    weather = np.cumsum(chance.normal(0.0, 0.12, ROWS))
    outside = 16.0 - 6.0 * np.cos(day - 0.6) + weather - np.linspace(0.0, weather[-1], ROWS)
    clouds = np.repeat(chance.uniform(0.2, 1.0, ROWS // 48), 48)
    sun = 8.0 * np.clip(-np.cos(day), 0.0, None) * clouds
    box = outside + 1.5 + sun + chance.normal(0.0, 0.1, ROWS)
    water = 15.0 + 0.3 * np.sin(day / 20) + chance.normal(0.0, 0.02, ROWS)
    air = 0.45 * (outside + sun) + 0.55 * water + chance.normal(0.0, 0.1, ROWS)
    level = DISTANCE + SINKS * elapsed / 86400.0 + np.cumsum(chance.normal(0.0, 0.01e-3, ROWS))
    table = {"time": START + elapsed.astype("timedelta64[s]"), "echo_us": echoes(level, air, chance)}
    table["temperature_C"] = np.round(box, 2)
    table["humidity_percent"] = np.full(ROWS, 95.0)
    if kind == "hanging":
        table["temperature_tank_C"] = np.round(air, 2)
    return table


def dips(chance: np.random.Generator) -> dict[str, Column]:
    """Return twelve levels while the tank fills, with the hanging thermometer."""
    level = np.linspace(2.0, 0.35, 12)
    air = np.round(chance.uniform(11.0, 19.0, level.size), 2)
    read = np.round(level + chance.normal(0.0, DIPSTICK, level.size), 3)
    return {
        "distance_m": read,
        "echo_us": echoes(level, air, chance),
        "temperature_C": air,
        "humidity_percent": np.full(level.size, 95.0),
    }


def echoes(distance: Column, air: Column, chance: np.random.Generator) -> Column:
    """Echo times [us] over water, in air of 95 % humidity."""
    speed = speed_of_sound(air, np.full(air.size, 0.95), np.full(air.size, 101300.0))
    return np.round(1e6 * echo_times(distance, speed, chance))


def main() -> None:
    """Write one of the tables to stdout."""
    parser = argparse.ArgumentParser()
    parser.add_argument("table", choices=["box", "hanging", "dips"])
    parser.add_argument("--seed", type=int, default=20)
    wish = parser.parse_args()
    chance = np.random.default_rng(wish.seed)
    table = dips(chance) if wish.table == "dips" else log(wish.table, chance)
    print("# simulated by make_tank.py")
    print(",".join(table))
    for row in zip(*table.values(), strict=True):
        print(",".join(f"{value}Z" if isinstance(value, np.datetime64) else f"{value:g}" for value in row))


if __name__ == "__main__":
    main()
