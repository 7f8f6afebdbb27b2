"""Figures of equation-made tables, counted as those of the bench, from records of `benches/diagnosis.py`."""

from collections.abc import Sequence
from typing import Any

import numpy as np

import echocal
from hidden_effects.bench.strength import DETECTABLE
from hidden_effects.bench.summary import removed, rounded
from hidden_effects.disturbance import SHOT
from hidden_effects.score import NONE, Figure, Record, beyond_chance, part, resampled

_SURE = 0.9
_EFFECTS = frozenset(effect.id for effect in echocal.effects())


def equations(outcome: dict[str, Any]) -> dict[str, Any]:
    """Figures of each design, under the names of `summary.ROWS`."""
    records = [r for r in outcome["records"] if "error" not in r]
    designs = sorted({r["design"] for r in records})
    by_design = {d: [r for r in records if r["design"] == d] for d in designs}
    found = {d: _figures(rs) for d, rs in by_design.items()}
    names = found[designs[0]]
    return {
        "seed": outcome["seed"],
        "tables": {d: len(rs) for d, rs in by_design.items()},
        "figures": {name: {d: rounded(found[d][name]) for d in designs} for name in names},
    }


def _figures(records: Sequence[Record]) -> dict[str, Figure]:
    nulls, singles = _of(records, "null"), _visible(records, "prior", "wild", "power8")
    pairs, faults = _visible(records, "pair"), _of(records, "other")
    unknown = _visible(records, "unknown")
    corrected = [r for r in [*singles, *pairs] if "same" in r and r["reported"] and r["told"] is not None]
    names = [n for r in [*nulls, *singles, *pairs] for n in _sure(r)]
    return {
        "false alarms, ideal detector": part(nulls, lambda r: bool(_effects(r))),
        "unexplained term without a cause, ideal detector": part(nulls, lambda r: r["says_unknown"]),
        "one cause: named, ideal detector": part(singles, _named),
        "one cause: named or held, ideal detector": part(singles, lambda r: bool(r["told"])),
        "one cause: a confident wrong name, ideal detector": part(
            singles, lambda r: bool(r["confident_wrong"])
        ),
        "two causes: both named": part(pairs, _named),
        "mistake: named": part(faults, _named),
        "outside the catalogue: called unknown": part(
            unknown, lambda r: r["says_unknown"] and not r["confident_wrong"]
        ),
        "names above 0.9 that are right": part(names, lambda n: n["right"]),
        "ECE of the first set": beyond_chance(_of(records, "null", "prior", "wild")),
        "share removed as told, ideal detector": _median(corrected, lambda r: removed(r["reported"])),
        "share removed in another campaign, ideal detector": _median(corrected, _fresh),
        "worse on another campaign": part(corrected, lambda r: _fresh(r) < 0),
    }


def _of(records: Sequence[Record], *strata: str) -> list[Record]:
    return [r for r in records if r["stratum"] in strata]


def _visible(records: Sequence[Record], *strata: str) -> list[Record]:
    return [r for r in _of(records, *strata) if r["snr"] * np.sqrt(r["rows"]) >= DETECTABLE]


def _effects(r: Record) -> list[str]:
    return [id_ for id_ in r["named"] if id_ in _EFFECTS]


def _sure(r: Record) -> list[dict[str, bool]]:
    """Effects named with more than 0.9; a wrong one is in the list of confident wrong names."""
    wrong = {id_ for id_, _ in r["confident_wrong"]}
    return [{"right": id_ not in wrong} for id_ in _effects(r) if r["named"][id_] > _SURE]


def _named(r: Record) -> bool:
    """Whether each planted cause, or one of its class, is named with more than 0.9."""
    hits, _, planted = r["sure_counts"]
    return bool(hits == planted)


def _fresh(r: Record) -> float:
    """Share removed of new readings under the same conditions, which have the noise of single readings."""
    before, after = (square + SHOT**2 for square in r["same"])
    return float(1 - after / before)


def _median(records: Sequence[Record], of: Any) -> Figure:
    return resampled(records, lambda rs: float(np.median([of(r) for r in rs]))) if records else NONE
