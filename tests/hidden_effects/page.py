"""The page of the benchmark, made from its summary alone."""

from collections.abc import Iterator
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure as Plot

Summary = dict[str, Any]

_HEAD = """# Benchmark of the diagnosis

Made by `python benches/diagnosis.py --docs`; do not edit. Cases come from `tests/hidden_effects`, a simulator
apart from the core: its own air (molecules with Einstein vibrations), echo (ring-up, threshold, missed
cycles), thermometer (lag, sun, warm board), convection and tape. Half of the single causes have sizes that
the engine's priors do not know (log-uniform in snr from 0.25 to 8), none lies on a grid. snr is the rms of
the effect over 1.5 mm of shot noise.

Design a: one distance, 26 rows, no time. b: five distances, temperature up and down, 400 rows. c: a field
log of 5000 rows. Exact aliases count as one name; a class is what the rows of the case see in one direction
(cosine of at least 0.99). Intervals are 95 %: Wilson's for parts, resampled cases for the rest.
"""


def page(summary: Summary) -> str:
    """Markdown of a summary."""
    return "\n".join([_HEAD, *_facts(summary), *_targets(summary), *_tables(summary)]) + "\n"


def _facts(s: Summary) -> Iterator[str]:
    cases = ", ".join(f"{d} {n}" for d, n in s["cases"].items())
    seconds = ", ".join(f"{d} {t} s" for d, t in s["seconds"].items())
    yield f"Seed {s['seed']}; cases: {cases}; median time of a case on a busy machine: {seconds}.\n"
    yield f"The engine knows {len(s['engine'])} causes: {', '.join(s['engine'])}."
    yield f"Of the catalogue it lacks {len(s['missing'])}: they are misses, and stand apart below.\n"
    if s["unplanted"]:
        yield f"It knows what nobody here can plant yet: {', '.join(s['unplanted'])}.\n"


def _figure(figure: Summary | None) -> str:
    if figure is None:
        return "-"
    return f"{figure['value']:.3f} ({figure['low']:.3f}-{figure['high']:.3f}), {figure['count']}"


def _asked(bounds: list[float | None]) -> str:
    low, high = bounds
    if low is not None and high is not None:
        return f"{low:g}-{high:g}"
    return f">= {low:g}" if low is not None else f"<= {high:g}" if high is not None else "-"


def _table(head: list[str], rows: list[list[str]]) -> Iterator[str]:
    yield "| " + " | ".join(head) + " |"
    yield "|---" * len(head) + "|"
    yield from ("| " + " | ".join(row) + " |" for row in rows)
    yield ""


def _targets(s: Summary) -> Iterator[str]:
    designs = list(s["cases"])
    head = ["figure"] + [f"{d}{part}" for d in designs for part in ("", " asked", "")]
    yield "## Targets\n"
    yield "Value (interval), cases; `open` where the interval still holds both answers.\n"
    rows = []
    for target in s["targets"]:
        cells = [
            cell
            for d in designs
            for cell in (_figure(target["figures"][d]), _asked(target["asked"][d]), target["verdict"][d])
        ]
        rows.append([target["name"], *cells])
    yield from _table(head, rows)
    luck = "; ".join(f"{d} {p['prior']:.3f} / {p['wild']:.3f}" for d, p in s["chance_error"].items())
    yield f"At these numbers of cases perfect probabilities show an ECE (known / unknown priors) of {luck}.\n"
    yield "![Reliability of the first name's probability](diagnosis-benchmark.png)\n"


def _tables(s: Summary) -> Iterator[str]:
    designs = list(s["cases"])
    yield "## False alarms by noise\n"
    nulls = [[kind, *(_figure(by.get(d)) for d in designs)] for kind, by in s["nulls"].items()]
    yield from _table(["noise", *designs], nulls)
    yield "## Confident wrong names\n"
    yield "Names given with more than 0.9 where neither they nor what they stand for is there.\n"
    counts = [[key, str(n), str(of)] for key, (n, of) in s["confident_wrong"]["counts"].items()]
    yield from _table(["design, cases", "wrong", "of"], counts)
    keys = ["design", "stratum", "planted", "noise", "snr", "named", "probability"]
    worst = [[_plain(w[key]) for key in keys] for w in s["confident_wrong"]["worst"]]
    yield from _table(keys, worst)
    yield "## By cause\n"
    columns = ["cases", "detected", "strict", "class", "unknown"]
    rows = [[id_, *(_plain(row[c]) for c in columns)] for id_, row in s["by_cause"].items()]
    yield from _table(["cause", *columns], rows)
    yield "## Causes that the engine lacks\n"
    yield "What it says when they are there, one case each: the causes it puts into the model, or its"
    yield "verdict; `refused`: the reader asks whether the unit is right; `!`: a confident wrong name.\n"
    lacking = [[id_, *(row.get(d, "-") for d in designs)] for id_, row in s["missing_causes"].items()]
    yield from _table(["cause", *designs], lacking)
    if s["errors"]:
        yield "## Errors instead of answers\n"
        yield from _table(["message", "times"], [[text[:160], str(n)] for text, n in s["errors"].items()])


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(value) or "nothing"
    return "-" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def reliability_plot(s: Summary) -> Plot:
    """Part of first names that are right against their probability; area by number of cases."""
    designs = list(s["reliability"])
    plot, axes = plt.subplots(1, len(designs), figsize=(3.6 * len(designs), 3.8), sharey=True, squeeze=False)
    for ax, design in zip(axes[0], designs, strict=True):
        ax.plot([0, 1], [0, 1], color="0.7", linewidth=1)
        for stratum, label, color in (("prior", "known priors", "C0"), ("wild", "unknown priors", "C1")):
            points = s["reliability"][design][stratum]
            p, right, count = zip(*points, strict=True) if points else ((), (), ())
            ax.plot(p, right, color=color, alpha=0.5)
            ax.scatter(p, right, [4 + 3 * n for n in count], color=color, alpha=0.6, label=label)
        ax.set(
            title=f"design {design}", xlabel="probability of the first name", xlim=(0, 1.05), ylim=(0, 1.05)
        )
    axes[0, 0].set_ylabel("part that is right")
    handles, names = axes[0, 0].get_legend_handles_labels()
    legend = axes[0, 0].legend(handles, names, loc="upper left", frameon=False)
    for handle in legend.legend_handles:
        handle.set_sizes([30])
    plot.tight_layout()
    return plot
