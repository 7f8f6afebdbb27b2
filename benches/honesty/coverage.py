"""Whether the stated uncertainty of a corrected distance is true: fresh rows within U of its budget.

A table is drawn and diagnosed, its model is written and read again, and corrects other rows of the same
device. Designs a, b and c are those of the benchmark; the others are as people run them. With a step,
readings are rounded to it, and the targets of the fresh rows stand anywhere between two steps.
"""

import json
import tempfile
import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

from common import ROOT, Record, run, save

import numpy as np  # isort: skip  (common limits the threads first)
import typer
from hidden_effects import cases, designs, disturbance
from hidden_effects.cases import Case, Spec
from hidden_effects.causes import CAUSES
from hidden_effects.designs import DAY, Rows
from hidden_effects.log import Log
from hidden_effects.menu import fits
from hidden_effects.world import COLUMNS
from rich.console import Console
from rich.table import Table

import echocal
from echocal.correct import correct_table

assert ROOT

Random = np.random.Generator


class Weather(Rows):
    """A log of days at distances that are set in turn."""

    @property
    def offers(self) -> frozenset[str]:
        """What a cause may need of this design."""
        return frozenset({"time", "humidity", "days", "weather"})


def _log(random: Random, rows: int, step: float, distances: list[float], each: int) -> Rows:
    """Days of weather; so many rows at each distance in turn."""
    seconds = np.arange(rows) * step
    hours = seconds / 3600.0 % 24
    weather = designs.remembering(rows, np.exp(-step / (1.5 * DAY)), random)
    swing = random.uniform(4, 9) * np.sin(2 * np.pi * (hours - 9) / 24)
    humidity = np.clip(0.6 - 0.02 * swing - 0.06 * weather, 0.05, 1.0)
    place = np.arange(rows) // each % len(distances)
    temperature = random.uniform(8, 20) + swing + 2.5 * weather
    more = designs._surroundings(rows, hours, random)
    return Weather("log", np.array(distances)[place], temperature, humidity, seconds, place, **more)


def outdoors(random: Random) -> Rows:
    """One target, five days, a row every five minutes."""
    return _log(random, 1440, 300.0, [round(random.uniform(1.0, 3.5), 2)], 1440)


def warehouse(random: Random) -> Rows:
    """Three distances for eight hours each, ten days, a row every half hour."""
    return _log(random, 480, 1800.0, [0.5, 1.2, 2.5], 16)


