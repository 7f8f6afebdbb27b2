"""What is kept of the diagnosis of one sensor: plain data, from which the table and the fleet are made."""

from collections.abc import Mapping
from typing import Any

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.parts import Gain
from echocal.diagnose.pipeline import Examined
from echocal.diagnose.results.diagnosis import plain

__all__ = ["FAILED", "failure", "record"]

FAILED = "failed"
"""Verdict of a sensor that cannot be diagnosed."""


def record(found: Examined) -> dict[str, Any]:
    """The diagnosis in short: claims, posterior, what competed, gain and rows."""
    diagnosis = found.diagnosis
    settings = found.case.settings
    return {
        "verdict": diagnosis.verdict,
        "causes": [_cause(plain(cause)) for cause in diagnosis.causes],
        "posterior": [[list(ids), p] for ids, p in diagnosis.posterior],
        "competing": sorted({v.cause for v in found.case.found.variants} - {UNKNOWN}),
        "terms": bool(found.case.found.terms),
        "named_from": settings.claims.named,
        "gain": _gain(diagnosis.gain),
        "rows": plain(diagnosis.rows),
        "noise_m": diagnosis.noise["standard_deviation_m"],
        "unexplained": None if diagnosis.unexplained is None else diagnosis.unexplained.against,
        "refuted": [one.id for one in diagnosis.refuted],
        "notes": list(diagnosis.notes),
        "error": None,
    }


def failure(reason: str) -> dict[str, Any]:
    """The same of a sensor that cannot be diagnosed."""
    return {
        "verdict": FAILED,
        "causes": [],
        "posterior": [],
        "competing": [],
        "terms": False,
        "named_from": None,
        "gain": None,
        "rows": None,
        "noise_m": None,
        "unexplained": None,
        "refuted": [],
        "notes": [],
        "error": reason,
    }


def _cause(cause: Mapping[str, Any]) -> dict[str, Any]:
    kept = ("id", "kind", "probability", "probability_alone", "parameters", "indistinguishable_from")
    return {name: cause[name] for name in (*kept, "in_model", "doubt")}


def _gain(gain: Gain | None) -> dict[str, Any] | None:
    if gain is None:
        return None
    kept = ("rms_before_m", "rms_after_m", "rms_floor_m", "held_out_rows", "interval_95", "variance_removed")
    whole = plain(gain)
    return {name: whole[name] for name in (*kept, "variance_removed_interval_95", "scheme")}
