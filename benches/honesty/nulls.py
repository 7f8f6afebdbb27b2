"""Drawn tables without an effect, or with a planted one: what is named, and whether the gain is true.

The reported gain is compared with that on a replicate: the same rows and the same effect, and new noise.
"""

import json
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from common import LIKELY, ROOT, Record, run, save, share, text, told

import numpy as np  # isort: skip  (common limits the threads first)
import typer
from hidden_effects import cases, designs, disturbance
from hidden_effects.answers import known
from hidden_effects.causes import CAUSES
from hidden_effects.designs import DESIGNS, Rows
from hidden_effects.menu import fits
from hidden_effects.world import COLUMNS, World
from numpy.typing import NDArray
from records import said
from rich.console import Console
from rich.table import Table

import echocal

assert ROOT
Column = NDArray[np.float64]
Noise = Callable[[Rows, np.random.Generator], Column]
SHOT = disturbance.SHOT

POWER = 8.0
"""snr sqrt(N) of a planted effect."""


def _autoregressive(keep: float) -> Noise:
    return lambda rows, random: SHOT * designs.remembering(len(rows), keep, random)


def _growing(rows: Rows, random: np.random.Generator) -> Column:
    return SHOT * designs.remembering(len(rows), 0.8, random) * rows.distance / 2.0


def _following(column: Column, random: np.random.Generator) -> Column:
    """White, with a standard deviation that grows fourfold over the range of a column."""
    low, high = column.min(), column.max()
    part = (column - low) / (high - low) if high > low else np.full(len(column), 0.5)
    return SHOT * (0.4 + 1.2 * part) * random.normal(size=len(column))


def _outliers(rows: Rows, random: np.random.Generator) -> Column:
    """White; 5 % of the rows have a tenfold standard deviation."""
    wild = random.random(len(rows)) < 0.05
    return SHOT * np.where(wild, 10.0, 1.0) * random.normal(size=len(rows))


NOISES: dict[str, Noise] = {
    "white": disturbance.white,
    "student t4": disturbance.heavy,
    "AR 0.6": _autoregressive(0.6),
    "AR 0.95": _autoregressive(0.95),
    "AR 0.8 times distance": _growing,
    "sd follows T": lambda rows, random: _following(rows.temperature, random),
    "sd follows d": lambda rows, random: _following(rows.distance, random),
    "5 % outliers": _outliers,
}


@dataclass(frozen=True)
class Task:
    """A table: its design, noise, planted effect and seed."""

    design: str
    noise: str
    cause: str | None
    seed: int


def draw(count: int, seed: int, kinds: list[str], where: list[str], *, planted: bool) -> list[Task]:
    """So many tables of each noise and design; planted effects take turns in an order of chance."""
    tasks = []
    for design in where:
        able = [id_ for id_ in fits(design) if id_ in known() and CAUSES[id_].size != "fixed"]
        for noise in kinds:
            random = np.random.default_rng([seed, planted, *design.encode(), *noise.encode()])
            order = random.permutation(len(able))
            tasks += [
                Task(
                    design,
                    noise,
                    able[order[i % len(able)]] if planted else None,
                    int(random.integers(2**62)),
                )
                for i in range(count)
            ]
    return tasks


def ask(task: Task) -> Record:
    """Diagnose one table; judge its model on a replicate."""
    streams = [np.random.default_rng([task.seed, i]) for i in range(4)]
    rows = DESIGNS[task.design](streams[0])
    world = _world(task, rows, streams[1])
    reading, truth = world.reading(), world.reference
    shows = set(CAUSES[task.cause].shows) if task.cause else set()
    shown = shows | {name for name in COLUMNS if task.design == "c" and streams[1].random() < 0.3}
    table, fresh = (
        world.table(reading + NOISES[task.noise](rows, random), shown) for random in (streams[2], streams[3])
    )
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(table)
        seen = echocal.read_observations(fresh, reading_speed="linear")
        values = fresh["reading_m"].to_numpy()
        after = np.asarray(diagnosis.model.correct(values, **seen.conditions))
    before = float(np.mean((values - truth) ** 2))
    return {
        "design": task.design,
        "noise": task.noise,
        "cause": task.cause,
        "fresh": 1.0 - float(np.nanmean((after - truth) ** 2)) / before,
        "lost_rows": int(np.isnan(after).sum()),
        "acts": bool(diagnosis.model.effects),
        "effects": list(diagnosis.model.effects),
        **said(diagnosis),
    }


