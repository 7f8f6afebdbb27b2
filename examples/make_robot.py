"""Make the logs of docs/how-to/robot.md, simulated: a robot drives before a wall, twenty echoes a second.

Nothing here comes from echocal: speed of sound and echo are those of make_warehouse.py. The reference is the
distance by the encoders of the wheels. In the first log the program polls the echo pin in a loop that does
other work, too, and reads the encoders 25 ms late. In the second it captures the edges and interpolates the
encoders to the middle of the flight of the sound.

    python examples/make_robot.py polled > polled.csv
    python examples/make_robot.py captured > captured.csv
"""

import argparse

import numpy as np
from make_warehouse import echo_times, speed_of_sound

ROWS, STEP = 1200, 0.05  # one minute
JITTER = 60e-6  # mean of the time until the loop looks at the pin again [s]
LATE = 25e-3  # from the middle of the flight to the reading of the encoders [s]
ENCODER = 0.5e-3  # standard deviation of the reference [m]


def main() -> None:
    """Write one of the logs to stdout."""
    parser = argparse.ArgumentParser()
    parser.add_argument("log", choices=["polled", "captured"])
    parser.add_argument("--seed", type=int, default=20)
    wish = parser.parse_args()
    chance = np.random.default_rng(wish.seed)
    elapsed = STEP * np.arange(ROWS)
    turns = 2 * np.pi * elapsed
    distance = 1.35 + 0.9 * np.sin(turns / 17.0) + 0.2 * np.sin(turns / 5.3 + 1.0)
    velocity = np.gradient(distance, elapsed)
    celsius = (
        19.0 + 6.0 * elapsed / elapsed[-1] + chance.normal(0.0, 0.05, ROWS)
    )  # from the hall into the sun
    air = (celsius, np.full(ROWS, 0.5), np.full(ROWS, 101300.0))
    echo = 1e6 * echo_times(distance, speed_of_sound(*air), chance)
    reference = distance + chance.normal(0.0, ENCODER, ROWS)
    if wish.log == "polled":
        echo = 4 * np.floor((echo + 1e6 * chance.exponential(JITTER, ROWS)) / 4)
        reference += velocity * LATE
    print("# simulated by make_robot.py")
    print("time_s,distance_m,echo_us,temperature_C,humidity_percent,velocity_m_s")
    for row in range(ROWS):
        print(
            f"{elapsed[row]:.2f},{reference[row]:.4f},{echo[row]:.0f},{celsius[row]:.2f},50,{velocity[row]:.3f}"
        )


if __name__ == "__main__":
    main()