def student(random: Random, each: int = 25) -> Rows:
    """Eight ascending distances, so many readings at each, on a cool and on a warm day."""
    distances, rows = np.round(np.sort(random.uniform(0.2, 3.0, 8)), 2), 16 * each
    warm = np.repeat([random.uniform(17, 22), random.uniform(25, 32)], rows // 2)
    slow = designs.remembering(rows, 0.99, random)
    humidity = np.full(rows, random.uniform(0.3, 0.6)) + 0.02 * designs.remembering(rows, 0.99, random)
    seconds = np.arange(rows) * 2.0 + 7200.0 * (np.arange(rows) >= rows // 2)
    more = designs._surroundings(rows, np.full(rows, 12.0), random)
    distance, stand = np.tile(np.repeat(distances, each), 2), np.repeat(np.arange(16), each)
    return Rows("b", distance, warm + 0.3 * slow, humidity, seconds, stand, **more)


def quick(random: Random) -> Rows:
    """The same with three readings at each."""
    return student(random, 3)


DESIGNS = {**designs.DESIGNS, **{own.__name__: own for own in (outdoors, warehouse, student, quick)}}
WITHIN = ("within_1", "within_2", "within_U")
TAPED = ("b", "student", "quick")
"""Designs whose tape may err by 0.5 mm at each distance."""


def draw(design: str, count: int, seed: int) -> list[Spec]:
    """Nothing in a quarter of the tables, else one cause of a size by its prior or by its snr."""
    random = np.random.default_rng([seed, *design.encode()])
    able = [id_ for id_ in fits(design) if CAUSES[id_].repeats]
    specs = []
    for _ in range(count):
        stratum = str(random.choice(["null", "prior", "wild", "wild"]))
        causes = () if stratum == "null" else (str(random.choice(able)),)
        noise = str(random.choice(["normal", "normal", "student_t4", "autoregressive"]))
        tape = 0.5e-3 if design in TAPED and random.random() < 0.5 else 0.0
        specs.append(Spec(design, stratum, causes, noise, tape, int(random.integers(2**62))))
    return specs


def ask(spec: Spec, step: float = 0.0) -> Record:
    """Diagnose a table, correct fresh rows by its model, and compare their errors with what is stated."""
    case = cases.build(spec)
    if step:
        case.table["reading_m"] = _rounded(case.table["reading_m"].to_numpy(), step)
    with warnings.catch_warnings(action="ignore"), tempfile.TemporaryDirectory() as folder:
        diagnosis = echocal.diagnose(case.table)
        diagnosis.model.save(Path(folder) / "model.json")
        model = echocal.Model.load(Path(folder) / "model.json")
        table, truth = fresh(case, step)
        found = correct_table(table, model).table
        expanded = echocal.budget(model, table, trials=0).expanded_uncertainty
    error = found["corrected_distance_m"].to_numpy() - truth
    stated = found["distance_standard_uncertainty_m"].to_numpy()
    known = np.isfinite(error)
    return {
        "design": spec.design,
        "causes": list(spec.causes),
        "noise": spec.noise,
        "within_1": float(np.mean(np.abs(error[known]) < stated[known])),
        "within_2": float(np.mean(np.abs(error[known]) < 2.0 * stated[known])),
        "within_U": float(np.mean(np.abs(error[known]) < expanded[known])),
        "rms_m": float(np.sqrt(np.mean(error[known] ** 2))),
        "stated_m": float(np.median(stated[known])),
        "verdict": diagnosis.verdict,
    }


def _rounded(values: np.ndarray, step: float) -> np.ndarray:
    return np.round(values / step) * step if step else values


def fresh(case: Case, step: float = 0.0) -> tuple[object, np.ndarray]:
    """Other weather and noise, the same device and distances: its table, and the true distances.

    With a step of the readings, each target stands up to half a step from where it stood before.
    """
    spec = case.spec
    random = np.random.default_rng([spec.seed, 7])
    rows = case.rows if spec.design in "ab" else DESIGNS[spec.design](random)
    if spec.design != "c":
        rows = replace(rows, distance=case.rows.distance)
    beside = step * random.uniform(-0.5, 0.5, rows.stand.max() + 1)[rows.stand]
    world = cases.planted(replace(rows, distance=rows.distance + beside), case.sizes, spec.seed)
    reading = _rounded(world.reading() + disturbance.NOISES[spec.noise](rows, random), step)
    log = Log(world, reading, world.recorded.copy())
    shown = {name for name, column in COLUMNS.items() if column in case.table.columns}
    return log.table(shown, world.reference), world.reference


def summarize(found: list[Record]) -> Record:
    """Mean and standard error of the shares, by design."""
    groups = {name: [one for one in found if one["design"] == name] for name in DESIGNS}
    return {name: _figures(own) for name, own in groups.items() if own} | {"all": _figures(found)}


def _figures(own: list[Record]) -> Record:
    shares = {name: np.array([one[name] for one in own]) for name in WITHIN}
    figures: Record = {name: [float(s.mean()), float(s.std() / len(s) ** 0.5)] for name, s in shares.items()}
    ratio = [one["rms_m"] / one["stated_m"] for one in own if one["stated_m"] > 0.0]
    lowest = float(np.quantile(shares["within_U"], 0.05))
    typical = float(np.median(ratio)) if ratio else np.nan
    return {**figures, "lowest": lowest, "rms_over_stated": typical, "count": len(own)}


def main(
    count: Annotated[int, typer.Option(help="Tables of each design.")] = 200,
    where: Annotated[str, typer.Option(help="Designs, by comma.")] = ",".join(DESIGNS),
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    step_mm: Annotated[float, typer.Option(help="Step that readings are rounded to.")] = 0.0,
    write: Annotated[bool, typer.Option("--write", help="Write coverage.json.")] = False,
    details: Annotated[Path | None, typer.Option(help="Write every answer here, as JSON.")] = None,
) -> None:
    """Draw, ask and report."""
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    tasks = [spec for design in where.split(",") for spec in draw(design, count, chosen)]
    found = run(tasks, partial(ask, step=1e-3 * step_mm), "drawn tables", processes)
    summary = {"seed": chosen, "designs": summarize(found)}
    if write and step_mm:
        raise typer.BadParameter("coverage.json is without a step; leave one of both out")
    heads = ("design", "tables", "within u", "within 2 u", "within U", "lowest 5 %", "RMS / u")
    table = Table(*heads, title=f"seed {chosen}")
    for name, row in summary["designs"].items():
        shares = [f"{row[key][0]:.3f} +/- {row[key][1]:.3f}" for key in WITHIN]
        others = [f"{row[key]:.2f}" for key in ("lowest", "rms_over_stated")]
        table.add_row(name, str(row["count"]), *shares, *others)
    Console(width=120).print(table)
    if details:
        details.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    if write:
        save("coverage", summary)


designs.DESIGNS.update(DESIGNS)

if __name__ == "__main__":
    typer.run(main)
