"""Readings that become consistent after one edit of their digits."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

_DECIMALS = (3, 4)  # of a typed reading in m
_USUAL = "two digits swapped"
_ENOUGH = 8  # odd rows that tell how odd rows deviate
_TRIED, _SHIFTS = 100, 5  # odd rows, and deviations of others, that tell how many match by chance
_PARTS = 64  # of what part may be typed


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    odd_among_typed: float = threshold(
        8.0, "1", "robust standard deviations that a row is off by, where most rows are typed; judgement"
    )
    odd_alone: float = threshold(4.5, "1", "the same where other rows are not typed; judgement")
    least: float = threshold(4e-3, "m", "least change by a slip; judgement")
    close: float = threshold(
        5.0, "1", "robust standard deviations that a corrected row may be off by; judgement"
    )
    repeated: float = threshold(3, "1", "rows of one value that nobody types by chance; judgement")
    alone: float = threshold(
        2.0, "1", "log Bayes factor of a row that looks typed where others do not; judgement"
    )
    most: float = threshold(2000, "1", "odd rows beyond which nobody typed them; judgement")
    most_part: float = threshold(0.2, "1", "the same as a part of all rows; judgement")
    slip: float = threshold(
        0.5,
        "1",
        "probability that an odd row is a slip of the hand, of the odd rows that look typed; judgement",
    )


FACTS = CauseFacts(
    id="mistyped_rows",
    kind="row",
    sentence="A value was typed wrong: swapped digits, a lost or doubled digit, a shifted decimal point.",
    signature="the row becomes consistent with its neighbors after one edit",
    source="CATALOGUE, bookkeeping",
    parameters=(Quantity("rows", "1", "rows concerned"),),
    check="look the rows up in the notes they were typed from",
    prior=0.02,
    formula="reading' = reading with two digits swapped, one lost, one too many, or another decimal point",
    repair="corrects the rows to the nearest value that one edit gives",
)


def edits(text: str) -> Iterator[tuple[str, str, float]]:
    """What may have been meant: digits, the name of the slip, and how usual it is."""
    for i in range(len(text) - 1):
        if text[i] != text[i + 1]:
            yield text[:i] + text[i + 1] + text[i] + text[i + 2 :], _USUAL, 1.0
    yield text + "0", "decimal point shifted", 0.5
    if text.endswith("0"):
        yield text[:-1], "decimal point shifted", 0.5
    for i in range(len(text)):
        if i == 0 or text[i] != text[i - 1]:
            yield text[:i] + text[i + 1 :], "a digit too many", 0.2
    for i in range(len(text) + 1):
        for digit in "0123456789":
            yield text[:i] + digit + text[i:], "a digit lost", 0.02


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Try every single edit on every odd row that looks typed."""
    values = recorded(view) if view.observations.reading is not None else view.indication
    own = settings.of(FACTS, Thresholds)
    odds = {True: own.odd_among_typed, False: own.odd_alone}
    least = max(min(odds.values()) * view.scatter, own.least)
    with np.errstate(invalid="ignore"):
        far = values[view.good & (np.abs(view.deviation) > least)] if view.farthest > least else values[:0]
    if not any(_on_grid(far, decimals).any() for decimals in _DECIMALS):
        return None  # no row that is odd looks typed
    decimals = next((d for d in _DECIMALS if _on_grid(values, d)[view.good].mean() > 0.5), 0)
    typed = _on_grid(values, decimals or _DECIMALS[0])
    with np.errstate(invalid="ignore"):
        odd = view.good & typed & (np.abs(view.deviation) > max(odds[decimals > 0] * view.scatter, own.least))
    at = np.flatnonzero(odd)
    if not 0 < len(at) < own.most or len(at) > own.most_part * view.good.sum():
        return None
    seldom = dict(zip(at.tolist(), _seldom(values[at], own), strict=True))
    evidence, corrected, stories = 0.0, values.copy(), []
    for row in at:
        found = _meant(view, float(values[row]), float(view.expected[row]), decimals or _DECIMALS[0], own)
        if found is None or (found[1] != _USUAL and not seldom[int(row)]):
            odd[row] = False
            continue
        value, slip, bayes = found
        evidence += bayes + (0.0 if decimals else own.alone)
        corrected[row] = value
        stories.append(f"row {row + 1} reads {values[row]:g} m, {value:g} m would be consistent ({slip})")
    if stories and len(at) >= _ENOUGH:
        by_chance = _by_chance(view, values, at, decimals or _DECIMALS[0], own)
        evidence = min(evidence, _typed_at_all(len(stories), len(at), by_chance))
    if evidence <= 0 or not stories:
        return None
    observations = view.observations
    time = np.where(odd, observations.echo_time * corrected / values, observations.echo_time)
    reading = None if observations.reading is None else corrected
    return Finding(
        FACTS,
        min(evidence, settings.cap),
        f"{'; '.join(stories[:3])}{'; ...' if len(stories) > 3 else ''}; corrected in {listed(odd)}",
        (Parameter("rows", float(len(stories)), 0.0, "1"),),
        odd,
        replace(observations, reading=reading, echo_time=time),
    )


