"""Write the section "Beside real records" of docs/virtual-bench.md, and its figures.

python tests/reference/bench_anchors_page.py --write

The records are in the folder `shared/data` beside the repository, or in that of ECHOCAL_SHARED. They are no part
of it; the figures show numbers that are derived from them.
"""

import os
import sys
from pathlib import Path

import bench_anchors as anchors
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from echocal.virtual_bench import Scene, Sensor, Target, measure
from echocal.virtual_bench.waveform.measure import received

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "virtual-bench.md"
SHARED = Path(os.environ.get("ECHOCAL_SHARED", ROOT.parent / "shared")) / "data"
SEED, TIMES = 20210225, 4  # of the campaign on the bench, which is as many times as large
PLATE = Target(half_width=0.0165, half_height=0.019)  # m, of aluminum: last told at 1.52 m, lost at 1.85 m
RULE = Target(half_width=0.0127, half_height=0.43)  # m, of steel: last told at 2.15 m, lost at 2.45 m
PANEL = {0.15: 20.0, 0.45: 9.0, 1.0: 10.0, 1.45: 10.0, 2.45: 4.0}  # m and degree, off the axis


def slips(real: pd.DataFrame, bench: pd.DataFrame, boxes: pd.DataFrame) -> Figure:
    """Share and spacing of slips against the distance."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    for record, name, color in (
        (real, "desk-hcsr04, 20 sessions", "C0"),
        (bench, "bench, the same campaign", "C3"),
    ):
        table = anchors.shares(record)
        middle = 0.5 * (table["from"] + table["to"])
        left.errorbar(
            middle, table["share"], 2 * table["error"], fmt="o-", capsize=3, color=color, label=name
        )
        known = anchors.cycles(record)
        off = known["off"].abs()
        slipped = known[off.between(*anchors.SLIP)].assign(off=off)
        bands = pd.cut(slipped["distance"], [0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5])
        means = slipped.groupby(bands, observed=True).agg({"distance": "mean", "off": ["mean", "sem"]})
        right.errorbar(
            means["distance"]["mean"],
            means["off"]["mean"],
            2 * means["off"]["sem"],
            fmt="o-",
            capsize=3,
            color=color,
            label=name,
        )
    for arduino, name, marker in (
        (True, "kb-hcsr04 on an Arduino, runs", "x"),
        (False, "on a Raspberry Pi", "+"),
    ):
        runs = boxes[boxes["arduino"] == arduino]
        left.plot(runs["distance"], runs["share"], marker, color="0.5", ms=5, label=name)
        right.plot(runs["distance"], runs["spacing"], marker, color="0.5", ms=5, label=name)
    left.set(
        xlabel="distance [m]", ylabel="share of readings off the main cycle", xlim=(0, 1.6), ylim=(0, 0.8)
    )
    right.set(xlabel="distance [m]", ylabel="one cycle in echo time [us]", xlim=(0, 1.6), ylim=(19, 29))
    right.axhline(25.0, color="0.8", lw=0.8, zorder=0)
    left.legend(fontsize=8)
    return figure


def staircase(real: pd.DataFrame, bench: pd.DataFrame) -> Figure:
    """Placements at 4 to 20 cm."""
    figure, panes = plt.subplots(1, 2, figsize=(10, 4.0), sharey=True, layout="constrained")
    for pane, record, name in zip(panes, (real, bench), ("desk-hcsr04", "bench"), strict=True):
        table, numbers = anchors.branches(record)
        for cycle, color in ((0, "C0"), (-1, "C1"), (1, "C2")):
            here = table[table["cycle"] == cycle]
            label = {0: "main cycle", -1: "one earlier", 1: "one later"}[cycle]
            pane.plot(
                100 * here["distance"],
                here["delay"] - numbers["offset"],
                ".",
                color=color,
                ms=5,
                label=f"{label}: {len(here) / len(table):.2f}",
            )
        pane.set(xlabel="distance [cm]", title=f"{name}, {len(table)} placements", ylim=(-70, 70))
    panes[0].set_ylabel("echo time less 2 d / c,\nabout the median [us]")
    for pane in panes:
        pane.legend(fontsize=8, loc="upper right")
    return figure


def walks(real: pd.DataFrame, bench: pd.DataFrame) -> Figure:
    """Delay against the distance."""
    figure, ax = plt.subplots(figsize=(7.5, 4.4), layout="constrained")
    for record, name, color in (
        (real, "desk-hcsr04, four long sessions", "C0"),
        (bench, "bench, threshold that sinks", "C3"),
    ):
        table = anchors.walk(record)
        ax.errorbar(
            table.index, table["mean"], 2 * table["error"], fmt="o-", capsize=3, color=color, label=name
        )
    far = np.linspace(0.2, 1.5, 300)
    fixed = Sensor().but(raised=0.0, blanking=1.2e-3)
    delay = 1e6 * (
        measure(Scene(far, louder=np.full(300, 1.0)), fixed, np.random.default_rng(SEED)).delay - fixed.zero
    )
    ax.plot(far, delay, ".", ms=3, color="C1", label="bench, one threshold at all times")
    for slope, name, style in (
        (48.0, "kb-hcsr04, Raspberry Pi: +48 us/m", "--"),
        (-37.0, "kb-hcsr04, Arduino: -17 to -59 us/m", ":"),
    ):
        ax.plot([0.3, 1.5], np.array([0.3, 1.5]) * slope - 40.0, style, color="0.5", lw=1.2, label=name)
    ax.set(xlabel="distance [m]", ylabel="echo time less 2 d / c [us]", xlim=(0, 1.6))
    ax.legend(fontsize=8)
    return figure


def amplitudes() -> Figure:
    """Far-field amplitude, and where small targets are lost."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    far = np.geomspace(0.2, 5.0, 400)
    for target, name, color, lost in (
        (Target(half_width=3.0, half_height=3.0), "wall", "C0", None),
        (RULE, "steel rule, 25 mm wide", "C1", (2.15, 2.45)),
        (PLATE, "plate, 33 x 38 mm", "C2", (1.52, 1.85)),
    ):
        scene = Scene(far, temperature=16.5, relative_humidity=0.32, target=target)
        signal = received(scene, Sensor())
        left.plot(far, np.abs(signal.sizes[:, 1]) * signal.response.peak / 1.05, color=color, label=name)
        if lost:
            left.axvspan(
                *lost, color=color, alpha=0.2, lw=0, label=f"was lost between {lost[0]} and {lost[1]} m"
            )
    at = far / scene.speed(40e3) * 2
    left.plot(far, Sensor().comparator.at(at), "k", lw=1.2, label="threshold")
    left.plot(far, 0.25 / far, ":", color="0.5", label="1 / d alone")
    left.set(
        xscale="log",
        yscale="log",
        xlabel="distance [m]",
        ylabel="peak of the echo [units of a wall at 1 m]",
        ylim=(1e-3, 3),
    )
    left.legend(fontsize=7, loc="lower left")
    draws = np.random.default_rng(SEED)
    places = np.linspace(0.15, 2.6, 25)
    right.plot(
        places, [anchors.angle_of_an_edge(place, draws) for place in places], ".-", color="C3", label="bench"
    )
    right.plot(list(PANEL), list(PANEL.values()), "o", color="C0", label="measured by G. Dyrkacz")
    right.set(
        xlabel="distance [m]",
        ylabel="edge of a parallel panel\nis told up to [degree off the axis]",
        ylim=(0, 30),
    )
    right.legend(fontsize=8)
    return figure


