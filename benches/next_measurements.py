"""Ten rows after a study's sweep: how often the cause is right then, by how the rows were chosen."""

import os
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path
from typing import Annotated, Any

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import track  # noqa: E402
from rich.table import Table  # noqa: E402

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hidden_effects import disturbance  # noqa: E402
from hidden_effects.aliases import label, labels, same_class  # noqa: E402
from hidden_effects.answers import known  # noqa: E402
from hidden_effects.cases import Case, Spec, build, planted  # noqa: E402
from hidden_effects.designs import Rows  # noqa: E402
from hidden_effects.menu import draw, fits  # noqa: E402
from hidden_effects.score import mean, part, resampled  # noqa: E402

import echocal  # noqa: E402

RANGES = {"distance": (0.3, 4.0), "temperature": (0.0, 50.0)}
CORNERS = list(product(*RANGES.values()))
ROWS = 10
SCATTER = {facts.id for facts in echocal.noises()}
DRAWN = {"null": 0.44, "prior": 0.45, "pair": 0.10}  # as the engine expects nothing, one cause and two
_OFF = 0.5  # K
_PLACES, _NOISE, _TAPE, _CHANCE = range(4)  # streams of random numbers of a case: the same for every way

Column = np.ndarray[Any, np.dtype[np.float64]]
Places = tuple[Column, Column]  # distance [m] and temperature [degC] of each of the ten rows
Record = dict[str, Any]


def stream(case: Case, which: int) -> np.random.Generator:
    return np.random.default_rng([case.spec.seed, 1000 + which])


def spread(places: list[tuple[float, float]]) -> Places:
    """Ten rows shared between places."""
    rows = np.array([places[i] for i in sorted(i % len(places) for i in range(ROWS))])
    return rows[:, 0], rows[:, 1]


def ceiling() -> Iterator[Places]:
    """Every two places of nine, the corners with each of the others, and ladders of distances."""
    near, far = RANGES["distance"]
    nine = list(product(np.geomspace(near, far, 3), np.linspace(*RANGES["temperature"], 3)))
    for pair in combinations(nine, 2):
        yield spread(list(pair))
    for place in nine:
        if place not in CORNERS:
            yield spread([*CORNERS, place])
    yield spread(nine)
    for count in (5, ROWS):
        yield spread(
            [(d, RANGES["temperature"][i % 2]) for i, d in enumerate(np.geomspace(near, far, count))]
        )
    for distance in (near, far):
        yield spread([(distance, t) for t in np.linspace(*RANGES["temperature"], ROWS)])


def placed(case: Case, places: Places) -> Rows:
    """Rows at these places, everything else as it was in rows of the case drawn by chance."""
    random = stream(case, _PLACES)
    pick = random.integers(len(case.rows), size=ROWS)
    columns = {k: v[pick] for k, v in vars(case.rows).items() if isinstance(v, np.ndarray)}
    near = places[1] + random.uniform(-_OFF, _OFF, ROWS)  # nobody meets a temperature to the digit
    there = {"distance": np.round(places[0], 3), "temperature": near, "stand": np.zeros(ROWS, dtype=int)}
    return replace(case.rows, **{**columns, **there})


def measured(case: Case, rows: Rows, tape: float) -> pd.DataFrame:
    """The same device and error, measured there with the case's noise."""
    world = planted(rows, case.sizes, case.spec.seed)
    reading = world.reading() + disturbance.NOISES[case.spec.noise](rows, stream(case, _NOISE))
    stands, which = np.unique(rows.distance, return_inverse=True)
    wrong = stream(case, _TAPE).normal(0, tape, len(stands)) * ~np.isin(stands, case.rows.distance)
    return world.table(reading, set(), world.reference + wrong[which])


def alike(case: Case, truth: tuple[str, ...], said: tuple[str, ...]) -> bool:
    """Whether each cause that is there is answered by one that the case's rows see as it, and no more."""
    left = list(said)
    for id_ in truth:
        match = next((name for name in left if same_class(case, id_, name)), None)
        if match is None:
            return False
        left.remove(match)
    return not left


def scored(case: Case, rows: Rows, diagnosis: echocal.Diagnosis) -> Record:
    """Whether the first set of effects is right, by three measures; causes of scatter are no matter."""
    posterior: dict[tuple[str, ...], float] = {}
    for ids, p in diagnosis.posterior:
        shifts = labels(id_ for id_ in ids if id_ not in SCATTER)
        posterior[shifts] = posterior.get(shifts, 0.0) + p
    first, truth = max(posterior, key=lambda ids: posterior[ids]), labels(case.spec.causes)
    planted_ids = tuple({label(id_): id_ for id_ in case.spec.causes}.values())
    return {
        "strict": first == truth,
        "class": first == truth or alike(case, planted_ids, first),
        "class after": first == truth or alike(replace(case, rows=rows), planted_ids, first),
        "probability": posterior.get(truth, 0.0),
    }


