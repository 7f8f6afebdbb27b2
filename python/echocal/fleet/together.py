"""Causes that come together more often than chance: one of them may be a part of the other."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import combinations
from math import comb
from typing import Any

from echocal.diagnose.settings import Settings
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["together"]


def together(rows: Sequence[Mapping[str, Any]], settings: Settings) -> list[dict[str, Any]]:
    """Pairs of causes that are claimed in the same sensors, and how many such sensors chance would make.

    Fisher's exact test, divided among all pairs.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of the table of verdicts.
    settings : Settings

    Returns
    -------
    list of dict
        ``ids``, ``sensors``, ``by_chance`` and ``p_value``, the least probable first.
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
