"""The figures of real records: what the engine says about each, beside what an analyst found before."""

import json
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hidden_effects.bench.summary import removed, rounded
from hidden_effects.score import NONE, Figure, Record, part

ROOT = Path(__file__).parents[3]
_RECORDS = ROOT / "tests" / "reference" / "real_records.toml"
_FROZEN = ROOT / "tests" / "frozen" / "diagnoses.json"
_HONESTY = ROOT / "benches" / "honesty"
_SURE = 0.9
_TURNED = "whole"  # residuals turned by whole days: nothing but the mean day can act on them

KINDS = ("placements", "log")


def real() -> dict[str, Any]:
    """Figures of real records by the kind of their design, under names of `summary.ROWS`."""
    tables = _tables()
    return {
        "tables": {kind: [t["table"] for t in tables if t["design"] == kind] for kind in KINDS},
        "figures": {
            name: {kind: rounded(of([t for t in tables if t["design"] == kind], kind)) for kind in KINDS}
            for name, of in _ROWS.items()
        },
        "transfer": _transfer(),
    }


def _tables() -> list[Record]:
    """Every table of an analyst's record, with what the engine named in it."""
    given = tomllib.loads(_RECORDS.read_text(encoding="utf-8"))["record"]
    frozen = json.loads(_FROZEN.read_text(encoding="utf-8"))
    return [
        {**record, "table": name, "names": _names(record, frozen[name]), "gain": frozen[name]["gain"]}
        for record in given
        for name in record["tables"]
    ]


def _names(record: Record, diagnosis: Record) -> list[Record]:
    """Causes that are named without a doubt, with more than 0.9, and what the analyst says to each."""
    found = {id_ for ids in record["found"] for id_ in ids}
    names = []
    for id_, cause in diagnosis["causes"].items():
        if cause["doubt"] or cause["probability"] <= _SURE:
            continue
        said = {id_, *cause["rivals"]}
        alone = id_ in record.get("not_alone", ()) and not cause["rivals"]
        wrong = alone or (id_ in record["not_said"] and not said & found)
        names.append(
            {"kind": cause["kind"], "said": sorted(said), "right": bool(said & found), "wrong": wrong}
        )
    return names


def _found(tables: Sequence[Record], kind: str) -> Figure:
    """Part of the analyst's findings that the engine names."""
    asked = [
        {"said": any(set(ids) & set(n["said"]) for n in t["names"])} for t in tables for ids in t["found"]
    ]
    return part(asked, lambda r: r["said"])


def _wrong(tables: Sequence[Record], kind: str) -> Figure:
    return part(tables, lambda t: any(n["wrong"] for n in t["names"]))


def _right(tables: Sequence[Record], kind: str) -> Figure:
    effects = [n for t in tables for n in t["names"] if n["kind"] == "effect"]
    return part(effects, lambda n: n["right"])


def _alarms(tables: Sequence[Record], kind: str) -> Figure:
    """Names given to real residuals that were turned against their columns."""
    if kind != "log":
        return NONE
    figures = json.loads((_HONESTY / "rotation.json").read_text(encoding="utf-8"))["figures"]
    turned = [f["named"] for name, f in figures.items() if name.endswith(_TURNED)]
    hits, count = (sum(f[key] for f in turned) for key in ("hits", "count"))
    return part([{"hit": i < hits} for i in range(count)], lambda r: r["hit"])


def _told(tables: Sequence[Record], kind: str) -> Figure:
    shares = [
        removed([t["gain"]["rms_before_m"], t["gain"]["rms_after_m"]])
        for t in tables
        if any(n["kind"] == "effect" for n in t["names"])
    ]
    return Figure(float(np.median(shares)), min(shares), max(shares), len(shares)) if shares else NONE


_ROWS = {
    "false alarms, comparator": _alarms,
    "one cause: named, comparator": _found,
    "one cause: a confident wrong name, comparator": _wrong,
    "names above 0.9 that are right": _right,
    "share removed as told, comparator": _told,
}


def _transfer() -> dict[str, float]:
    """Mean share that models with a name remove as told, and of other windows of the same record."""
    figures = json.loads((_HONESTY / "transfer.json").read_text(encoding="utf-8"))["figures"]["all but extra"]
    again = figures["recurrence"]["named"]
    return {
        "told": round(figures["mean_reported_gain_where_named"], 3),
        "fresh": round(figures["mean_removed_of_named"], 3),
        "again": again["hits"],
        "asked": again["count"],
    }
