"""Whether the tests notice faults of the diagnosis: one fault at a time, and the tests that must fail.

`python benches/mutants.py` copies the package to a temporary folder, exchanges one piece of its text, and
runs the tests of this fault on the copy. A fault that no test notices survives, and the exit code is 1. The
same tests must pass on a copy without a fault.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "echocal"
LONGEST = 900.0  # s: a fault after which the tests do not end is noticed, too
FAILED, PASSED = 1, 0  # exit codes of pytest


class Mutant(NamedTuple):
    """A fault of `echocal.diagnose`: what it breaks, a text of a file, and what stands there instead."""

    breaks: str
    file: str
    text: str
    instead: str
    tests: str


MUTANTS = (
    # columns and signs
    Mutant(
        "sign of the columns of sizes",
        "candidates/columns.py",
        "at_work, levels, name, scale)",
        "at_work, levels, name, -scale)",
        "test_method.py",
    ),
    Mutant(
        "sign of the columns that are stored by their values, the residual among them",
        "candidates/columns.py",
        "self._core.store(np.ascontiguousarray(column))",
        "self._core.store(-np.ascontiguousarray(column))",
        "test_method.py",
    ),
    Mutant(
        "sign of a condition that was stated",
        "candidates/effects.py",
        "scale * (high - low)",
        "scale * (low - high)",
        "test_diagnose_stated.py",
    ),
    Mutant(
        "quantities in another order than that of the core",
        "candidates/columns.py",
        "for name in QUANTITIES]",
        "for name in sorted(QUANTITIES)]",
        "test_method.py",
    ),
    Mutant(
        "one cause is missing: the offset",
        "candidates/effects.py",
        "    for effect in effects():\n",
        '    for effect in (one for one in effects() if one.id != "zero_error"):\n',
        "test_method.py",
    ),
    Mutant(
        "sizes without the bounds of their parameters",
        "candidates/variant.py",
        "self.free, self.bounds, self.weight)",
        "self.free, ((float('-inf'), float('inf')),) * len(self.free), self.weight)",
        "test_method.py",
    ),
    # priors
    Mutant(
        "priors of sizes halved",
        "candidates/effects.py",
        "scales = [_scale(p, scene) for p in sizes]",
        "scales = [0.5 * _scale(p, scene) for p in sizes]",
        "test_method.py",
    ),
    Mutant(
        "prior of no cause halved",
        "settings/priors.py",
        "threshold(0.44,",
        "threshold(0.22,",
        "test_method.py",
    ),
    Mutant(
        "prior of an unexplained term times four",
        "inference/posterior.py",
        "priors.unexplained_term)",
        "4.0 * priors.unexplained_term)",
        "test_method.py",
    ),
    Mutant(
        "forms of a cause with equal shares of its prior",
        "candidates/effects.py",
        "v.weight / total)",
        "1.0 / len(variants))",
        "test_method.py",
    ),
    # noise
    Mutant(
        "autocorrelation ignored",
        "inference/sums.py",
        "0.0 if noise.growth else noise.rho,",
        "0.0,",
        "test_method.py",
    ),
    Mutant(
        "errors of stations ignored",
        "inference/sums.py",
        "            noise.station_ratio,\n",
        "            0.0,\n",
        "test_method.py",
    ),
    Mutant(
        "a series goes on after rows that were left out",
        "preprocess/order.py",
        "starts[1:] |= np.diff(rows) > 1",
        "starts[1:] |= False",
        "test_diagnose_score.py",
    ),
    Mutant(
        "unknown levels count as known",
        "inference/sums.py",
        "int(self.rows[use].sum()) - levels",
        "int(self.rows[use].sum())",
        "test_diagnose_unseen_rows.py",
    ),
    # held-out rows
    Mutant(
        "gain in sample: sizes fitted to the rows that judge them",
        "validation/gain.py",
        "fitted(folds.fit & ~held)",
        "fitted(folds.fit)",
        "test_diagnose_unseen_rows.py",
    ),
    Mutant(
        "a fold that leaks: its choice sees the rows that it holds out",
        "preprocess/folds.py",
        "fit=self.fit & blocks)",
        "fit=self.fit)",
        "test_diagnose_unseen_rows.py",
    ),
    Mutant(
        "rows of one station in every fold",
        "preprocess/folds.py",
        "groups % count, table.grouped_by",
        "np.arange(len(table)) % count, table.grouped_by",
        "test_diagnose_unseen_rows.py",
    ),
    Mutant(
        "folds of single rows instead of runs",
        "preprocess/folds.py",
        "np.arange(rows) * count // rows",
        "np.arange(rows) % count",
        "test_diagnose_unseen_rows.py",
    ),
    Mutant(
        "sign of the log score",
        "validation/score.py",
        "compared[rows] = other - own, True",
        "compared[rows] = own - other, True",
        "test_diagnose_score.py",
    ),
    # what is told
    Mutant(
        "interval of the gain half as wide",
        "validation/gain.py",
        "middle + _for_few(",
        "middle + 0.5 * _for_few(",
        "test_diagnose_gain_interval.py",
    ),
    Mutant(
        "interval of the gain twice as wide",
        "validation/gain.py",
        "middle + _for_few(",
        "middle + 2.0 * _for_few(",
        "test_diagnose_gain_interval.py",
    ),
    Mutant(
        "interval of the log score half as wide",
        "validation/score.py",
        "half = stdtrit(",
        "half = 0.5 * stdtrit(",
        "test_diagnose_score.py",
    ),
    Mutant(
        "standard uncertainties of sizes halved",
        "selection/claims.py",
        "fit.covariance[a, b] * scale_a * scale_b",
        "0.25 * fit.covariance[a, b] * scale_a * scale_b",
        "test_diagnose_gain_interval.py",
    ),
    Mutant(
        "residual uncertainty of a model halved",
        "validation/residual_uncertainty.py",
        "measured(held.error[rows],",
        "measured(0.5 * held.error[rows],",
        "test_correct_uncertainty.py::test_fresh_rows_are_within_twice_of_it",
    ),
    Mutant(
        "sets of causes that disagree add no uncertainty",
        "experiment_design/average.py",
        "(own + (value - mean) ** 2)",
        "own",
        "test_diagnose_average.py",
    ),
    Mutant(
        "errors before and after exchanged",
        "validation/gain.py",
        "rms_before_m=before.rms,\n        rms_after_m=after.rms,",
        "rms_before_m=after.rms,\n        rms_after_m=before.rms,",
        "test_diagnose_study.py",
    ),
    # names
    Mutant(
        "two names exchanged: offset and delay",
        "candidates/effects.py",
        "[replace(v, weight=",
        '[replace(v, cause={"zero_error": "fixed_delay", "fixed_delay": "zero_error"}.get(v.cause, v.cause),'
        " weight=",
        "test_method.py",
    ),
    Mutant(
        "causes that the data cannot separate are not told",
        "inference/alias.py",
        "for at in np.flatnonzero(alike)))",
        "for at in ()))",
        "test_diagnose_alias.py",
    ),
    Mutant(
        "a name needs no probability",
        "verdict.py",
        "named = ranking.settings.claims.named\n",
        "named = 0.0\n",
        "test_settings.py",
    ),
    Mutant(
        "the credible set is the most probable set alone",
        "verdict.py",
        "if total >= least:",
        "if total >= 0.0:",
        "test_diagnose_output.py",
    ),
)


def mutated(mutant: Mutant, package: Path) -> tuple[Path, str]:
    """File of a package, and its text with the fault."""
    file = package / "diagnose" / mutant.file
    text = file.read_text(encoding="utf-8")
    if (count := text.count(mutant.text)) != 1:
        message = f"{mutant.breaks}: {count} times in {mutant.file}, not once: {mutant.text!r}"
        raise SystemExit(message)
    return file, text.replace(mutant.text, mutant.instead)


def run(mutant: Mutant | None, tests: str, seed: int) -> tuple[str, float]:
    """Test that notices a fault, empty where none does, and the seconds it took."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "echocal"
        shutil.copytree(PACKAGE, package)
        if mutant is not None:
            file, text = mutated(mutant, package)
            file.write_text(text, encoding="utf-8")
        words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--tb=no"]
        known = {
            "PYTHONPATH": folder,
            "ECHOCAL_SEED": str(seed),
            "OMP_NUM_THREADS": "1",
            "RAYON_NUM_THREADS": "1",
        }
        words += [f"tests/{test}" for test in tests.split()]
        try:
            done = subprocess.run(
                words,
                cwd=ROOT,
                env=os.environ | known,
                capture_output=True,
                text=True,
                timeout=LONGEST,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return "the tests do not end", time.monotonic() - begun
    seconds = time.monotonic() - begun
    if done.returncode == PASSED:
        return "", seconds
    failures = [line for line in done.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    if done.returncode != FAILED or not failures:
        message = f"pytest {tests} has the exit code {done.returncode}:\n{done.stdout}{done.stderr}"
        raise SystemExit(message)
    return failures[0].split()[1].removeprefix("tests/"), seconds


def main(
    only: Annotated[str, typer.Option(help="Mutants with these words alone.")] = "",
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    processes: Annotated[int, typer.Option(help="Runs of pytest at once.")] = 2,
) -> None:
    """Run the tests of each mutant, and print which test notices it."""
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    console = Console(width=140)
    console.print(f"ECHOCAL_SEED={chosen}")
    mutants = [mutant for mutant in MUTANTS if only in mutant.breaks]
    for mutant in mutants:
        mutated(mutant, PACKAGE)
    every = " ".join(dict.fromkeys(test for mutant in mutants for test in mutant.tests.split()))
    tasks: list[tuple[Mutant | None, str]] = [(None, every), *((mutant, mutant.tests) for mutant in mutants)]
    bar = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*bar, console=console) as progress, ThreadPoolExecutor(processes) as pool:
        task = progress.add_task("mutants", total=len(tasks))
        waiting = {pool.submit(run, *one, chosen): i for i, one in enumerate(tasks)}
        found: list[tuple[str, float]] = [("", 0.0)] * len(tasks)
        for done in as_completed(waiting):
            found[waiting[done]] = done.result()
            progress.advance(task)
    table = Table("mutant", "killed by", "s", title=f"ECHOCAL_SEED={chosen}")
    for mutant, (killer, seconds) in zip(mutants, found[1:], strict=True):
        table.add_row(mutant.breaks, escape(killer) or "[red]survives[/]", f"{seconds:.0f}")
    console.print(table)
    if found[0][0]:
        raise SystemExit(f"without a mutant, {found[0][0]} fails: no mutant is judged")
    killed = sum(bool(killer) for killer, _ in found[1:])
    console.print(f"{killed} of {len(mutants)} are killed")
    raise typer.Exit(killed < len(mutants))


if __name__ == "__main__":
    typer.run(main)
