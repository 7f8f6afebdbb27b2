"""What a person should know of a run: each cause once, with the files that it is in."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

__all__ = ["sentences"]

_SHOWN = 3  # files that a sentence names


def sentences(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """Sentences on what was assumed, left out and unusable."""
    done = [result for result in results if result["error"] is None]
    causes: dict[str, list[str]] = {}
    for result in done:
        for note in result["notes"]:
            causes.setdefault(note, []).append(result["source"])
    said = [f"{note}{_in(files, len(done))}" for note, files in causes.items()]
    said += _of_rows(done, "unusable", "no distance")
    said += _of_rows(done, "marked", "the distance by the model without its smooth correction")
    said += _of_domains(done)
    return said + _of_schemas(done)


def _of_rows(done: list[Mapping[str, Any]], kind: str, what: str) -> list[str]:
    found: dict[str, list[tuple[str, int, int]]] = {}
    for result in done:
        for reason, count in result[kind].items():
            found.setdefault(reason, []).append((result["source"], count, result["first"][reason]))
    said = []
    for reason, places in found.items():
        total = sum(count for _, count, _ in places)
        first, _, row = places[0]
        where = f"first at row {row}" + (f" of {first}" if len(done) > 1 else "")
        said.append(f"{what} in {_rows(total)}: {reason}, {where}{_in([p[0] for p in places], len(done))}")
    return said


def _of_domains(done: list[Mapping[str, Any]]) -> list[str]:
    found: dict[str, list[tuple[str, int, int, float]]] = {}
    for result in done:
        for domain, (count, row, value) in result["outside"].items():
            found.setdefault(domain, []).append((result["source"], count, row, value))
    return [
        f"{domain}: {_rows(sum(p[1] for p in places))} outside, first at row {places[0][2]}: {places[0][3]:g}"
        f"{_in([p[0] for p in places], len(done))}"
        for domain, places in found.items()
    ]


def _of_schemas(done: list[Mapping[str, Any]]) -> list[str]:
    """How columns differ between files: the files that are not as most are. A text has names, no types."""
    said = _of_columns(done, lambda result: result["columns"])
    typed: dict[frozenset[str], list[Mapping[str, Any]]] = {}
    for result in done:
        if result["types"]:
            typed.setdefault(frozenset(result["columns"]), []).append(result)
    for alike in typed.values():
        said += _of_columns(alike, _with_types)
    return said


def _with_types(result: Mapping[str, Any]) -> list[str]:
    pairs = zip(result["columns"], result["types"], strict=True)
    return sorted(f"{name} ({kind})" for name, kind in pairs)


def _of_columns(
    done: list[Mapping[str, Any]], columns: Callable[[Mapping[str, Any]], list[str]]
) -> list[str]:
    kinds: dict[tuple[str, ...], list[str]] = {}
    for result in done:
        kinds.setdefault(tuple(columns(result)), []).append(result["source"])
    if len(kinds) < 2:
        return []
    usual = max(kinds, key=lambda columns: len(kinds[columns]))
    said = []
    for own, files in kinds.items():
        if own == usual:
            continue
        more = [name for name in own if name not in usual]
        less = [name for name in usual if name not in own]
        how = [f"has {', '.join(more)}"] * bool(more) + [f"lacks {', '.join(less)}"] * bool(less)
        how = how or ["has the columns in another order"]
        said.append(f"columns differ between files: {_listed(files)} {' and '.join(how)}")
    return said


def _in(files: list[str], total: int) -> str:
    """Which files, unless there is only one."""
    if total == 1:
        return ""
    if len(files) == total:
        return f" (all {total} files)"
    return f" ({_listed(files)})"


def _listed(files: list[str]) -> str:
    more = f" and {len(files) - _SHOWN} more" if len(files) > _SHOWN else ""
    return f"{', '.join(files[:_SHOWN])}{more}"


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"
