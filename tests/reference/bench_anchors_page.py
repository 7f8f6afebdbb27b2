"""Write the section "Beside real records" of docs/virtual-bench.md, and its figures.

python tests/reference/bench_anchors_page.py --write

The records are in the folder `shared/data` beside the repository, or in that of ECHOCAL_SHARED. They are no
part of it; the page and the figures show numbers that are derived from them.
"""

import os
import re
import sys
from pathlib import Path

import bench_anchors as anchors
import bench_anchors_figures as figures
import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "virtual-bench.md"
SHARED = Path(os.environ.get("ECHOCAL_SHARED", ROOT.parent / "shared")) / "data"
SEED, TIMES = 20210225, 4  # of the campaign on the bench, which is as many times as large

Row = tuple[str, str, str, str]


def rows(real: pd.DataFrame, bench: pd.DataFrame) -> list[Row]:
    """Numbers of the record, of the bench, and the difference, by the same functions."""
    (real_step, real_error, _), (step, error, _) = anchors.spacing(real), anchors.spacing(bench)
    (_, left), (_, right) = anchors.branches(real), anchors.branches(bench)
    return [
        *_shares(real, bench),
        _with_errors("one cycle [µs]", (real_step, real_error), (step, error), ".1f"),
        _plain("placements on the second most frequent cycle, 4 to 20 cm", left["other"], right["other"]),
        _plain(
            "placements a cycle from the one before, same distance",
            anchors.neighbors(real),
            anchors.neighbors(bench),
        ),
        _plain("scatter of placements on one cycle, 4 to 20 cm [µs]", left["rest"], right["rest"]),
        *_scatter(real, bench),
        *_walk(real, bench),
    ]


def _shares(real: pd.DataFrame, bench: pd.DataFrame) -> list[Row]:
    found = []
    pairs = zip(anchors.shares(real).itertuples(), anchors.shares(bench).itertuples(), strict=True)
    for theirs, ours in pairs:
        name = f"share off the main cycle, {100 * theirs.low:.0f} to {100 * theirs.high:.0f} cm"
        found.append(_with_errors(name, (theirs.share, theirs.error), (ours.share, ours.error), ".3f"))
    return found


def _scatter(real: pd.DataFrame, bench: pd.DataFrame) -> list[Row]:
    places = ("below 10 cm", "10 to 40 cm", "beyond 40 cm")
    pairs = zip(places, anchors.scatter(real), anchors.scatter(bench), strict=True)
    return [_plain(f"scatter within a cycle, {place} [µs]", *pair) for place, *pair in pairs]


def _walk(real: pd.DataFrame, bench: pd.DataFrame) -> list[Row]:
    theirs, ours = anchors.walk(real), anchors.walk(bench)
    found = []
    for far in anchors.WALK:
        name = f"echo time less 2 d / c at {100 * far:.0f} cm [µs]"
        pairs = [(table["mean"][far], table["error"][far]) for table in (theirs, ours)]
        found.append(_with_errors(name, *pairs, ".0f"))
    return found


def _plain(name: str, real: float, bench: float) -> Row:
    return name, f"{real:.2f}", f"{bench:.2f}", f"{bench - real:+.2f}"


def _with_errors(name: str, real: tuple[float, float], bench: tuple[float, float], form: str) -> Row:
    told = [f"{value:{form}} ± {error:{form}}" for value, error in (real, bench)]
    return name, *told, f"{bench[0] - real[0]:+{form}}"


def losses(random: np.random.Generator) -> list[Row]:
    """Where small targets are lost."""
    far = np.arange(0.4, 4.01, 0.05)
    return [
        (name, told, f"{anchors.reach(target, far, random):.2f}", "")
        for name, target, told in (
            ("plate of 33 x 38 mm is detected up to [m]", figures.PLATE, "1.52 to 1.85"),
            ("steel rule of 25 mm is detected up to [m]", figures.RULE, "2.15 to 2.45"),
        )
    ]


def panel(random: np.random.Generator) -> pd.Series:
    """Angle off the axis up to which the edge of a parallel panel is detected [degree], by distance [m]."""
    far = np.union1d(np.linspace(0.15, 2.6, 25), list(figures.PANEL)).round(3)
    return pd.Series({place: anchors.angle_of_an_edge(place, random) for place in far})


def section(real: pd.DataFrame, bench: pd.DataFrame, angles: pd.Series, random: np.random.Generator) -> str:
    """The table of the page."""
    found = [*rows(real, bench), *losses(random)]
    for far, angle in figures.PANEL.items():
        name = f"edge of a parallel panel at {100 * far:.0f} cm is detected up to [degree]"
        found.append((name, f"{angle:.0f}", f"{angles[far]:.0f}", f"{angles[far] - angle:+.0f}"))
    head = "| | record | bench | difference |\n|---|---:|---:|---:|\n"
    return head + "".join(f"| {' | '.join(row)} |\n" for row in found)


def main() -> None:
    """Make the table; with --write also the page and its figures."""
    if not (SHARED / "desk-hcsr04").is_dir():
        sys.exit(f"the real records are absent: no folder {SHARED} (set ECHOCAL_SHARED); nothing is written")
    random = np.random.default_rng(SEED)
    real, boxes = anchors.desk(SHARED), anchors.boxes(SHARED)
    bench = anchors.desk_on_the_bench(random, times=TIMES)
    angles = panel(random)
    text = section(real, bench, angles, random)
    print(text)
    if "--write" not in sys.argv:
        return
    marked = re.compile(r"(<!-- anchors -->\n).*?(<!-- /anchors -->)", flags=re.DOTALL)
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(marked.sub(lambda m: f"{m[1]}\n{text}\n{m[2]}", page), encoding="utf-8")
    for name, figure in (
        ("slips", figures.slips(real, bench, boxes)),
        ("staircase", figures.staircase(real, bench)),
        ("walk", figures.walks(real, bench)),
        ("amplitude", figures.amplitudes(angles)),
    ):
        figure.savefig(PAGE.with_name(f"virtual-bench-{name}.png"), dpi=110)


if __name__ == "__main__":
    main()
