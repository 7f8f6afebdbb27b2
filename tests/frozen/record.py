"""What is kept of a diagnosis: every verdict, name and number, and none of the sentences."""

import json
import math
from collections.abc import Iterator
from typing import Any

import echocal

Record = dict[str, Any]

_LEAST = 1e-3  # probability from which on a set of causes is kept
_TOLERANCE = 1e-6  # of a probability, and of any other number relative to its size


def record(diagnosis: echocal.Diagnosis) -> Record:
    """A diagnosis as plain data."""
    said = diagnosis.to_dict()
    sets = {"+".join(entry["ids"]): entry["probability"] for entry in said["posterior"]}
    kept = {
        "verdict": said["verdict"],
        "causes": {cause["id"]: _cause(cause) for cause in said["causes"]},
        "posterior": {ids: p for ids, p in sets.items() if p >= _LEAST},
        "credible_set": ["+".join(ids) for ids in said["credible_set"]],
        "unexplained": _only(said["unexplained"], ("against", "rms_m")),
        "refuted": [refuted["id"] for refuted in said["refuted"]],
        "gain": _only(
            said["gain"],
            (
                "rms_before_m",
                "rms_after_m",
                "held_out_rows",
                "fraction_of_reachable",
                "interval_95",
                "scheme",
            ),
        ),
        "noise": said["noise"],
        "rows": _only(said["rows"], ("total", "used", "unusable", "level_steps_at_rows")),
        "notes": len(said["notes"]),
    }
    plain: Record = json.loads(json.dumps(kept), parse_float=lambda digits: float(f"{float(digits):.9g}"))
    return plain


def _only(mapping: Record | None, names: tuple[str, ...]) -> Record | None:
    return None if mapping is None else {name: mapping[name] for name in names}


def _cause(cause: Record) -> Record:
    sizes = {p["name"]: [p["value"], p["standard_uncertainty"]] for p in cause["parameters"]}
    return {
        "kind": cause["kind"],
        "probability": cause["probability"],
        "sizes": sizes,
        "rivals": sorted(cause["indistinguishable_from"]),
        "doubt": bool(cause.get("doubt")),
    }


def differences(expected: Any, found: Any, where: str = "") -> Iterator[str]:
    """Say what differs, in which place, with both sides.

    Yields
    ------
    str
    """
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in dict.fromkeys((*expected, *found)):
            one, other = expected.get(key, "absent"), found.get(key, "absent")
            if "absent" in (one, other) and where.endswith(".posterior"):  # at the edge of what is kept
                one, other = (_LEAST if value == "absent" else value for value in (one, other))
            yield from differences(one, other, f"{where}.{key}")
    elif isinstance(expected, list) and isinstance(found, list) and len(expected) == len(found):
        for i, (one, other) in enumerate(zip(expected, found, strict=True)):
            yield from differences(one, other, f"{where}[{i}]")
    elif isinstance(expected, float) and isinstance(found, float | int):
        least = _TOLERANCE if "probability" in where or ".posterior" in where else 1e-12
        if not math.isclose(expected, found, rel_tol=_TOLERANCE, abs_tol=least):
            yield f"{where}: {expected!r} expected, {found!r} found"
    elif expected != found:
        yield f"{where}: {expected!r} expected, {found!r} found"
