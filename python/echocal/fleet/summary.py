"""The fleet in short: plain data of schema ``echocal.fleet/1``."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import combinations
from math import comb
from statistics import median
from typing import Any

from echocal._core import __version__
from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.threshold import PROBABLE
from echocal.fleet.prevalence import Judged, false_discoveries

SCHEMA = "echocal.fleet/1"

_WORST = 10  # sensors that are listed
_SHOWN = 0.5  # sensors, expected ones, from which on a cause is listed


def summary(
    rows: Sequence[Mapping[str, Any]], found: Judged, settings: Settings, notes: Sequence[str], seconds: float
) -> dict[str, Any]:
    """Count verdicts and causes, and list the worst sensors and those that failed.

    `seconds` is the time that the run took.
    """
    measured = [one for one in rows if one["rms_before_mm"] is not None]
    return {
        "schema": SCHEMA,
        "version": __version__,
        "sensors": len(rows),
        "verdicts": dict(Counter(one["verdict"] for one in rows)),
        "fleet_verdicts": dict(Counter(one["fleet_verdict"] for one in rows)),
        "rows": {
            "total": sum(one["rows"] or 0 for one in rows),
            "used": sum(one["rows_used"] or 0 for one in rows),
            "repeated": sum(one["rows_repeated"] for one in rows),
        },
        "causes": _causes(rows, settings.claims.named),
        "kinds": {
            kind: {
                "sensors": len(one.posteriors),
                "causes": [
                    {
                        "id": cause,
                        "share": share,
                        "standard_uncertainty": one.uncertainty[cause],
                        "prior": one.prior[cause],
                    }
                    for cause, share in sorted(one.share.items(), key=lambda item: -item[1])
                    if share * len(one.posteriors) >= _SHOWN
                ],
            }
            for kind, one in found.kinds.items()
        },
        "false_discoveries": false_discoveries(
            found.names, settings.claims.named, settings.fleet.false_discovery_rate
        ),
        "together": together(rows, settings),
        "rms_mm": {
            "before": _median([one["rms_before_mm"] for one in measured]),
            "after": _median([one["rms_after_mm"] for one in measured]),
        },
        "worst": [
            {name: one[name] for name in ("sensor", "verdict", "cause", "rms_before_mm", "rms_after_mm")}
            for one in sorted(measured, key=lambda one: -one["rms_before_mm"])[:_WORST]
        ],
        "failed": [
            {"sensor": one["sensor"], "reason": one["reason"]} for one in rows if one["verdict"] == "failed"
        ],
        "notes": list(notes),
        "seconds": seconds,
    }


def _causes(rows: Sequence[Mapping[str, Any]], named: float) -> list[dict[str, Any]]:
    """How many sensors each cause is claimed in, and what it costs and gains there."""
    claimed: dict[str, list[tuple[Mapping[str, Any], Mapping[str, Any]]]] = {}
    for one in rows:
        for cause in one["causes"]:
            claimed.setdefault(cause["id"], []).append((one, cause))
    listed = []
    for id_, pairs in claimed.items():
        first = [one for one, _ in pairs if one["cause"] == id_ and one["rms_before_mm"] is not None]
        sizes = [p["value"] for _, cause in pairs for p in cause["parameters"][:1]]
        listed.append(
            {
                "id": id_,
                "kind": pairs[0][1]["kind"],
                "alternatives": [
                    other
                    for other, _ in Counter(m for _, c in pairs for m in c["class"]).most_common()
                    if other != id_
                ],
                "sensors": len(pairs),
                "named": sum(
                    one["verdict"] == "named" and c["class_probability"] >= named for one, c in pairs
                ),
                "named_in_fleet": sum(
                    one["fleet_verdict"] == "named" and c["fleet_class_probability"] >= named
                    for one, c in pairs
                ),
                "first": len(first),
                "rms_before_mm": _median([one["rms_before_mm"] for one in first]),
                "rms_after_mm": _median([one["rms_after_mm"] for one in first]),
                "gained_mm": _median([one["rms_before_mm"] - one["rms_after_mm"] for one in first]),
                "size": _median(sizes),
                "unit": next((p["unit"] for _, cause in pairs for p in cause["parameters"][:1]), None),
            }
        )
    return sorted(listed, key=lambda one: (-one["sensors"], one["id"]))


def _median(values: Sequence[float]) -> float | None:
    return median(values) if values else None


def together(rows: Sequence[Mapping[str, Any]], settings: Settings) -> list[dict[str, Any]]:
    """Pairs of causes that are claimed in the same sensors, and how many such sensors chance would make.

    Fisher's exact test, divided among all pairs; the least probable pair is the first.
    """
    judged = [row for row in rows if row["verdict"] != "failed"]
    single: Counter[str] = Counter()
    pairs: Counter[tuple[str, str]] = Counter()
    for row in judged:
        claims = [
            frozenset(cause["class"]) for cause in row["causes"] if cause["class_probability"] >= PROBABLE
        ]
        single.update({id_ for claim in claims for id_ in claim})
        both = {
            (min(a, b), max(a, b))
            for one, other in combinations(claims, 2)
            for a in one - other
            for b in other - one
        }
        pairs.update(both)
    tests = comb(len(single), 2)
    found = []
    for (a, b), count in pairs.items():
        p = _at_least(count, len(judged), single[a], single[b])
        if p * tests < settings.fleet.together:
            chance = single[a] * single[b] / len(judged)
            found.append({"ids": [a, b], "sensors": count, "by_chance": chance, "p_value": p * tests})
    return sorted(found, key=lambda one: (one["p_value"], one["ids"]))


def _at_least(count: int, total: int, first: int, second: int) -> float:
    """Probability that chance puts so many of `first` and `second` sensors together."""
    ways = sum(
        comb(first, both) * comb(total - first, second - both)
        for both in range(count, min(first, second) + 1)
    )
    return ways / comb(total, second)
