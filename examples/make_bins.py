"""Make the logs of docs/how-to/fleet.md, simulated: twelve sensors above bins, and level gauges.

The speed of sound is that of make_warehouse.py, not echocal's. Five sensors have a firmware that is
45 us late. Two have a thermometer that is 2 K too warm. One was installed on the last day. In the second
month somebody bumps bin07: it reads 8 mm too long from 18 July on.

    python examples/make_bins.py june      # writes logs/sensor_id=.../2025-06.parquet
    python examples/make_bins.py july > live.csv
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from make_warehouse import speed_of_sound

SENSORS = [f"bin{number:02d}" for number in range(1, 13)]
LATE, WARM, NEW = SENSORS[:5], SENSORS[5:8:2], SENSORS[11]
ROWS = 720  # thirty days, a row every hour
BUMPED, BY = "bin07", 8e-3  # [m]


def month(sensor: str, start: str, chance: np.random.Generator) -> pd.DataFrame:
    """Return thirty days of one sensor; the gauge is good to 1 mm."""
    time = pd.date_range(start, periods=ROWS, freq="h", tz="UTC")
    day = 2 * np.pi * np.arange(ROWS) / 24
    celsius = 19.0 - 6.0 * np.cos(day - 0.6) + 3.0 * np.sin(day / 11) + chance.normal(0.0, 0.3, ROWS)
    humidity = np.clip(0.6 + 0.15 * np.cos(day - 0.6) + chance.normal(0.0, 0.03, ROWS), 0.2, 1.0)
    distance = 1.7 + 1.2 * np.sin(day / chance.uniform(3.0, 9.0) + chance.uniform(0.0, 6.0))
    echo = 2e6 * distance / speed_of_sound(celsius, humidity, np.full(ROWS, 101300.0))
    echo += chance.normal(0.0, 8.0, ROWS) + (45.0 if sensor in LATE else 0.0)
    if sensor == BUMPED:
        echo[time >= pd.Timestamp("2025-07-18", tz="UTC")] += 2e6 * BY / 344.0
    columns = {
        "time": time,
        "echo_us": np.round(echo),
        "temperature_C": np.round(celsius + (2.0 if sensor in WARM else 0.0), 2),
        "humidity_percent": np.round(100 * humidity, 1),
        "distance_m": np.round(distance + chance.normal(0.0, 1e-3, ROWS), 4),
    }
    return pd.DataFrame(columns)


def main() -> None:
    """Write one of the months."""
    parser = argparse.ArgumentParser()
    parser.add_argument("month", choices=["june", "july"])
    parser.add_argument("--seed", type=int, default=20)
    wish = parser.parse_args()
    chance = np.random.default_rng([wish.seed, wish.month == "july"])
    if wish.month == "june":
        for sensor in SENSORS:
            folder = Path(f"logs/sensor_id={sensor}")
            folder.mkdir(parents=True, exist_ok=True)
            log = month(sensor, "2025-06-01", chance)
            (log.tail(5) if sensor == NEW else log).to_parquet(folder / "2025-06.parquet", index=False)
        return
    logs = [month(sensor, "2025-07-01", chance).assign(sensor_id=sensor) for sensor in SENSORS]
    live = pd.concat(logs).sort_values(["time", "sensor_id"], kind="stable")
    print("# simulated by make_bins.py")
    print(live.to_csv(index=False, date_format="%Y-%m-%dT%H:%M:%SZ"), end="")


if __name__ == "__main__":
    main()
