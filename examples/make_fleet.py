"""Write fleet/: two weeks of six tank sensors, each week in one file.

Drawn with echocal's own laws, so that a diagnosis of it proves nothing: it shows how a fleet is used. Three
sensors have a delay of 40 us, one has a thermometer that is 2 K too warm, two have nothing but noise.
"""

from pathlib import Path

import numpy as np

import echocal

HERE = Path(__file__).parent
SENSORS = {
    "north": ("delay",),
    "south": ("delay",),
    "east": ("delay",),
    "west": ("thermometer",),
    "inner": (),
    "outer": (),
}
ROWS = 84  # a week, every two hours
HEADER = "# simulated by make_fleet.py\nsensor_id,time,echo_us,temperature_C,humidity_percent,distance_m\n"


def week(random: np.random.Generator, number: int) -> list[str]:
    """The lines of one file, in the order of time."""
    lines = []
    start = np.datetime64("2025-05-05T00:00") + np.timedelta64(7 * number, "D")
    for row in range(ROWS):
        time = start + np.timedelta64(2 * row, "h")
        for sensor, causes in SENSORS.items():
            celsius = 14 + 7 * np.sin(2 * np.pi * (row / 12 - 0.3)) + random.normal(0, 0.4)
            humidity = 70 - 15 * np.sin(2 * np.pi * (row / 12 - 0.3)) + random.normal(0, 2)
            distance = round(random.uniform(0.5, 3.5), 3)
            echo = 2e6 * distance / echocal.speed_of_sound(celsius, humidity / 100) + random.normal(0, 6)
            echo += 40 if "delay" in causes else 0
            shown = celsius + (2 if "thermometer" in causes else 0)
            lines.append(f"{sensor},{time},{echo:.0f},{shown:.2f},{humidity:.1f},{distance:.3f}\n")
    return lines


def main() -> None:
    """Write both files."""
    random = np.random.default_rng(8)
    folder = HERE / "fleet"
    folder.mkdir(exist_ok=True)
    for number in range(2):
        (folder / f"week{number + 1}.csv").write_text(HEADER + "".join(week(random, number)))


if __name__ == "__main__":
    main()
