"""Ten planned rows after a study's sweep: how often the class is right, against ten rows more of the same."""

import os
import sys
import warnings
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Annotated

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
from hidden_effects.aliases import labels  # noqa: E402
from hidden_effects.answers import known  # noqa: E402
from hidden_effects.cases import Case, build, planted  # noqa: E402
from hidden_effects.designs import Rows  # noqa: E402
from hidden_effects.menu import draw, fits  # noqa: E402
from hidden_effects.score import part  # noqa: E402

import echocal  # noqa: E402

RANGES = {"distance": (0.3, 4.0), "temperature": (0.0, 50.0)}
CORNERS = list(product(*RANGES.values()))
ROWS = 10
SCATTER = {facts.id for facts in echocal.noises()}
_OFF = 0.5  # K


def placed(case: Case, distance: np.ndarray, temperature: np.ndarray, random: np.random.Generator) -> Rows:
    """Rows at these places, everything else as it was in rows of the case drawn by chance."""
    pick = random.integers(len(case.rows), size=len(distance))
    columns = {k: v[pick] for k, v in vars(case.rows).items() if isinstance(v, np.ndarray)}
    rows = replace(case.rows, **columns)
    near = temperature + random.uniform(-_OFF, _OFF, len(pick))  # nobody meets a temperature to the digit
    return replace(rows, distance=distance, temperature=near, stand=np.zeros(len(pick), dtype=int))


def measured(case: Case, rows: Rows, random: np.random.Generator) -> pd.DataFrame:
    """The same device and error, measured there with the case's noise."""
    world = planted(rows, case.sizes, case.spec.seed)
    reading = world.reading() + disturbance.NOISES[case.spec.noise](rows, random)
    return world.table(reading, set())


def right(case: Case, table: pd.DataFrame) -> bool:
    """Whether the first set of effects is the truth or an exact alias; causes of scatter are no matter."""
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(table)
    posterior: dict[tuple[str, ...], float] = {}
    for ids, p in diagnosis.posterior:
        shifts = labels(id_ for id_ in ids if id_ not in SCATTER)
        posterior[shifts] = posterior.get(shifts, 0.0) + p
    return max(posterior, key=lambda ids: posterior[ids]) == labels(case.spec.causes)


def ask(case: Case, random: np.random.Generator) -> dict[str, float]:
    """Right or wrong before, and after each way to spend ten rows; what was promised for the planned ones."""
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(case.table, can_vary=RANGES)
    plan = next((p for p in diagnosis.next_measurements if p.expected_probability is not None), None)
    same = random.integers(len(case.rows), size=ROWS)
    places = {
        "repeated": (case.rows.distance[same], case.rows.temperature[same]),
        "corners": tuple(np.resize(np.array(ends), ROWS) for ends in zip(*CORNERS, strict=True)),
        "random": tuple(random.uniform(*ends, ROWS) for ends in RANGES.values()),
    }
    if plan is not None:
        count = plan.conditions["rows"]
        places["planned"] = tuple(np.repeat(plan.conditions[name], count) for name in RANGES)
    record = {"before": float(right(case, case.table)), "proposed": float(plan is not None)}
    for name, (distance, temperature) in places.items():
        more = measured(case, placed(case, distance, temperature, random), random)
        record[name] = float(right(case, pd.concat([case.table, more], ignore_index=True)))
    record.setdefault("planned", record["before"])
    if plan is not None:
        record["promised"] = plan.expected_probability or 0.0
    return record


def main(
    cases: Annotated[int, typer.Option(help="Cases; all with one cause that design a can show.")] = 100,
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    stratum: Annotated[str, typer.Option(help="Sizes: power8 (snr sqrt(n) of 8), wild, prior.")] = "wild",
) -> None:
    """Hide one cause in a study's sweep, measure ten rows more, and ask again."""
    console = Console(width=110)
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    console.print(f"seed {chosen}")
    random = np.random.default_rng(chosen)
    causes = [id_ for id_ in fits("a") if id_ in known()]
    specs = draw("a", stratum, cases, causes, random)
    records = [ask(build(spec), random) for spec in track(specs, console=console)]
    table = Table("ten rows more", "right class (95 %)")
    for name in ("before", "repeated", "random", "corners", "planned"):
        table.add_row(name, str(part(records, lambda r, name=name: bool(r[name]))))
    console.print(table)
    proposed = [r for r in records if r["proposed"]]
    promised = np.mean([r["promised"] for r in proposed]) if proposed else np.nan
    kept = np.mean([r["planned"] for r in proposed]) if proposed else np.nan
    console.print(f"rows proposed in {len(proposed)} cases: {promised:.2f} promised, {kept:.2f} kept")


if __name__ == "__main__":
    typer.run(main)
