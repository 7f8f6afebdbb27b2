"""False alarms of a watch in sixteen noises: the table `quiet` of docs/watch.md.

``python benches/watch_noises.py --docs`` draws fresh sensors that do not change, and writes
benches/watch_noises.json; without ``--docs`` it prints the table only. Six minutes on two processors.
"""

import argparse
import json
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

import echocal
from echocal.watch import WatchSettings
from echocal.watch.monitor import Monitor
from echocal.watch.signatures import Signatures

RESULTS = Path(__file__).with_name("watch_noises.json")
DAY, WAIT, MM = 86400.0, 600.0, 1e-3
LEARN, TESTED = 500, 1500
RATE = 1e-4  # stated, per row
Column = np.ndarray
Random = np.random.Generator


@dataclass
class Log:
    """Rows of a sensor that follows the linear law: in [s], [degC], [m], and the error of the reading [m]."""

    time: Column
    temperature: Column
    distance: Column
    error: Column
    recorded: Column
    step: float = 0.0

    def echo(self) -> Column:
        """Echo time [s]."""
        echo = 2.0 * (self.distance + self.error) / speed(self.temperature)
        if self.step:  # the sensor's firmware takes 343 m/s
            echo = np.round(echo * 171.5 / self.step) * self.step / 171.5
        return np.asarray(echo)

    def residual(self) -> Column:
        """Corrected less reference distance [m]."""
        return np.asarray(0.5 * self.echo() * speed(self.recorded) - self.distance)


def speed(temperature: Column) -> Column:
    """Speed of sound by the linear law [m/s]."""
    return np.asarray(331.4 + 0.6 * temperature)


def usual(random: Random, rows: int) -> Log:
    """Distances of 0.3 to 3.5 m at random, changing weather, white noise of 1 mm."""
    time = WAIT * np.arange(rows)
    slow = lfilter([0.03], [1.0, -0.999], random.standard_normal(rows))
    phase = 2.0 * np.pi * (time / DAY + random.uniform())
    temperature = 15.0 + 6.0 * np.sin(phase) + 3.0 * slow
    distance = random.uniform(0.3, 3.5, rows)
    return Log(time, temperature, distance, MM * random.standard_normal(rows), temperature)


def autoregression(random: Random, rows: int, rho: float) -> Column:
    """With a standard deviation of 1 mm."""
    white = random.standard_normal(rows + 500) * np.sqrt(1.0 - rho**2)
    return np.asarray(MM * lfilter([1.0], [1.0, -rho], white)[500:])


def states(random: Random, rows: int, stay: float) -> Column:
    """0 or 1, which changes after `stay` rows on average."""
    return np.asarray((np.cumsum(random.uniform(size=rows) < 1.0 / stay) + random.integers(2)) % 2)


def tails(random: Random, log: Log) -> None:
    log.error = MM * random.standard_t(4, len(log.time)) / np.sqrt(2.0)


def slow(rho: float) -> "Noise":
    def change(random: Random, log: Log) -> None:
        log.error = autoregression(random, len(log.time), rho)

    return change


def grows(random: Random, log: Log) -> None:
    log.error *= 0.3 + log.distance


def proportional(random: Random, log: Log) -> None:
    log.error *= 3.0 * log.distance


def doubles(random: Random, log: Log) -> None:
    log.error[np.arange(len(log.time)) >= random.integers(LEARN, len(log.time) - 500)] *= 2.0


def centimeters(places: int) -> "Noise":
    def change(random: Random, log: Log) -> None:
        log.step = 0.01
        if places:
            log.distance = random.uniform(0.3, 3.5, places)[random.integers(places, size=len(log.time))]

    return change


def outliers(random: Random, log: Log) -> None:
    wrong = random.uniform(size=len(log.time)) < 0.05
    log.error[wrong] = random.uniform(-0.3, 0.5, wrong.sum())


def missing(random: Random, log: Log) -> None:
    kept = (random.uniform(size=len(log.time)) < 0.8) & (states(random, len(log.time), 60.0) == 0)
    for name in ("time", "temperature", "distance", "error", "recorded"):
        setattr(log, name, getattr(log, name)[kept])


