"""Make the table of docs/how-to/lab-course.md, simulated: four teams, four HC-SR04, a ruler each.

Nothing here comes from echocal: speed of sound and echo are those of make_warehouse.py. Each team places a
board at eight distances, five readings each. Its ruler is off by 1 mm (standard deviation) at each placement.
Team C lays the zero of the ruler to the front of the transducers, 12 mm before the plane that the others use.
Team D types one distance wrong.

    python examples/make_class.py > class.csv
"""

import argparse

import numpy as np
from make_warehouse import echo_times, speed_of_sound

DISTANCES = np.array([0.15, 0.30, 0.50, 0.80, 1.20, 1.70, 2.30, 3.00])  # of the board [m]
READINGS = 5
RULER = 1e-3  # standard deviation of a placement [m]
FRONT = 12e-3  # what team C measures too little [m]


def main() -> None:
    """Write the table to stdout."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=20)
    chance = np.random.default_rng(parser.parse_args().seed)
    print("# simulated by make_class.py")
    print("team,stand,distance_cm,echo_us,temperature_C,humidity_percent")
    for number, team in enumerate("ABCD"):
        late = chance.normal(0.0, 6.0)  # the delay of this team's electronics against the others [us]
        for place, shown in enumerate(DISTANCES):
            true = shown + chance.normal(0.0, RULER) + (FRONT if team == "C" else 0.0)
            celsius = np.round(20.5 + 0.3 * number + 0.1 * place + chance.normal(0.0, 0.1, READINGS), 1)
            air = (celsius, np.full(READINGS, 0.45), np.full(READINGS, 101300.0))
            echo = 1e6 * echo_times(np.full(READINGS, true), speed_of_sound(*air), chance) + late
            typed = 203.0 if team == "D" and shown == 2.30 else 100 * shown
            for time, temperature in zip(echo, celsius, strict=True):
                print(f"{team},{8 * number + place + 1},{typed:.1f},{time:.0f},{temperature:.1f},45")


if __name__ == "__main__":
    main()
