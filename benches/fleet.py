"""Time the diagnosis of a fleet from its files, and compare its names with what was drawn.

python benches/fleet.py                              # 1,000 sensors of 1,000 rows
python benches/fleet.py --sensors 100 --rows 3000    # a sample

Every run draws new sensors. A third has nothing wrong with it. Half of the sizes are usual ones, half lie
between a third and three times of them. The logs lie in four files by time, with a key.
"""

import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import numpy as np
import typer

import echocal
from echocal.engines.processes import processors
from echocal.fleet import diagnose_fleet

SHARES = {
    (): 0.34,
    ("fixed_delay",): 0.2,
    ("temperature_offset",): 0.14,
    ("drift",): 0.12,
    ("cycle_slip",): 0.08,
    ("temperature_lag",): 0.06,
    ("fixed_delay", "drift"): 0.06,
}
"""Part of the sensors that have each set of causes."""

START = np.datetime64("2025-03-01T00:00", "ms")
STEP = 600.0  # s from row to row


def sensor(random: np.random.Generator, rows: int, causes: tuple[str, ...]) -> dict[str, Any]:
    """The log of one sensor."""
    time = np.arange(rows) * STEP
    phase = random.uniform(0.0, 2 * np.pi)
    mean, swing = random.uniform(5.0, 20.0), random.uniform(4.0, 9.0)
    weather = np.convolve(random.normal(0.0, 1.0, rows + 200), np.ones(201) / 201**0.5, "valid")

    def air(at: Any) -> Any:
        return mean + swing * np.sin(2 * np.pi * at / 86400 + phase) + weather

    celsius = air(time)
    humidity = np.clip(0.6 - 0.02 * (celsius - mean) + random.normal(0.0, 0.03, rows), 0.05, 1.0)
    distance = random.uniform(0.4, 3.9, rows)
    scale = 1.0 if random.random() < 0.5 else 3.0 ** random.uniform(-1.0, 1.0)
    path = distance + (scale * 8e-3 * time / time[-1] if "drift" in causes else 0.0)
    echo = 2 * path / echocal.speed_of_sound(celsius, humidity) + random.normal(0.0, 6e-6, rows)
    echo += scale * 30e-6 if "fixed_delay" in causes else 0.0
    echo += 25e-6 * (random.random(rows) < 0.1) if "cycle_slip" in causes else 0.0
    shown = celsius + (scale * 1.5 if "temperature_offset" in causes else 0.0)
    if "temperature_lag" in causes:
        shown = late(shown, scale * 1200.0)
    return {
        "time": START + (1000 * time).astype("timedelta64[ms]"),
        "echo_us": 1e6 * echo,
        "temperature_C": shown,
        "humidity_percent": 100 * humidity,
        "distance_m": distance,
    }


def late(celsius: Any, constant: float) -> Any:
    """What a thermometer with a time constant [s] shows, if the temperature is linear between rows."""
    shown = np.array(celsius)
    kept = np.exp(-STEP / constant)
    for row in range(1, len(shown)):
        behind = constant * (celsius[row] - celsius[row - 1]) / STEP
        shown[row] = celsius[row] - behind + kept * (shown[row - 1] - celsius[row - 1] + behind)
    return shown


