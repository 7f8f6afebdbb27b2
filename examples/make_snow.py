"""Make the log of docs/how-to/snow.md, simulated: a sonic ranger on a mast looks down on grass, then on snow.

Nothing here comes from echocal: the speed of sound is that of make_warehouse.py. The sun warms the shield of
the thermometer, which also follows the air late. Grass grows in September. A weaker echo has a larger quality
number, and is timed early. Snow falls from 20 November on. The logger writes the distance as if sound had
331.4 m/s at every temperature.

    python examples/make_snow.py log > snow.dat      # TOA5, a row every half hour from September to December
    python examples/make_snow.py stake > stake.csv   # six visits: the distance from the mast to the surface
"""

import argparse

import numpy as np
from make_warehouse import Column, speed_of_sound

START = np.datetime64("2024-09-01T00:00:00")
DAYS, A_DAY = 106, 48
MAST = 2.480  # from the sensor to the soil [m]
WARM = 2.5 / 800.0  # warming of the shield by the sun [K m2/W]
LATE = 480.0  # time constant of the thermometer [s]
QUALITY = -0.05e-3  # of the reading by a unit of the quality number [m]
STAKE = 3e-3  # standard deviation of a reading of the stake [m]
VISITS = np.array([12, 40, 68, 82, 92, 103])  # days
HEADER = """"TOA5","meadow","CR1000","simulated","CR1000.Std.32","make_snow.py","0","Table30"
"TIMESTAMP","RECORD","DT","AirTC_Avg","RH","SlrW_Avg","Q"
"TS","RN","m","Deg C","%","W/m^2",""
"","","Smp","Avg","Smp","Avg","Smp"
"""


def wander(chance: np.random.Generator, rows: int, size: float, memory: float) -> Column:
    """Return noise that remembers the row before, of a standard deviation `size`."""
    noise = chance.normal(0.0, size * np.sqrt(1.0 - memory**2), rows)
    for row in range(1, rows):
        noise[row] += memory * noise[row - 1]
    return noise


def surface(days: Column) -> Column:
    """Return the distance from the sensor to grass or snow [m]."""
    grass = 0.030 * (1.0 - np.exp(-days / 8.0))
    snow = np.zeros_like(days)
    for day, fresh in ((80.3, 0.12), (86.7, 0.20), (97.2, 0.15)):
        since = np.clip(days - day, 0.0, None)
        snow += fresh * np.clip(since / 0.4, 0.0, 1.0) * (0.55 + 0.45 * np.exp(-since / 6.0))
    return MAST - np.where(snow > 0.0, 0.0, grass) - snow


def log(chance: np.random.Generator) -> None:
    """Write the log to stdout."""
    rows = DAYS * A_DAY
    days = np.arange(rows) / A_DAY
    season = 12.0 - 14.0 * days / DAYS
    weather = wander(chance, rows, 3.0, 0.995)
    hour = 2 * np.pi * days
    sky = np.repeat(np.clip(chance.beta(1.2, 1.0, DAYS), 0.1, 1.0), A_DAY)
    sun = np.clip(-np.cos(hour) - 0.2 - 0.4 * days / DAYS, 0.0, None) * (800.0 - 4.0 * days) * sky
    air = season + weather - 4.0 * sky * np.cos(hour - 0.7) + wander(chance, rows, 0.4, 0.6)
    shown = air + WARM * sun - LATE * np.gradient(air) / 1800.0 + chance.normal(0.0, 0.05, rows)
    humidity = np.clip(0.78 + 0.14 * np.cos(hour - 0.6) * sky + wander(chance, rows, 0.06, 0.98), 0.25, 1.0)
    quality = np.where(days < 80.3, 190.0 + 0.25 * np.clip(days, 0, 40), 225.0) + wander(
        chance, rows, 14.0, 0.6
    )
    true = surface(days) + QUALITY * (quality - 190.0)
    speed = speed_of_sound(air, humidity, np.full(rows, 97500.0))
    reading = true * 331.4 / speed + wander(chance, rows, 0.8e-3, 0.7)
    print(HEADER, end="")
    for row in range(rows):
        time = str(START + np.timedelta64(1800 * row, "s")).replace("T", " ")
        print(
            f'"{time}",{row},{reading[row]:.4f},{shown[row]:.2f},{100 * humidity[row]:.1f},{sun[row]:.0f},'
            f"{quality[row]:.0f}"
        )


def stake(chance: np.random.Generator) -> None:
    """Write the visits to stdout."""
    print("# simulated by make_snow.py\ntime,distance_m")
    read = surface(VISITS + 0.5) + chance.normal(0.0, STAKE, VISITS.size)
    for day, distance in zip(VISITS, read, strict=True):
        print(f"{START + np.timedelta64(24 * int(day) + 12, 'h')},{distance:.3f}")


def main() -> None:
    """Write the log or the visits."""
    parser = argparse.ArgumentParser()
    parser.add_argument("table", choices=["log", "stake"])
    parser.add_argument("--seed", type=int, default=20)
    wish = parser.parse_args()
    (log if wish.table == "log" else stake)(np.random.default_rng(wish.seed))


if __name__ == "__main__":
    main()