def diagnosed(table: pd.DataFrame) -> echocal.Diagnosis:
    with warnings.catch_warnings(action="ignore"):
        return echocal.diagnose(table, can_vary=RANGES)


def after(case: Case, places: Places, tape: float) -> Record:
    rows = placed(case, places)
    columns = {k: v for k, v in vars(rows).items() if isinstance(v, np.ndarray)}
    whole = replace(case.rows, **{k: np.concatenate([getattr(case.rows, k), v]) for k, v in columns.items()})
    more = measured(case, rows, tape)
    return scored(case, whole, diagnosed(pd.concat([case.table, more], ignore_index=True)))


def ask(case: Case, tape: float, oracle: bool) -> Record:
    """Right or wrong before, and after each way to spend ten rows; what was promised for the planned ones."""
    diagnosis = diagnosed(case.table)
    plan = next((p for p in diagnosis.next_measurements if p.expected_probability is not None), None)
    random = stream(case, _CHANCE)
    same = random.integers(len(case.rows), size=ROWS)
    ways: dict[str, Places] = {
        "repeated": (case.rows.distance[same], case.rows.temperature[same]),
        "random": (random.uniform(*RANGES["distance"], ROWS), random.uniform(*RANGES["temperature"], ROWS)),
        "corners": spread(CORNERS),
    }
    if plan is not None:
        count = plan.conditions["rows"]
        ways["planned"] = tuple(np.repeat(plan.conditions[name], count) for name in RANGES)
    before = scored(case, case.rows, diagnosis)
    record = {"before": before, **{name: after(case, places, tape) for name, places in ways.items()}}
    record.setdefault("planned", before)
    if oracle:
        tried = [after(case, places, tape) for places in ceiling()]
        record["best two, the truth known"] = max(tried[:36], key=lambda r: r["probability"])
        record["best of all, the truth known"] = max(tried, key=lambda r: r["probability"])
        record["any of all"] = {k: max(r[k] for r in tried) for k in before}
    if plan is not None:
        record["now"], record["promised"] = plan.probability_now, plan.expected_probability
    return record


def drawn(count: int, causes: list[str], random: np.random.Generator) -> list[Spec]:
    """Cases as the engine expects them: often nothing, and sizes from the priors."""
    shares = np.array(list(DRAWN.values()))
    counts = random.multinomial(count, shares / shares.sum())
    specs = []
    for stratum, some in zip(DRAWN, counts, strict=True):
        found = draw("a", stratum, int(some), causes, random)
        specs += [replace(s, stratum="prior") if stratum == "pair" else s for s in found]
    return specs


def summary(records: list[Record]) -> Table:
    table = Table(
        "ten rows more", "right (95 %)", "class by the sweep", "class by all rows", "its probability"
    )
    for name in (k for k, v in records[0].items() if isinstance(v, dict)):
        own = [r[name] for r in records]
        parts = [
            str(part(own, lambda r, by=by: bool(r[by]))).rsplit(" ", 1)[0]
            for by in ("strict", "class", "class after")
        ]
        table.add_row(name, *parts, str(resampled(own, mean("probability"))).rsplit(" ", 1)[0])
    return table


def main(
    cases: Annotated[int, typer.Option(help="Cases; all with causes that design a can show.")] = 100,
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    stratum: Annotated[
        str, typer.Option(help="power8 (snr sqrt(n) of 8), wild, prior, drawn (often nothing, as believed).")
    ] = "wild",
    tape: Annotated[float, typer.Option(help="Error of each new stand's distance [m].")] = 0.0,
    oracle: Annotated[bool, typer.Option("--oracle", help="Try designs knowing the truth (slow).")] = False,
) -> None:
    """Hide causes in a study's sweep, measure ten rows more, and ask again."""
    console = Console(width=130)
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    console.print(f"seed {chosen}")
    random = np.random.default_rng(chosen)
    causes = [id_ for id_ in fits("a") if id_ in known()]
    specs = drawn(cases, causes, random) if stratum == "drawn" else draw("a", stratum, cases, causes, random)
    records = [ask(build(spec), tape, oracle) for spec in track(specs, console=console)]
    console.print(summary(records))
    proposed = [r for r in records if "promised" in r]
    if not proposed:
        return
    for said, by in (("now", "before"), ("promised", "planned")):
        told = np.mean([r[said] for r in proposed])
        kept = part(proposed, lambda r, by=by: bool(r[by]["strict"]))
        console.print(f"where rows are proposed, {by}: {told:.2f} told, {kept}")


if __name__ == "__main__":
    typer.run(main)