def write(folder: Path, sensors: int, rows: int, random: np.random.Generator) -> dict[str, tuple[str, ...]]:
    """Write a fleet into four files by time; return what each sensor has."""
    import polars as pl

    sets = list(SHARES)
    drawn = random.choice(len(sets), sensors, p=list(SHARES.values()))
    planted = {str(key): sets[place] for key, place in enumerate(drawn.tolist())}
    logs = [
        pl.DataFrame({"sensor_id": np.full(rows, int(key)), **sensor(random, rows, causes)})
        for key, causes in planted.items()
    ]
    whole = pl.concat(logs).sort("time", "sensor_id")
    for part in range(4):
        ends = (len(whole) * part // 4, len(whole) * (part + 1) // 4)
        whole[ends[0] : ends[1]].write_parquet(folder / f"{part}.parquet")
    return planted


def scored(rows: list[dict[str, Any]], planted: dict[str, tuple[str, ...]]) -> Iterator[str]:
    """Lines on right and false names, from each sensor alone and given the fleet."""
    right = sum(_found(row, planted[row["sensor"]]) for row in rows)
    ill = [row for row in rows if planted[row["sensor"]]]
    first = sum(bool(set(row["class"]) & set(planted[row["sensor"]])) for row in ill)
    yield f"all causes claimed, by class: {100 * right / len(rows):.1f} % of the sensors"
    yield f"first cause of the right class: {100 * first / len(ill):.1f} % of the {len(ill)} that have one"
    for what, which in (("alone", "class_probability"), ("given the fleet", "fleet_class_probability")):
        names = [
            (bool(set(cause["class"]) & set(planted[row["sensor"]])), cause["id"])
            for row in rows
            if row["verdict" if what == "alone" else "fleet_verdict"] == "named"
            for cause in row["causes"]
            if cause[which] >= 0.9 and not cause["doubt"] and (cause["in_model"] or cause["kind"] != "effect")
        ]
        false = [id_ for is_right, id_ in names if not is_right]
        listed = sorted(set(false), key=lambda id_: -false.count(id_))
        said = ", ".join(f"{false.count(id_)} {id_}" for id_ in listed) or "none"
        rate = 100 * len(false) / max(len(names), 1)
        yield f"{what}: {len(names)} names, {len(false)} of them false ({rate:.1f} %): {said}"
        slipped = sum(
            not set(cause["class"]) & set(planted[row["sensor"]])
            for row in rows
            if row["verdict" if what == "alone" else "fleet_verdict"] == "named"
            and "cycle_slip" in planted[row["sensor"]]
            for cause in row["causes"]
            if cause[which] >= 0.9 and not cause["doubt"] and (cause["in_model"] or cause["kind"] != "effect")
        )
        yield f"  {slipped} of the false ones in sensors with cycle slips"


def _found(row: dict[str, Any], causes: tuple[str, ...]) -> bool:
    return all(any(cause in one["class"] for one in row["causes"]) for cause in causes)


def main(
    sensors: Annotated[int, typer.Option(help="Sensors of the fleet.")] = 1_000,
    rows: Annotated[int, typer.Option(help="Rows of each sensor.")] = 1_000,
    seed: Annotated[int | None, typer.Option(help="Seed; default: a fresh one.")] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default: all processors.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the summary.")] = None,
) -> None:
    """Draw a fleet, diagnose it, and tell time and names."""
    seed = int.from_bytes(os.urandom(4), "little") if seed is None else seed
    count = workers or processors()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch, "logs")
        folder.mkdir()
        planted = write(folder, sensors, rows, np.random.default_rng(seed))
        begun = perf_counter()
        fleet = diagnose_fleet(
            folder, "sensor_id", out=Path(scratch, "v.parquet"), models=Path(scratch, "models"),
            base="cramer", workers=count,
        )  # fmt: skip
        whole = perf_counter() - begun
    inside = sum(row["seconds"] for row in fleet.rows)
    print(f"seed {seed}: {sensors} sensors of {rows} rows, {count} processes: {whole:.1f} s")
    each = 1e3 * whole * count / sensors
    print(f"{inside / count:.1f} s of it in diagnoses; {each:.0f} ms a sensor and processor")
    print(", ".join(f"{n} {verdict}" for verdict, n in fleet.summary["verdicts"].items()))
    for line in scored(fleet.rows, planted):
        print(line)
    told = fleet.summary["false_discoveries"]
    for what in ("own", "fleet"):
        print(f"told, {what}: {told[what]['names']} names, {told[what]['expected_false']:.1f} false")
    for one in fleet.summary["together"]:
        print(f"together: {' and '.join(one['ids'])} in {one['sensors']}, by chance {one['by_chance']:.1f}")
    if json_file is not None:
        json_file.write_text(json.dumps(fleet.summary, indent=1))


if __name__ == "__main__":
    typer.run(main)
