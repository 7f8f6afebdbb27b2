"""Which of three sensors on one target is told first when one of them changes.

python benches/watch_target.py              # 24 draws for each size, two minutes
"""

import os
from typing import Annotated, Any

import numpy as np
import typer

import echocal
from echocal.watch import Event, Fleet, Reference, State, WatchSettings

START = np.datetime64("2025-03-01T00:00:00")
ROWS, ONSET, WAIT, NOISE = 420, 300, 600, 1e-3
STEPS = (8e-3, 3e-3, 1.5e-3)


def changes(random: np.random.Generator, changed: str, step: float) -> list[Event]:
    """Changes that are told of a tank whose level moves by 2 cm."""
    rows: list[dict[str, Any]] = []
    level = 1.5 + 0.02 * np.sin(np.arange(ROWS) / 40.0)
    for i in range(ROWS):
        for place, name in enumerate("abc"):
            off = step if name == changed and i >= ONSET else 0.0
            reading = level[i] + off + NOISE * random.standard_normal()
            time = START + np.timedelta64(WAIT * i + 10 * place, "s")
            echo = 2e6 * reading / echocal.speed_of_sound(20.0, law="linear")
            rows.append({"id": name, "tank": "7", "time": str(time), "echo_us": echo, "temperature_C": 20.0})
    model, settings = echocal.Model("linear"), WatchSettings(learn=200)
    watch = Fleet(lambda _: model, "id", Reference(same_target="tank"), settings, State(None))
    return [event for event in watch.take(rows)[1] if event.kind == "change"]


def main(
    draws: Annotated[int, typer.Option(help="Draws for each size.")] = 24,
    seed: Annotated[int | None, typer.Option(help="Seed; default: a fresh one.")] = None,
) -> None:
    """Draw tanks, change a sensor of each, and count."""
    seed = int.from_bytes(os.urandom(4), "little") if seed is None else seed
    random = np.random.default_rng(seed)
    print(f"seed {seed}, noise {1e3 * NOISE:g} mm, {draws} draws of each size")
    for step in STEPS:
        told = first = named = 0
        for draw in range(draws):
            changed = "abc"[draw % 3]
            found = changes(random, changed, step)
            told += bool(found)
            first += bool(found) and found[0].sensor == changed
            named += bool(found) and found[0].details["moved_farthest"] == changed
        print(f"step of {1e3 * step:g} mm: told in {told}, first of it {first}, farthest {named}", flush=True)


if __name__ == "__main__":
    typer.run(main)