def _world(task: Task, rows: Rows, random: np.random.Generator) -> World:
    if task.cause is None:
        return World(rows)
    snr = POWER / np.sqrt(len(rows))
    sign = random.choice([-1.0, 1.0]) if CAUSES[task.cause].size == "signed" else 1.0
    size = sign * cases.by_snr(rows, task.cause, snr, task.seed)
    return cases.planted(rows, {task.cause: float(size)}, task.seed)


def main(
    count: Annotated[int, typer.Option(help="Tables of each noise and design.")] = 40,
    planted: Annotated[int, typer.Option(help="The same with an effect, white noise and AR 0.6.")] = 40,
    kinds: Annotated[str, typer.Option(help="Noises, by comma.")] = ",".join(NOISES),
    where: Annotated[str, typer.Option(help="Designs, by comma.")] = ",".join(DESIGNS),
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    write: Annotated[bool, typer.Option("--write", help="Write nulls.json.")] = False,
    details: Annotated[Path | None, typer.Option(help="Write every answer here, as JSON.")] = None,
) -> None:
    """Draw, ask and report."""
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    console = Console(width=150)
    console.print(f"seed {chosen}")
    noises = kinds.split(",")
    under = [noise for noise in ("white", "AR 0.6") if noise in noises]
    tasks = draw(count, chosen, noises, where.split(","), planted=False)
    tasks += draw(planted, chosen, under, where.split(","), planted=True)
    found = run(tasks, ask, "drawn tables", processes)
    summary = {"seed": chosen, **summarize(found)}
    show(summary, console)
    if details:
        details.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    if write:
        save("nulls", summary)


def summarize(found: list[Record]) -> Record:
    """Figures by noise and design, nulls and planted effects apart."""
    outcome: Record = {}
    for key, planted in (("nulls", False), ("planted", True)):
        own = [one for one in found if (one["cause"] is not None) == planted]
        groups = {(one["noise"], one["design"]) for one in own}
        rows = {
            f"{noise}, {design}": _figures([o for o in own if (o["noise"], o["design"]) == (noise, design)])
            for noise in NOISES
            for design in DESIGNS
            if (noise, design) in groups
        }
        outcome[key] = rows | ({"all": _figures(own)} if own else {})
    return outcome


def _figures(own: list[Record]) -> Record:
    acting = [one for one in own if one["acts"]]
    named = [one for one in own if told(one["causes"])]
    return {
        "not_nothing": share(sum(one["verdict"] != "nothing" for one in own), len(own)),
        "alarm": share(sum(_alarm(one) for one in own), len(own)),
        "acts": share(len(acting), len(own)),
        "named": share(len(named), len(own)),
        "names": dict(Counter(c["id"] for one in own for c in told(one["causes"])).most_common()),
        "reported": _mean([one["gain"] for one in own]),
        "fresh": _mean([one["fresh"] for one in own]),
        "reported_where_acting": _mean([one["gain"] for one in acting]),
        "fresh_where_acting": _mean([one["fresh"] for one in acting]),
        "reported_where_named": _mean([one["gain"] for one in named]),
        "fresh_where_named": _mean([one["fresh"] for one in named]),
    }


def _alarm(one: Record) -> bool:
    """Whether anything but noise is reported: an effect, a fault, a term, or an open question."""
    likely = {cause["kind"] for cause in one["causes"] if cause["probability"] > LIKELY}
    return one["verdict"] != "nothing" and not (one["verdict"] == "named" and likely == {"noise"})


def _mean(values: list[float]) -> list[float] | None:
    """Mean and its standard error."""
    if not values:
        return None
    error = np.std(values, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else 0.0
    return [float(np.mean(values)), float(error)]


def show(summary: Record, console: Console) -> None:
    """Print the figures."""
    for key in ("nulls", "planted"):
        columns = (
            "",
            "alarm",
            "model acts",
            "cause named",
            "reported / fresh",
            "acting",
            "named",
            "names",
        )
        table = Table(*columns, title=key)
        for label, row in summary[key].items():
            pairs = [
                " / ".join("-" if row[name] is None else f"{100 * row[name][0]:+.1f} %" for name in names)
                for names in (
                    ("reported", "fresh"),
                    ("reported_where_acting", "fresh_where_acting"),
                    ("reported_where_named", "fresh_where_named"),
                )
            ]
            names = ", ".join(f"{name} {count}" for name, count in list(row["names"].items())[:4])
            shares = [text(row[name]) for name in ("alarm", "acts", "named")]
            table.add_row(label, *shares, *pairs, names if key == "nulls" else "")
        console.print(table)


if __name__ == "__main__":
    typer.run(main)
