"""How soon a change is told, beside the delay that theory allows: docs/watch.png.

``python benches/watch.py --docs`` draws fresh logs, writes benches/watch.json and draws the figure; without
``--docs`` it prints the table only. Two minutes on two processors.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

import echocal
from echocal.watch import WatchSettings
from echocal.watch.monitor import Monitor
from echocal.watch.signatures import Signatures
from echocal.watch.threshold import cusum_delay

ROOT = Path(__file__).parents[1]
RESULTS, FIGURE = ROOT / "benches" / "watch.json", ROOT / "docs" / "watch.png"
DAY, WAIT, NOISE = 86400.0, 600.0, 1e-3
RHOS = (0.0, 0.9)
STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)
DRIFTS = (0.1, 0.3, 1.0, 3.0, 10.0)
LEARN, BEFORE, LONGEST = 2000, 500, 6000
Column = np.ndarray


def weather(rng: np.random.Generator, rows: int) -> Column:
    """Temperature with days and weather [degC]."""
    hours = np.arange(rows) * WAIT / 3600.0
    slow = lfilter([0.03], [1.0, -0.999], rng.standard_normal(rows))
    return np.asarray(15.0 + 6.0 * np.sin(2.0 * np.pi * hours / 24.0) + 3.0 * slow)


def noise(rng: np.random.Generator, rows: int, rho: float) -> Column:
    """Autoregression of 1 mm."""
    white = rng.standard_normal(rows + 300) * np.sqrt(1.0 - rho**2)
    return NOISE * np.asarray(lfilter([1.0], [1.0, -rho], white))[300:]


def logged(rng: np.random.Generator, rows: int) -> Column:
    """Signatures of a sensor at random distances in changing weather."""
    temperature = weather(rng, rows)
    distance = rng.uniform(1.0, 3.0, rows)
    model = echocal.Model("cramer", air={"relative_humidity": 0.5})
    signatures = Signatures(model, ["temperature"]).at(distance, {"temperature": temperature})
    return np.column_stack([np.full(rows, 0.005), signatures])


def least(change: Column, rho: float, run_length: float) -> float:
    """Rows after which the information about a change reaches log(run length) (Lorden 1971, Lai 1998)."""
    shifted = np.concatenate([[0.0], change[:-1]])
    information = 0.5 * np.cumsum((change - rho * shifted) ** 2) / (NOISE**2 * (1.0 - rho**2))
    return float(np.interp(np.log(run_length), information, np.arange(1, len(change) + 1)))


def changed(kind: str, size: float, count: int = LONGEST) -> Column:
    """What a change adds, from its first row on [m]: a step in noise sd, a drift in mm a day."""
    rows = np.arange(count)
    return np.full(count, size * NOISE) if kind == "step" else size * 1e-3 * rows * WAIT / DAY


def run(job: tuple[float, int]) -> list[tuple[str, float, float, float | None]]:
    """Delays of all changes after one learned log: kind, size, autocorrelation, rows."""
    rho, seed = job
    rng = np.random.default_rng(seed)
    rows = LEARN + BEFORE + LONGEST
    columns = logged(rng, rows)
    monitor = Monitor(WatchSettings(learn=LEARN))
    usual = noise(rng, rows, rho)
    first = LEARN + BEFORE
    for row in range(first):
        monitor.add(WAIT * row, float(usual[row]), columns[row])
    found: list[tuple[str, float, float, float | None]] = []
    for kind, sizes in (("step", STEPS), ("drift", DRIFTS)):
        for size in sizes:
            added, own = changed(kind, size), deepcopy(monitor)
            told = None
            for row in range(first, rows):
                if own.add(WAIT * row, float(usual[row] + added[row - first]), columns[row]):
                    told = float(row - first + 1)
                    break
            found.append((kind, size, rho, told))
    return found


def measure(logs: int, processes: int, seed: int) -> dict[str, Any]:
    """Mean delays with their standard errors, beside the bounds."""
    jobs = [(rho, seed + log) for rho in RHOS for log in range(logs)]
    with ProcessPoolExecutor(processes) as pool:
        found = [one for own in pool.map(run, jobs) for one in own]
    settings = WatchSettings()
    run_length = 365.25 * DAY / WAIT / settings.false_alarms
    lines = []
    for kind, sizes in (("step", STEPS), ("drift", DRIFTS)):
        for rho in RHOS:
            for size in sizes:
                delays = [d for k, s, r, d in found if (k, s, r) == (kind, size, rho)]
                told = np.array([d for d in delays if d is not None])
                best = cusum_delay(run_length, size) if kind == "step" and rho == 0.0 else None
                lines.append(
                    {
                        "kind": kind,
                        "size": size,
                        "autocorrelation": rho,
                        "delay_rows": float(told.mean()) if len(told) else None,
                        "standard_error": float(told.std(ddof=1) / np.sqrt(len(told)))
                        if len(told) > 1
                        else None,
                        "told": len(told),
                        "logs": len(delays),
                        "bound_rows": least(changed(kind, size, 50 * LONGEST), rho, run_length),
                        "cusum_rows": best,
                    }
                )
    return {"seed": seed, "run_length_rows": run_length, "learn": LEARN, "lines": lines}


def table(results: dict[str, Any]) -> str:
    """The figures as a table of the page."""
    text = [
        "| change | noise | told after, mean [rows] | Eq. 56 [rows] | ratio |",
        "|---|---|---|---|---|",
    ]
    for one in results["lines"]:
        unit = "standard deviations" if one["kind"] == "step" else "mm a day"
        kind = "white" if one["autocorrelation"] == 0.0 else f"autocorrelation {one['autocorrelation']:g}"
        error = "" if one["standard_error"] is None else f" ± {one['standard_error']:.2g}"
        delay = "-" if one["delay_rows"] is None else f"{one['delay_rows']:.3g}{error}"
        if one["told"] < one["logs"]:
            delay += f" (in {one['told']} of {one['logs']})"
        ratio = "-" if one["told"] < one["logs"] else f"{one['delay_rows'] / one['bound_rows']:.2f}"
        what = f"{one['kind']} of {one['size']:g} {unit}"
        text.append(f"| {what} | {kind} | {delay} | {one['bound_rows']:.3g} | {ratio} |")
    return "\n".join(text) + "\n"


def draw(results: dict[str, Any], path: Path) -> None:
    """Delay against size, measured and bound."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")
    colors = {0.0: "#1f4e79", 0.9: "#c55a11"}
    for ax, kind, unit in zip(
        axes, ("step", "drift"), ("step [standard deviations]", "drift [mm a day]"), strict=True
    ):
        for rho in RHOS:
            own = [o for o in results["lines"] if (o["kind"], o["autocorrelation"]) == (kind, rho)]
            size = [o["size"] for o in own]
            name = "white noise" if rho == 0.0 else f"autocorrelation {rho:g}"
            ax.plot(size, [o["bound_rows"] for o in own], "--", color=colors[rho], label=f"Eq. 56, {name}")
            whole = [o for o in own if o["told"] == o["logs"]]
            ax.errorbar(
                [o["size"] for o in whole],
                [o["delay_rows"] for o in whole],
                [1.96 * o["standard_error"] for o in whole],
                fmt="o",
                color=colors[rho],
                label=f"echocal watch, {name}",
            )
            if kind == "step" and rho == 0.0:
                ax.plot(
                    size,
                    [o["cusum_rows"] for o in own],
                    ":",
                    color="black",
                    label="CUSUM for this size, white noise",
                )
        ax.set(xscale="log", yscale="log", xlabel=unit)
        ax.set_xticks(size, [f"{s:g}" for s in size], minor=False)
        ax.minorticks_off()
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("rows from the onset to the alarm")
    axes[0].legend(fontsize=8, frameon=False)
    axes[1].secondary_yaxis(
        "right", functions=(lambda r: r * WAIT / DAY, lambda d: d * DAY / WAIT)
    ).set_ylabel("days")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Measure, print, and with --docs write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=20)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--seed", type=int, default=int(np.random.SeedSequence().generate_state(1)[0]))
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--draw", action="store_true", help="draw what was measured last")
    given = parser.parse_args()
    if given.draw:
        draw(json.loads(RESULTS.read_text()), FIGURE)
        return
    results = measure(given.logs, given.processes, given.seed)
    print(table(results))
    if given.docs:
        RESULTS.write_text(json.dumps(results, indent=1) + "\n")
        draw(results, FIGURE)


if __name__ == "__main__":
    main()