def sun(random: Random, log: Log) -> None:
    height = np.maximum(np.sin(2.0 * np.pi * (log.time / DAY + random.uniform())), 0.0)
    clouds = random.uniform(0.2, 1.0, int(log.time[-1] // DAY) + 1)
    log.recorded = log.temperature + 2.0 * height * clouds[(log.time // DAY).astype(int)]


def targets(random: Random, log: Log) -> None:
    which = np.cumsum(random.uniform(size=len(log.time)) < 1.0 / 150.0)
    log.distance = random.uniform(0.3, 3.5, which[-1] + 1)[which]


def wind(random: Random, log: Log) -> None:
    log.error *= np.where(
        (states(random, len(log.time), 30.0) & states(random, len(log.time), 90.0)) == 1, 4.0, 1.0
    )


def whole_degrees(random: Random, log: Log) -> None:
    log.recorded = np.round(log.temperature)


def slips(random: Random, log: Log) -> None:
    log.error += 4.3 * MM * states(random, len(log.time), 40.0)


def nothing(random: Random, log: Log) -> None:
    pass


Noise = Callable[[Random, Log], None]
NOISES: dict[str, Noise] = {
    "white": nothing,
    "white, Student's with 4 degrees of freedom": tails,
    "autocorrelation 0.6": slow(0.6),
    "autocorrelation 0.95": slow(0.95),
    "grows with the distance, 0.6 to 3.8 mm": grows,
    "grows with the distance, 0.9 to 10.5 mm": proportional,
    "doubles at some time": doubles,
    "times four for some hours (wind)": wind,
    "whole centimeters, many distances": centimeters(0),
    "whole centimeters, three distances": centimeters(3),
    "whole centimeters, one distance": centimeters(1),
    "outliers, 5 % of the rows": outliers,
    "a fifth of the rows and many hours missing": missing,
    "a target stays for a day": targets,
    "thermometer in the sun, up to 2 K": sun,
    "thermometer of whole degrees": whole_degrees,
    "the echo slips by 25 us, for 40 rows": slips,
}


def quiet(job: tuple[str, int]) -> tuple[int, int, str]:
    """Rows that are tested, false alarms, and why no rate is stated, of one sensor that does not change."""
    name, seed = job
    random = np.random.default_rng(seed)
    log = usual(random, LEARN + TESTED)
    NOISES[name](random, log)
    found = Signatures(echocal.Model("linear"), ["temperature"]).at(
        log.distance, {"temperature": log.recorded}
    )
    columns = np.column_stack([np.full(len(log.time), 0.005), found])
    monitor = Monitor(WatchSettings(learn=LEARN, false_alarms=RATE * 365.25 * DAY / WAIT), WAIT)
    rows = zip(log.time, log.residual(), columns, log.distance, log.echo(), strict=True)
    alarms = sum(monitor.add(*row) is not None for row in rows)
    return len(log.time) - LEARN, alarms, monitor.unstated


def measure(sensors: int, processes: int, seed: int) -> dict[str, Any]:
    """By noise, what `quiet` tells of every sensor."""
    seeds = np.random.SeedSequence(seed).generate_state(sensors * len(NOISES)).reshape(len(NOISES), -1)
    with ProcessPoolExecutor(processes) as pool:
        jobs = [(name, int(one)) for name, own in zip(NOISES, seeds, strict=True) for one in own]
        found = list(pool.map(quiet, jobs))
    noises = {name: found[place * sensors :][:sensors] for place, name in enumerate(NOISES)}
    return {"seed": seed, "sensors": sensors, "noises": noises}


def table(results: dict[str, Any]) -> str:
    """The figures as a table of the page."""
    text = [
        "| noise | sensors with a stated rate | stated at most | told | sensors without | told |",
        "|---|---|---|---|---|---|",
    ]
    for name, sensors in results["noises"].items():
        stated = [(rows, alarms) for rows, alarms, why in sensors if not why]
        others = [alarms for _, alarms, why in sensors if why]
        most = RATE * sum(rows for rows, _ in stated)
        told = sum(alarms for _, alarms in stated)
        text.append(f"| {name} | {len(stated)} | {most:.1f} | {told} | {len(others)} | {sum(others)} |")
    return "\n".join(text) + "\n"


def main() -> None:
    """Measure, print, and with --docs write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sensors", type=int, default=30)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--seed", type=int, default=int(np.random.SeedSequence().generate_state(1)[0]))
    parser.add_argument("--docs", action="store_true")
    given = parser.parse_args()
    results = measure(given.sensors, given.processes, given.seed)
    print(table(results))
    if given.docs:
        RESULTS.write_text(json.dumps(results) + "\n")


if __name__ == "__main__":
    main()
