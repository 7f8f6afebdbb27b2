"""The rows of the table of targets: what is measured on which cases, and what is asked."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hidden_effects.score import (
    NONE,
    Figure,
    Record,
    beyond_chance,
    f1,
    gain,
    mean,
    part,
    resampled,
)

Measure = Callable[[Sequence[Record]], Figure]
Bounds = tuple[float | None, float | None]


@dataclass(frozen=True)
class Target:
    """One row: how it is measured, and the least and the most asked, by design."""

    name: str
    measure: Measure
    asked: dict[str, Bounds]


def of(records: Sequence[Record], *strata: str) -> list[Record]:
    """Answered cases of some strata."""
    return [r for r in records if r["stratum"] in strata and "error" not in r]


def _detected(records: Sequence[Record]) -> list[Record]:
    return [r for r in of(records, "prior", "wild") if r["verdict"] != "nothing"]


def _told(records: Sequence[Record]) -> list[Record]:
    return [r for r in _detected(records) if r["told"] is not None]


def _beside_unknown(records: Sequence[Record]) -> list[Record]:
    return [r for r in of(records, "unknown") if r["verdict"] != "nothing"]


def _ranged(records: Sequence[Record], low: float, high: float) -> list[Record]:
    return [r for r in of(records, "unknown") if low <= r["snr"] < high]


def _doubts_nothing(record: Record) -> bool:
    return bool(record["no_effect_probability"] < 0.5)


def _at_strength(records: Sequence[Record], stratum: str) -> list[Record]:
    """Cases of a power stratum that have its strength: some causes have bounds below it."""
    wanted = {"power5": 5.0, "power8": 8.0}[stratum]
    return [r for r in of(records, stratum) if abs(r["snr"] * np.sqrt(r["rows"]) / wanted - 1) < 0.05]


def _power(stratum: str) -> Measure:
    return lambda rs: part(_at_strength(rs, stratum), lambda r: r["verdict"] != "nothing")


def _ece(*strata: str) -> Measure:
    return lambda rs: beyond_chance(of(rs, "null", *strata))


def _gained(where: str) -> Measure:
    def measure(records: Sequence[Record]) -> Figure:
        cases = [r for r in of(records, "prior", "wild") if where in r]
        return resampled(cases, gain(where)) if cases else NONE

    return measure


SINGLES = ("prior", "wild")
TARGETS = (
    Target(
        "false alarms",
        lambda rs: part(of(rs, "null"), lambda r: r["alarm"]),
        dict.fromkeys("abc", (None, 0.02)),
    ),
    Target("power at snr sqrt(N) = 5", _power("power5"), dict.fromkeys("abc", (0.90, None))),
    Target("power at snr sqrt(N) = 8", _power("power8"), dict.fromkeys("abc", (0.99, None))),
    Target(
        "false alarms with the rule P(no effect) < 0.5",
        lambda rs: part(of(rs, "null"), _doubts_nothing),
        dict.fromkeys("abc", (None, None)),
    ),
    Target(
        "power at 5 with the rule P(no effect) < 0.5",
        lambda rs: part(_at_strength(rs, "power5"), _doubts_nothing),
        dict.fromkeys("abc", (None, None)),
    ),
    Target(
        "claimed, if detected",
        lambda rs: part(_detected(rs), lambda r: r["told"] is not None),
        dict.fromkeys("abc", (None, None)),
    ),
    Target(
        "alias class right, if claimed",
        lambda rs: part(_told(rs), lambda r: r["told"]),
        dict.fromkeys("abc", (0.92, None)),
    ),
    Target(
        "names in the reported class",
        lambda rs: resampled(_told(rs), lambda told: float(np.mean([len(r["class_told"]) for r in told]))),
        dict.fromkeys("abc", (None, None)),
    ),
    Target(
        "first set of the posterior in the right class",
        lambda rs: part(_detected(rs), lambda r: r["class"]),
        dict.fromkeys("abc", (None, None)),
    ),
    Target(
        "strict top-1 with no effect",
        lambda rs: part(of(rs, "null", *SINGLES), lambda r: r["strict"]),
        {"a": (0.55, None), "b": (0.79, None), "c": (0.85, None)},
    ),
    Target(
        "95 % set: coverage",
        lambda rs: part(of(rs, "null", *SINGLES), lambda r: r["covered"]),
        dict.fromkeys("abc", (0.94, 0.99)),
    ),
    Target(
        "95 % set: size",
        lambda rs: resampled(of(rs, "null", *SINGLES), mean("credible_sets")),
        {"a": (None, 6.3), "b": (None, 2.9), "c": (None, 2.1)},
    ),
    Target("ECE, known priors", _ece("prior"), dict.fromkeys("abc", (None, 0.03))),
    Target("ECE, unknown priors", _ece("wild"), {"a": (None, 0.10), "b": (None, 0.06), "c": (None, 0.05)}),
    Target(
        "reachable gain, same conditions",
        _gained("same"),
        {"a": (0.98, None), "b": (0.99, None), "c": (0.99, None)},
    ),
    Target(
        "reachable gain, shifted",
        _gained("shifted"),
        {"a": (0.95, None), "b": (0.99, None), "c": (0.99, None)},
    ),
    Target(
        "unknown found, snr >= 1",
        lambda rs: part(_ranged(rs, 1.0, 1e9), lambda r: r["says_unknown"]),
        {"a": (None, None), "b": (0.95, None), "c": (0.98, None)},
    ),
    Target(
        "unknown found, snr 0.4 to 1",
        lambda rs: part(_ranged(rs, 0.0, 1.0), lambda r: r["says_unknown"]),
        {"a": (None, None), "b": (0.70, None), "c": (0.90, None)},
    ),
    Target(
        "false unknown on single causes",
        lambda rs: part(of(rs, *SINGLES), lambda r: r["says_unknown"]),
        {"a": (None, None), "b": (None, 0.02), "c": (None, 0.05)},
    ),
    Target(
        "spurious name beside an unknown",
        lambda rs: part(_beside_unknown(rs), lambda r: bool(r["named"])),
        {"a": (None, None), "b": (None, 0.20), "c": (None, 0.30)},
    ),
    Target(
        "two effects, F1 strict",
        lambda rs: resampled(of(rs, "pair"), f1("strict_counts")),
        {"a": (0.48, None), "b": (0.74, None), "c": (0.82, None)},
    ),
    Target(
        "two effects, F1 class",
        lambda rs: resampled(of(rs, "pair"), f1("class_counts")),
        {"a": (0.72, None), "b": (0.85, None), "c": (0.87, None)},
    ),
)


def verdict(figure: Figure, asked: Bounds) -> str:
    """How a figure stands to what is asked; ``open`` where the interval still holds both answers."""
    low, high = asked
    if asked == (None, None) or not figure.count:
        return "reported"
    if (low is None or figure.value >= low) and (high is None or figure.value <= high):
        return "met"
    beyond = (low is not None and figure.high < low) or (high is not None and figure.low > high)
    return "missed" if beyond else "open"
