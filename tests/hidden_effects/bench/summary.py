"""All records of a run on the bench as one small document that the page is made from."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from hidden_effects.bench.answers import OUTCOMES, is_sure
from hidden_effects.score import NONE, Figure, Record, beyond_chance, part, reliability, resampled

SCHEMA = "echocal.bench-benchmark/1"

DETECTORS = ("ideal", "comparator")
_FEWEST = 5  # sizes with a z-score, for a root mean square
_WORST = 3  # wrong names that the table of causes lists

Measure = Callable[[Sequence[Record]], Figure]


def visible(records: Sequence[Record], *strata: str, detector: str | None = None) -> list[Record]:
    """Answered tables of some strata whose causes can be detected, by what measured them."""
    return [
        r
        for r in records
        if r["stratum"] in strata
        and "outcome" in r
        and not r["marginal"]
        and detector in (None, r["measured_by"])
    ]


def _named(r: Record) -> bool:
    return bool(r["outcome"] in OUTCOMES[:2])


def _wrong(r: Record) -> bool:
    return bool(r["confident_wrong"])


def _outcomes(stratum: str, detector: str, of: Callable[[Record], bool]) -> Measure:
    """Part of the tables; of what is in every table anyway, a name says nothing."""
    return lambda records: part(
        [r for r in visible(records, stratum, detector=detector) if not r["always"]], of
    )


def sure_names(records: Sequence[Record]) -> list[Record]:
    """Effects that were named with more than 0.9: all but those that are always there."""
    return [
        n
        for r in visible(records, "null", "single", "pair", "mistake")
        for n in r["named"]
        if n["kind"] == "effect" and is_sure(n) and n["status"] != "companion"
    ]


def removed(pair: Sequence[float]) -> float:
    """Part of the mean square that a model removes."""
    before, after = pair
    return 1 - (after / before) ** 2


def _gained(which: str, detector: str) -> Measure:
    def measure(records: Sequence[Record]) -> Figure:
        cases = [r for r in _corrected(records) if r[which][0] > 0 and r["measured_by"] == detector]
        return (
            resampled(cases, lambda rs: float(np.median([removed(r[which]) for r in rs]))) if cases else NONE
        )

    return measure


def _corrected(records: Sequence[Record]) -> list[Record]:
    """Tables with one or two visible causes, and an effect in the model."""
    return [
        r
        for r in visible(records, "single", "pair")
        if r["told"] and r["fresh"] and any(n["kind"] == "effect" for n in r["named"])
    ]


def _worse(records: Sequence[Record]) -> Figure:
    return part(_corrected(records), lambda r: r["fresh"][1] > r["fresh"][0])


def _z(records: Sequence[Record]) -> Figure:
    scores = [z for r in visible(records, "single", "mistake", detector="ideal") for z in r["z"].values()]
    if len(scores) < _FEWEST:
        return NONE
    held = [{"z": z} for z in scores]
    return resampled(held, lambda rs: float(np.sqrt(np.mean([r["z"] ** 2 for r in rs]))))


def _of_means(stratum: str, of: Callable[[Record], bool]) -> Measure:
    """Part of the tables with the ideal detector, asked about with one row for each placement."""

    def measure(records: Sequence[Record]) -> Figure:
        tables = [r for r in visible(records, stratum, detector="ideal") if not r["always"]]
        return part([r["means"] for r in tables if "outcome" in r.get("means", {})], of)

    return measure


ROWS: dict[str, Measure] = {
    "false alarms, ideal detector": _outcomes("null", "ideal", lambda r: r["alarm"]),
    "false alarms, comparator": _outcomes("null", "comparator", lambda r: r["alarm"]),
    "unexplained term without a cause, ideal detector": _outcomes(
        "null", "ideal", lambda r: r["says_unknown"]
    ),
    "one cause: named, ideal detector": _outcomes("single", "ideal", _named),
    "one cause: named, comparator": _outcomes("single", "comparator", _named),
    "one cause: named or held, ideal detector": _outcomes(
        "single", "ideal", lambda r: r["outcome"] in OUTCOMES[:3]
    ),
    "one cause: named or held, comparator": _outcomes(
        "single", "comparator", lambda r: r["outcome"] in OUTCOMES[:3]
    ),
    "one cause: a confident wrong name, ideal detector": _outcomes("single", "ideal", _wrong),
    "one cause: a confident wrong name, comparator": _outcomes("single", "comparator", _wrong),
    "a row a placement, ideal detector: false alarms": _of_means("null", lambda r: r["alarm"]),
    "a row a placement, ideal detector: unexplained term without a cause": _of_means(
        "null", lambda r: r["says_unknown"]
    ),
    "a row a placement, ideal detector: one cause named": _of_means("single", _named),
    "a row a placement, ideal detector: a confident wrong name": _of_means("single", _wrong),
    "two causes: both named": lambda rs: part([r for r in visible(rs, "pair") if not r["always"]], _named),
    "mistake: named": lambda rs: part(visible(rs, "mistake"), _named),
    "outside the catalogue: called unknown": lambda rs: part(
        visible(rs, "unknown"), lambda r: r["says_unknown"] and not _wrong(r)
    ),
    "names above 0.9 that are right": lambda rs: part(sure_names(rs), lambda n: n["status"] != "wrong"),
    "ECE of the first set": lambda rs: beyond_chance(visible(rs, "null", "single")),
    "share removed as told, ideal detector": _gained("told", "ideal"),
    "share removed in another campaign, ideal detector": _gained("fresh", "ideal"),
    "share removed as told, comparator": _gained("told", "comparator"),
    "share removed in another campaign, comparator": _gained("fresh", "comparator"),
    "worse on another campaign": _worse,
    "sizes: rms of z": _z,
}
"""What is measured on the tables of a design."""


def rounded(figure: Figure) -> dict[str, Any] | None:
    """Four digits; None for no cases, which JSON can hold."""
    return {k: round(v, 4) for k, v in asdict(figure).items()} if figure.count else None


def summarize(records: Sequence[Record]) -> dict[str, Any]:
    """Figures, tables and curves of a run."""
    records = sorted(records, key=lambda r: (r["design"], r["stratum"], r["seed"]))
    designs = list(dict.fromkeys(r["design"] for r in records))
    by_design = {d: [r for r in records if r["design"] == d] for d in designs}
    return {
        "schema": SCHEMA,
        "seeds": sorted({r.get("run", 0) for r in records}),
        "tables": {d: len(rs) for d, rs in by_design.items()},
        "marginal": {d: sum(r["marginal"] for r in rs) for d, rs in by_design.items()},
        "seconds": {d: round(float(np.median([r["seconds"] for r in rs])), 2) for d, rs in by_design.items()},
        "figures": {
            name: {d: rounded(measure(rs)) for d, rs in by_design.items()} for name, measure in ROWS.items()
        },
        "all": {name: rounded(measure(records)) for name, measure in ROWS.items()},
        "outcomes": _counts(by_design),
        "marginal_outcomes": dict(Counter(_said(r) for r in records if r["marginal"])),
        "by_cause": _by_cause(records),
        "null_names": _null_names(records),
        "reliability": {
            detector: reliability(of) if (of := visible(records, "null", "single", detector=detector)) else []
            for detector in DETECTORS
        },
        "z": _sizes(records),
        "refused": dict(Counter(r["refused"][:160] for r in records if "refused" in r)),
        "errors": dict(Counter(r["error"][:160] for r in records if "error" in r)),
    }


def _said(r: Record) -> str:
    return str(r.get("outcome", "refused"))


def _counts(by_design: dict[str, list[Record]]) -> list[dict[str, Any]]:
    """Outcomes by design, stratum and detector."""
    rows = []
    for design, records in by_design.items():
        for stratum in ("null", "single", "pair", "mistake", "unknown"):
            for detector in DETECTORS:
                some = visible(records, stratum, detector=detector)
                if some:
                    counts = Counter(_said(r) for r in some)
                    rows.append({"design": design, "stratum": stratum, "detector": detector, **counts})
    return rows


def _by_cause(records: Sequence[Record]) -> dict[str, dict[str, Any]]:
    """Outcomes of each cause where it is alone, and the wrong names that it gets most."""
    rows: dict[str, dict[str, Any]] = {}
    alone = [r for r in records if len(r["causes"]) == 1]
    for id_ in sorted({r["causes"][0] for r in alone}):
        same = [r for r in alone if r["causes"] == [id_]]
        seen = [r for r in same if not r["marginal"]]
        wrong = Counter(name for r in seen for name in r.get("confident_wrong", []))
        rows[id_] = {
            "stratum": same[0]["stratum"],
            "always": sum(bool(r["always"]) for r in seen),
            "tables": len(seen),
            "marginal": len(same) - len(seen),
            "outcomes": dict(Counter(_said(r) for r in seen)),
            "ideal": [sum(map(_right, of)), len(of)] if (of := _by(seen, "ideal")) else None,
            "comparator": [sum(map(_right, of)), len(of)] if (of := _by(seen, "comparator")) else None,
            "wrong": dict(wrong.most_common(_WORST)),
        }
    return rows


def _by(records: Sequence[Record], detector: str) -> list[Record]:
    return [r for r in records if r["measured_by"] == detector]


def _right(r: Record) -> bool:
    """Whether the answer is what can be asked for: the name, or `unknown` for what the catalogue lacks."""
    if r["stratum"] == "unknown":
        return bool(r.get("says_unknown") and not r["confident_wrong"])
    return _said(r) in OUTCOMES[:2]


def _null_names(records: Sequence[Record]) -> dict[str, dict[str, int]]:
    """Wrong effects that were named without a cause, by detector."""
    return {
        detector: dict(
            Counter(
                n["id"]
                for r in visible(records, "null", detector=detector)
                for n in r["named"]
                if n["status"] == "wrong"
            )
        )
        for detector in DETECTORS
    }


def _sizes(records: Sequence[Record]) -> dict[str, list[float]]:
    """Median and largest |z| and the number of sizes, by cause, with the ideal detector."""
    found: dict[str, list[float]] = {}
    for r in visible(records, "single", "pair", "mistake", detector="ideal"):
        for id_, z in r["z"].items():
            found.setdefault(id_, []).append(abs(z))
    return {
        id_: [round(float(np.median(z)), 2), round(max(z), 2), len(z)] for id_, z in sorted(found.items())
    }