def _by_chance(
    view: View, values: NDArray[np.float64], at: NDArray[np.intp], decimals: int, own: Thresholds
) -> float:
    """Part of the odd rows that one edit makes consistent if they deviate as other odd rows do."""
    tried = at[:: -(-len(at) // _TRIED)]
    others = [view.deviation[np.roll(tried, shift)] for shift in range(1, min(_SHIFTS, len(tried) - 1) + 1)]
    matched = [
        _meant(view, float(values[row]), float(values[row] - deviation), decimals, own) is not None
        for deviations in others
        for row, deviation in zip(tried, deviations, strict=True)
    ]
    return (sum(matched) + 0.5) / (len(matched) + 1.0)


def _typed_at_all(matched: int, odd: int, by_chance: float) -> float:
    """Log Bayes factor of some part of the odd rows being typed, any part as likely, against none."""
    typed = (np.arange(_PARTS) + 0.5) / _PARTS
    match, miss = typed + (1 - typed) * by_chance, (1 - typed) * (1 - by_chance)
    log = matched * np.log(match / by_chance) + (odd - matched) * np.log(miss / (1 - by_chance))
    return float(np.logaddexp.reduce(log) - np.log(_PARTS))


def _seldom(values: NDArray[np.float64], own: Thresholds) -> NDArray[np.bool_]:
    """Values that hardly repeat: a constant in place of a reading is another fault."""
    _, which, counts = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray(counts[which] < own.repeated)


def _on_grid(values: NDArray[np.float64], decimals: int) -> NDArray[np.bool_]:
    scaled = values * 10.0**decimals
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(scaled - np.round(scaled)) < 1e-9 * np.maximum(np.abs(scaled), 1.0))


def _meant(
    view: View, value: float, expected: float, decimals: int, own: Thresholds
) -> tuple[float, str, float] | None:
    """The edit that fits best, and the log Bayes factor of a slip against any other outlier."""
    scale = 10.0**-decimals
    text = f"{round(value / scale):0{decimals + 1}d}"
    close = own.close * max(view.scatter, 0.3 * scale)
    best, chance = None, 0.0
    for meant, slip, weight in edits(text):
        off = abs(int(meant) * scale - expected)
        chance += weight * 2 * close / max(abs(expected), 0.2)
        if off < close and (best is None or (weight, -off) > best[:2]):
            best = (weight, -off, int(meant) * scale, slip)
    if best is None:
        return None
    return best[2], best[3], float(np.log(best[0] / min(chance, 1.0)) + np.log(own.slip))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Type readings in mm, and swap the first two digits of some."""
    table["reading_m"] = np.round(table["reading_m"], 3)
    digits = [f"{round(1e3 * value):04d}" for value in table["reading_m"]]
    apart = [row for row, text in enumerate(digits) if abs(int(text[0]) - int(text[1])) > 2]
    for row in random.choice(apart, 3, replace=False):
        text = digits[row]
        table["reading_m"][row] = int(text[1] + text[0] + text[2:]) / 1e3


FAULT = Fault(FACTS, detect, spoil, Thresholds())
