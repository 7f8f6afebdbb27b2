"""What the judges of `omniscient` reach, beside what the engine reached on the same cases."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from hidden_effects.aliases import label, same_class
from hidden_effects.cases import Spec, build
from hidden_effects.omniscient import detection, judge

Record = dict[str, Any]

_POWER = {"power5": 5.0, "power8": 8.0}
_ALLOWED = 0.02  # false alarms


def look(record: Record) -> Record:
    """What the judges say of a case; empty where they have nothing to say."""
    drawn = {field.name: record[field.name] for field in fields(Spec)}
    spec = Spec(**{**drawn, "causes": tuple(record["causes"])})
    case = build(spec)
    said: Record = {}
    for stratum, strength in _POWER.items():
        if spec.stratum in ("null", stratum):
            said[stratum] = {
                "knows": detection(case, strength, knows_noise=True),
                "guesses": detection(case, strength, knows_noise=False),
            }
    if spec.stratum in ("null", "prior", "wild"):
        opinion = judge(case)
        truth = label(spec.causes[0]) if spec.causes else ""
        credible = opinion.credible()
        first = max(opinion.probability, key=lambda name: opinion.probability[name])
        right = opinion.named == truth or (
            bool(spec.causes) and same_class(case, spec.causes[0], opinion.named)
        )
        said |= {"strict": first == truth, "size": len(credible), "covered": truth in credible}
        said |= {"class": right, "detected": opinion.detected}
    return said


def ceiling(records: Sequence[Record], looks: Sequence[Record]) -> list[Record]:
    """Rows of a table: figure, design, engine, judges."""
    rows = []
    for design in sorted({r["design"] for r in records}):
        pairs = [(r, s) for r, s in zip(records, looks, strict=True) if r["design"] == design and s]
        rows += [_detected(design, stratum, pairs) for stratum in _POWER]
        singles = [(r, s) for r, s in pairs if "strict" in s]
        found = [(r, s) for r, s in singles if r["causes"] and r["verdict"] != "nothing"]
        rows += [
            _row(design, "first name of the right class, where the engine detects", found, "class", "class"),
            _row(design, "strict top-1 with no effect", singles, "strict", "strict"),
            _row(design, "95 % set: coverage", singles, "covered", "covered"),
            _row(design, "95 % set: size", singles, "credible_sets", "size"),
        ]
    return rows


def _row(
    design: str, figure: str, pairs: Sequence[tuple[Record, Record]], engine: str, judged: str
) -> Record:
    return {
        "design": design,
        "figure": figure,
        "cases": len(pairs),
        "engine": round(float(np.mean([r[engine] for r, _ in pairs])), 3),
        "knows": round(float(np.mean([s[judged] for _, s in pairs])), 3),
        "guesses": None,
    }


def _detected(design: str, stratum: str, pairs: Sequence[tuple[Record, Record]]) -> Record:
    """Power at the false alarms allowed, each judge by the threshold that gives as many."""
    nulls = [(r, s) for r, s in pairs if r["stratum"] == "null"]
    strength = _POWER[stratum]
    there = [
        (r, s)
        for r, s in pairs
        if r["stratum"] == stratum and abs(r["snr"] * np.sqrt(r["rows"]) / strength - 1) < 0.05
    ]
    power = {
        judged: _power([s[stratum][judged] for _, s in nulls], [s[stratum][judged] for _, s in there])
        for judged in ("knows", "guesses")
    }
    engine = _power(
        [-r["no_effect_probability"] for r, _ in nulls], [-r["no_effect_probability"] for r, _ in there]
    )
    figure = f"power at snr sqrt(N) = {strength:.0f}, with {_ALLOWED} false alarms"
    return {"design": design, "figure": figure, "cases": len(there), "engine": engine, **power}


def _power(nulls: Sequence[float], there: Sequence[float]) -> float:
    return round(float(np.mean(np.array(there) > np.quantile(nulls, 1 - _ALLOWED))), 3)
