"""The fleet in short: plain data of schema ``echocal.fleet/1``."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from echocal._core import __version__
from echocal.diagnose.settings import Settings
from echocal.fleet.judge import Judged, false_discoveries
from echocal.fleet.together import together

__all__ = ["SCHEMA", "summary"]

SCHEMA = "echocal.fleet/1"

_WORST = 10  # sensors that are listed
_SHOWN = 0.5  # sensors, expected ones, from which on a cause is listed


def summary(
    rows: Sequence[Mapping[str, Any]], found: Judged, settings: Settings, notes: Sequence[str], seconds: float
) -> dict[str, Any]:
    """Count verdicts and causes, and list the worst sensors and those that failed.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of the table of verdicts.
    found : Judged
    settings : Settings
    notes : sequence of str
    seconds : float
        That the run took [s].
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