def table(real: pd.DataFrame, bench: pd.DataFrame, boxes: pd.DataFrame) -> str:
    """Numbers of both, side by side."""
    rows: list[tuple[str, str, str, str]] = []
    ours, theirs = anchors.shares(bench), anchors.shares(real)
    for a, b in zip(theirs.itertuples(), ours.itertuples(), strict=True):
        name = f"share off the main cycle, {100 * a._1:.0f} to {100 * a.to:.0f} cm"
        rows.append((name, f"{a.share:.3f} +- {a.error:.3f}", f"{b.share:.3f} +- {b.error:.3f}", ""))
    (mine, error, _), (real_step, real_error, _) = anchors.spacing(bench), anchors.spacing(real)
    rows.append(("one cycle [us]", f"{real_step:.2f} +- {real_error:.2f}", f"{mine:.2f} +- {error:.2f}", ""))
    _, left = anchors.branches(real)
    _, right = anchors.branches(bench)
    rows.append(
        ("placements on the other cycle, 4 to 20 cm", f"{left['other']:.2f}", f"{right['other']:.2f}", "")
    )
    rows.append(
        (
            "a cycle from the placement before",
            f"{anchors.neighbors(real):.2f}",
            f"{anchors.neighbors(bench):.2f}",
            "",
        )
    )
    for where, a, b in zip(
        ("below 10 cm", "10 to 40 cm", "beyond"), anchors.scatter(real), anchors.scatter(bench), strict=True
    ):
        rows.append((f"scatter within a cycle, {where} [us]", f"{a:.2f}", f"{b:.2f}", ""))
    a, b = anchors.walk(real), anchors.walk(bench)
    for far in anchors.WALK:
        rows.append(
            (
                f"echo time less 2 d / c at {100 * far:.0f} cm [us]",
                f"{a['mean'][far]:.0f} +- {a['error'][far]:.0f}",
                f"{b['mean'][far]:.0f} +- {b['error'][far]:.0f}",
                "",
            )
        )
    return "\n".join("| " + " | ".join(row[:3]) + " |" for row in rows)


if __name__ == "__main__":
    if not (SHARED / "desk-hcsr04").is_dir():
        sys.exit(f"the real records are absent: no folder {SHARED} (set ECHOCAL_SHARED); nothing is written")
    real, boxes = anchors.desk(SHARED), anchors.boxes(SHARED)
    bench = anchors.desk_on_the_bench(np.random.default_rng(SEED), times=TIMES)
    print(table(real, bench, boxes))
