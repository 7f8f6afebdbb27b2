"""All records of a run as one small document that the page is made from."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from hidden_effects.causes import CAUSES
from hidden_effects.score import Record, part, reliability
from hidden_effects.targets import SINGLES, TARGETS, of, verdict

SCHEMA = "echocal.diagnosis-benchmark/1"
_WORST = 25  # confident wrong names that the page lists


def summarize(records: Sequence[Record], engine: Collection[str], seed: int) -> dict[str, Any]:
    """Figures, lists and curves of a run."""
    designs = sorted({r["design"] for r in records})
    by_design = {d: [r for r in records if r["design"] == d] for d in designs}
    answered = [r for r in records if "error" not in r]
    return {
        "schema": SCHEMA,
        "seed": seed,
        "cases": {d: len(rs) for d, rs in by_design.items()},
        "engine": sorted(engine),
        "missing": sorted(set(CAUSES) - set(engine)),
        "unplanted": sorted(set(engine) - set(CAUSES)),
        "targets": [_row(target, by_design) for target in TARGETS],
        "nulls": _nulls(by_design),
        "by_cause": _by_cause(answered),
        "missing_causes": _missing(records),
        "confident_wrong": _wrong(answered),
        "errors": Counter(r["error"] for r in records if "error" in r),
        "reliability": {
            d: {s: reliability(of(rs, "null", s)) for s in SINGLES} for d, rs in by_design.items()
        },
        "seconds": {d: round(float(np.median([r["seconds"] for r in rs])), 3) for d, rs in by_design.items()},
    }


def _row(target: Any, by_design: dict[str, list[Record]]) -> dict[str, Any]:
    figures = {d: target.measure(rs) for d, rs in by_design.items()}
    return {
        "name": target.name,
        "asked": {d: target.asked[d] for d in by_design},
        "figures": {d: _rounded(asdict(f)) for d, f in figures.items()},
        "verdict": {d: verdict(f, target.asked[d]) for d, f in figures.items()},
    }


def _rounded(figure: dict[str, Any]) -> dict[str, Any] | None:
    """Four digits; None for no cases, which JSON can hold."""
    return {k: round(v, 4) for k, v in figure.items()} if figure["count"] else None


def _nulls(by_design: dict[str, list[Record]]) -> dict[str, dict[str, dict[str, Any] | None]]:
    """False alarms by kind of noise."""
    kinds: dict[str, dict[str, dict[str, Any] | None]] = {}
    for design, records in by_design.items():
        for record_kind in sorted({kind(r) for r in of(records, "null")}):
            same = [r for r in of(records, "null") if kind(r) == record_kind]
            kinds.setdefault(record_kind, {})[design] = _rounded(asdict(part(same, lambda r: r["alarm"])))
    return kinds


def kind(record: Record) -> str:
    """Noise of a case, in a word."""
    return "tape error" if record["tape"] else str(record["noise"])


def _by_cause(records: Sequence[Record]) -> dict[str, dict[str, Any]]:
    """Detected, right and unknown, by cause, over all designs."""
    rows: dict[str, dict[str, Any]] = {}
    for id_ in CAUSES:
        same = [r for r in of(records, *SINGLES, "power5", "power8", "other") if tuple(r["causes"]) == (id_,)]
        found = [r for r in same if r["verdict"] != "nothing"]
        if same:
            rows[id_] = {
                "cases": len(same),
                "detected": round(len(found) / len(same), 3),
                "strict": round(float(np.mean([r["strict"] for r in found])), 3) if found else None,
                "class": round(float(np.mean([r["class"] for r in found])), 3) if found else None,
                "unknown": round(float(np.mean([r["says_unknown"] for r in same])), 3),
            }
    return rows


def _missing(records: Sequence[Record]) -> dict[str, dict[str, Any]]:
    """What the engine says to causes that it does not have: a miss each, and how it shows."""
    rows: dict[str, dict[str, Any]] = {}
    for record in records:
        if record["stratum"] != "missing":
            continue
        row = rows.setdefault(record["causes"][0], {})
        if "error" in record:
            row[record["design"]] = "refused"
            continue
        names = "+".join(record["named"]) or ("unknown" if record["says_unknown"] else record["verdict"])
        row[record["design"]] = f"{names}!" if record["confident_wrong"] else names
    return rows


def _wrong(records: Sequence[Record]) -> dict[str, Any]:
    """Confident wrong names, by design and stratum, and the worst of them."""
    wrong = [(r, *name) for r in records for name in r["confident_wrong"]]
    counts = Counter(f"{r['design']} {r['stratum']}" for r, *_ in wrong)
    cases = Counter(f"{r['design']} {r['stratum']}" for r in records)
    catalogue = [w for w in wrong if w[0]["stratum"] != "missing"]
    worst = sorted(catalogue, key=lambda w: (-w[2], -w[0]["snr"]))[:_WORST]
    return {
        "counts": {key: [counts[key], cases[key]] for key in sorted(counts)},
        "worst": [
            {
                "design": r["design"],
                "stratum": r["stratum"],
                "planted": list(r["causes"]),
                "noise": kind(r),
                "snr": round(r["snr"], 2),
                "named": id_,
                "probability": round(p, 4),
                "seed": r["seed"],
            }
            for r, id_, p in worst
        ],
    }
