"""The part of the benchmark's page that stands equation-made, bench-made and real tables side by side."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

from hidden_effects.bench.answers import OUTCOMES
from hidden_effects.bench.summary import ROWS
from hidden_effects.bench.words import AFTER, FIGURES, HEAD, REASONS, WHY
from hidden_effects.bench.world import LOGS, PLACEMENTS

Summary = dict[str, Any]


def beside(s: Summary) -> Iterator[str]:
    """Markdown of a summary."""
    yield HEAD
    yield from _facts(s)
    yield FIGURES
    yield "### Placements with a known distance\n"
    yield from _side_by_side(s, PLACEMENTS, "b", "placements")
    yield "### Logs\n"
    yield from _side_by_side(s, LOGS, "c", "log")
    yield "![Naming, false alarms, names and gain by design](diagnosis-benchmark-bench.png)\n"
    yield AFTER.format(**_numbers(s))
    yield "### What is answered\n\nBy stratum, and single causes by design; tables with visible causes.\n"
    yield from _outcomes(s)
    yield "### By cause on the bench\n"
    yield from _causes(s)
    yield REASONS
    yield "### Probabilities on the bench\n"
    yield from _probabilities(s)
    yield "### Sizes on the bench\n"
    yield from _sizes(s)
    if s["errors"] or s["refused"]:
        yield "### Refused tables\n"
        refused = {**s["refused"], **s["errors"]}
        yield from table(["message", "tables"], [[text, str(n)] for text, n in refused.items()])


def _facts(s: Summary) -> Iterator[str]:
    made = s.get("equations") or {"tables": {}, "seed": None}
    tables, equations = ((", ".join(f"{d} {n}" for d, n in t["tables"].items())) for t in (s, made))
    marginal, count = sum(s["marginal"].values()), sum(s["tables"].values())
    real = s["real"]["tables"]
    seeds = ", ".join(str(seed) for seed in s["seeds"])
    yield f"- Bench-made: {count} tables ({tables}), seed {seeds}; {marginal} of them marginal."
    yield f"- Equation-made: {equations} tables, seed {made['seed']}, those above, counted as here."
    yield f"- Real: {len(real['placements'])} tables with placements, {len(real['log'])} logs.\n"


def figure(of: Summary | None) -> str:
    """A figure for a table."""
    if of is None:
        return "-"
    return f"{of['value']:.2f} ({of['low']:.2f} to {of['high']:.2f}; {of['count']})"


def table(head: list[str], rows: list[list[str]]) -> Iterator[str]:
    """Markdown of a table."""
    yield "| " + " | ".join(head) + " |"
    yield "|---" * len(head) + "|"
    yield from ("| " + " | ".join(row) + " |" for row in rows)
    yield ""


def _side_by_side(s: Summary, designs: tuple[str, ...], made: str, real: str) -> Iterator[str]:
    """A row a figure; equation-made, each design of the bench, real."""
    equations = (s.get("equations") or {"figures": {}})["figures"]
    rows = []
    for name in ROWS:
        cells = [s["figures"][name].get(d) for d in designs]
        beside_it = [equations.get(name, {}).get(made), *cells, s["real"]["figures"].get(name, {}).get(real)]
        rows.append([name, *map(figure, beside_it)])
    yield from table(["figure", f"equations, {made}", *(f"`{d}`" for d in designs), "real"], rows)


def _numbers(s: Summary) -> dict[str, Any]:
    """Numbers that the sentences of the page quote."""
    best = {name: of for name, of in s["all"].items() if of}

    def value(name: str) -> str:
        return f"{best[name]['value']:.2f}" if name in best else "-"

    nulls = s["null_names"]["ideal"]
    names = ", ".join(f"`{id_}` {n}" for id_, n in sorted(nulls.items(), key=lambda x: -x[1])[:6])
    marginal = ", ".join(f"{said} {n}" for said, n in sorted(s["marginal_outcomes"].items()))
    return {
        "named_ideal": value("one cause: named, ideal detector"),
        "named_comparator": value("one cause: named, comparator"),
        "alarms_ideal": value("false alarms, ideal detector"),
        "alarms_comparator": value("false alarms, comparator"),
        "right": value("names above 0.9 that are right"),
        "told": value("share removed as told, ideal detector"),
        "fresh": value("share removed in another campaign, ideal detector"),
        "told_comparator": value("share removed as told, comparator"),
        "fresh_comparator": value("share removed in another campaign, comparator"),
        "z": value("sizes: rms of z"),
        "null_names": names or "none",
        "marginal": marginal,
        "seconds": ", ".join(f"`{d}` {t} s" for d, t in s["seconds"].items()),
        **{f"transfer_{key}": of for key, of in s["real"]["transfer"].items()},
    }


def _outcomes(s: Summary) -> Iterator[str]:
    """Counts by stratum over all designs, and of single causes by design."""
    columns = [*OUTCOMES, "refused"]
    for key, some in (
        ("stratum", s["outcomes"]),
        ("design", [r for r in s["outcomes"] if r["stratum"] == "single"]),
    ):
        counts: dict[tuple[str, str], Counter[str]] = {}
        for r in some:
            counts.setdefault((r[key], r["detector"]), Counter()).update({c: r.get(c, 0) for c in columns})
        rows = [
            [f"`{name}`", detector, *(str(n[c]) for c in columns)] for (name, detector), n in counts.items()
        ]
        yield from table([key, "detector", *columns], rows)


def _causes(s: Summary) -> Iterator[str]:
    yield (
        "Tables with this cause alone, without the marginal ones. Right: `named`, with or without a wrong\n"
        "name beside it; for a cause outside the catalogue: `unknown` without a confident wrong name.\n"
        "Always there: tables in which the name, or its class, would be true without the cause, too.\n"
    )
    rows = []
    for id_, r in s["by_cause"].items():
        wrong = ", ".join(f"`{name}` {n}" for name, n in r["wrong"].items()) or "-"
        parts = ["-" if of is None else f"{of[0]} of {of[1]}" for of in (r["ideal"], r["comparator"])]
        held, silent = (r["outcomes"].get(key, 0) for key in ("ambiguous", "silent"))
        counts = [str(n) for n in (held, silent, r["always"], r["marginal"])]
        why = WHY.get(id_, "-") if _missed(r) else "-"
        rows.append([f"`{id_}`", *parts, *counts, wrong, why])
    head = [
        "cause",
        "right, ideal detector",
        "right, comparator",
        "held",
        "silent",
        "always there",
        "marginal",
    ]
    yield from table([*head, "confident wrong names", "why it is missed"], rows)


def _missed(cause: Summary) -> bool:
    """Whether a cause was missed in any table."""
    return any(of is not None and of[0] < of[1] for of in (cause["ideal"], cause["comparator"]))


def _probabilities(s: Summary) -> Iterator[str]:
    yield "The most probable set, without a cause and with one: mean probability, and the part that is true\n"
    rows = [
        [detector, f"{p:.2f}", f"{right:.2f}", str(count)]
        for detector, points in s["reliability"].items()
        for p, right, count in points
    ]
    yield from table(["detector", "probability", "true", "tables"], rows)


def _sizes(s: Summary) -> Iterator[str]:
    yield "With the ideal detector, where the planted cause is named by its own name.\n"
    rows = [[f"`{id_}`", f"{z[0]:g}", f"{z[1]:g}", f"{z[2]:g}"] for id_, z in s["z"].items()]
    yield from table(["cause", "median of abs(z)", "largest", "sizes"], rows)
