"""The table of verdicts: one row for each sensor."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.parts import Gain
from echocal.diagnose.pipeline import Examined
from echocal.diagnose.results.diagnosis import plain
from echocal.errors import writing
from echocal.fleet.tables import Frame, polars
from echocal.outputs import replacing, spreadsheet_safe

_PARAMETER = {"name": "String", "value": "Float64", "standard_uncertainty": "Float64", "unit": "String"}
COLUMNS = {
    "sensor": "String",
    "kind": "String",
    "verdict": "String",
    "cause": "String",
    "class": "List(String)",
    "probability": "Float64",
    "class_probability": "Float64",
    "fleet_probability": "Float64",
    "fleet_class_probability": "Float64",
    "fleet_verdict": "String",
    "parameter": "String",
    "size": "Float64",
    "size_standard_uncertainty": "Float64",
    "unit": "String",
    "causes": "causes",
    "rms_before_mm": "Float64",
    "rms_after_mm": "Float64",
    "rms_floor_mm": "Float64",
    "variance_removed": "Float64",
    "variance_removed_low": "Float64",
    "variance_removed_high": "Float64",
    "rows": "Int64",
    "rows_used": "Int64",
    "rows_unusable": "Int64",
    "rows_repeated": "Int64",
    "files": "Int64",
    "model": "String",
    "model_hash": "String",
    "version": "String",
    "seconds": "Float64",
    "notes": "List(String)",
    "reason": "String",
}
"""Columns of the table and their types."""
FAILED = "failed"
"""Verdict of a sensor that cannot be diagnosed."""


def row(record: Mapping[str, Any], fleet: Mapping[str, Any]) -> dict[str, Any]:
    """One row of the table, of the record of a sensor and of what the fleet says of it."""
    causes = record["causes"]
    first = causes[0] if causes else None
    sized = next((p for p in first["parameters"] if p["standard_uncertainty"]), None) if first else None
    gain = record["gain"] or {}
    low, high = gain.get("variance_removed_interval_95") or (None, None)
    rows = record["rows"] or {}
    return {
        "sensor": record["sensor"],
        "kind": record["kind"],
        "verdict": record["verdict"],
        "cause": first["id"] if first else None,
        "class": [first["id"], *first["indistinguishable_from"]] if first else [],
        "probability": _alone(first) if first else None,
        "class_probability": first["probability"] if first else None,
        "fleet_probability": fleet["causes"][0]["fleet_probability_alone"] if first else None,
        "fleet_class_probability": fleet["causes"][0]["fleet_probability"] if first else None,
        "fleet_verdict": fleet["verdict"],
        "parameter": sized["name"] if sized else None,
        "size": sized["value"] if sized else None,
        "size_standard_uncertainty": sized["standard_uncertainty"] if sized else None,
        "unit": sized["unit"] if sized else None,
        "causes": [
            {
                "id": cause["id"],
                "kind": cause["kind"],
                "class": [cause["id"], *cause["indistinguishable_from"]],
                "probability": _alone(cause),
                "class_probability": cause["probability"],
                "fleet_class_probability": own["fleet_probability"],
                "in_model": cause["in_model"],
                "doubt": cause["doubt"],
                "parameters": cause["parameters"],
            }
            for cause, own in zip(causes, fleet["causes"], strict=True)
        ],
        "rms_before_mm": _mm(gain.get("rms_before_m")),
        "rms_after_mm": _mm(gain.get("rms_after_m")),
        "rms_floor_mm": _mm(gain.get("rms_floor_m")),
        "variance_removed": gain.get("variance_removed"),
        "variance_removed_low": low,
        "variance_removed_high": high,
        "rows": rows.get("total"),
        "rows_used": rows.get("used"),
        "rows_unusable": sum(rows["unusable"].values()) if rows else None,
        "rows_repeated": record["repeated"],
        "files": record["files"],
        "model": record["model"],
        "model_hash": record["model_hash"],
        "version": __version__,
        "seconds": record["seconds"],
        "notes": record["notes"],
        "reason": record["error"],
    }


def table(rows: Sequence[Mapping[str, Any]]) -> Frame:
    """The rows as a polars table."""
    pl = polars()
    parameter = pl.Struct({name: getattr(pl, kind) for name, kind in _PARAMETER.items()})
    cause = pl.Struct(
        {
            "id": pl.String,
            "kind": pl.String,
            "class": pl.List(pl.String),
            "probability": pl.Float64,
            "class_probability": pl.Float64,
            "fleet_class_probability": pl.Float64,
            "in_model": pl.Boolean,
            "doubt": pl.String,
            "parameters": pl.List(parameter),
        }
    )
    special = {"causes": pl.List(cause), "List(String)": pl.List(pl.String)}
    schema = {name: special.get(kind) or getattr(pl, kind) for name, kind in COLUMNS.items()}
    return pl.DataFrame(list(rows), schema=schema, orient="row")


def write(rows: Sequence[Mapping[str, Any]], out: Path, *, spreadsheet_safe: bool = False) -> None:
    """Write the table; in CSV, lists are texts in JSON."""
    pl = polars()
    if out.suffix.lower() == ".csv":
        nested = [name for name, kind in COLUMNS.items() if kind in {"causes", "List(String)"}]
        flat = [{**one, **{name: json.dumps(one[name]) for name in nested}} for one in rows]
        if spreadsheet_safe:
            flat = [{name: _safe(value) for name, value in one.items()} for one in flat]
        schema = {name: pl.String if name in nested else getattr(pl, kind) for name, kind in COLUMNS.items()}
        frame = pl.DataFrame(flat, schema=schema, orient="row")
        with replacing(out) as unfinished:
            frame.write_csv(unfinished)
        return
    with replacing(out) as unfinished, writing(out):
        table(rows).write_parquet(unfinished, compression="zstd")


def _safe(value: Any) -> Any:
    return spreadsheet_safe(value) if isinstance(value, str) else value


def _alone(cause: Mapping[str, Any]) -> float:
    alone = cause["probability_alone"]
    return float(cause["probability"] if alone is None else alone)


def _mm(meters: float | None) -> float | None:
    return None if meters is None else 1e3 * meters


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
    nothing = dict.fromkeys(("named_from", "gain", "rows", "noise_m", "unexplained"))
    none: dict[str, Any] = {name: [] for name in ("causes", "posterior", "competing", "refuted", "notes")}
    return {"verdict": FAILED, "terms": False, "error": reason, **nothing, **none}


def _cause(cause: Mapping[str, Any]) -> dict[str, Any]:
    kept = ("id", "kind", "probability", "probability_alone", "parameters", "indistinguishable_from")
    return {name: cause[name] for name in (*kept, "in_model", "doubt")}


def _gain(gain: Gain | None) -> dict[str, Any] | None:
    if gain is None:
        return None
    kept = ("rms_before_m", "rms_after_m", "rms_floor_m", "held_out_rows", "interval_95", "variance_removed")
    whole = plain(gain)
    return {name: whole[name] for name in (*kept, "variance_removed_interval_95", "scheme")}
