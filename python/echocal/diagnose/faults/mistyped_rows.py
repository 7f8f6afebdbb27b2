"""Readings that become consistent after one edit of their digits."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.outliers import far_rule
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

_DECIMALS = (3, 4)  # of a typed reading in m
_ENOUGH = 8  # odd rows that tell how odd rows deviate
_TRIED, _SHIFTS = 100, 5  # odd rows, and deviations of others, that tell how many match by chance
_PARTS = 64  # of what part may be typed
_MOST = 2000  # odd rows, of which nobody typed all


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    odd: float = threshold(
        8.0, "1", "robust standard deviations that a row is off by, where most rows are typed; judgement"
    )
    odd_alone: float = threshold(4.5, "1", "the same where other rows are not typed; judgement")
    alone: float = threshold(
        2.0, "1", "log Bayes factor of a row that looks typed where others do not; judgement"
    )
    rows: float = threshold(
        500, "1", "rows that a person types: of n tables 1 in 1 + (n / rows)^2; judgement"
    )
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
    repair="corrects the rows to the value that one edit gives, if other echoes do not explain them",
)


def edits(text: str) -> Iterator[tuple[str, str, float]]:
    """What may have been meant: digits, the name of the slip, and how usual it is.

    One digit in place of another is none of them: nearly every deviation is near one of those, so such a row
    is left out as an outlier.
    """
    for i in range(len(text) - 1):
        if text[i] != text[i + 1]:
            yield text[:i] + text[i + 1] + text[i] + text[i + 2 :], "two digits swapped", 1.0
    yield text + "0", "decimal point shifted", 0.5
    if text.endswith("0"):
        yield text[:-1], "decimal point shifted", 0.5
    for i in range(len(text)):
        if i == 0 or text[i] != text[i - 1]:
            yield text[:i] + text[i + 1 :], "a digit too many", 0.2
    for i in range(len(text) + 1):
        for digit in "0123456789":
            yield text[:i] + digit + text[i:], "a digit lost", 0.02


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Try every single edit on every odd row that looks typed."""
    values = recorded(view) if view.observations.reading is not None else view.indication
    if view.farthest <= own.odd_alone * view.scatter:
        return None
    usual = next((d for d in _DECIMALS if _on_grid(values, d)[view.good].mean() > 0.5), 0)
    decimals, deviations = (usual, own.odd) if usual else (_DECIMALS[0], own.odd_alone)
    typist = _Typist(max(view.scatter, 0.3 * 10.0**-decimals), decimals, 0.0 if usual else own.alone, own)
    with np.errstate(invalid="ignore"):
        off = np.abs(view.deviation) > deviations * typist.scatter
        odd = np.flatnonzero(view.good & _on_grid(values, decimals) & off)
    if not 0 < len(odd) < _MOST:
        return None
    meant = {
        int(row): found
        for row in odd
        if (found := typist.meant(float(values[row]), float(view.expected[row]))) is not None
    }
    evidence = sum(found.log_bayes for found in meant.values())
    if len(odd) >= _ENOUGH:
        by_chance = _by_chance(typist, values, odd, view.deviation[odd[:: -(-len(odd) // _TRIED)]])
        evidence = min(evidence, _typed_at_all(len(meant), len(odd), by_chance))
    if usual:  # else only the odd rows look typed, and a person typed these alone
        evidence -= float(np.log1p((len(view) / own.rows) ** 2))
    if not meant:
        return None
    rows, corrected = np.isin(np.arange(len(view)), list(meant)), values.copy()
    corrected[list(meant)] = [found.value for found in meant.values()]
    stories = [
        f"row {row + 1} reads {values[row]:g} m, {found.value:g} m would be consistent ({found.slip})"
        for row, found in meant.items()
    ]
    because = f"{'; '.join(stories[:3])}{'; ...' if len(stories) > 3 else ''}; corrected in {listed(rows)}"
    data = view.observations
    name = "echo_time" if data.reading is None else "reading"
    new = data.echo_time * corrected / values if data.reading is None else corrected
    repaired = with_values(view, rows, FACTS.id, **{name: new})
    rules = (far_rule(view, FACTS.id, 0, settings, deviations=deviations),)
    return Found(rows, evidence, because, (len(meant),), repaired, rules)


def _on_grid(values: NDArray[np.float64], decimals: int) -> NDArray[np.bool_]:
    scaled = values * 10.0**decimals
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(scaled - np.round(scaled)) < 1e-9 * np.maximum(np.abs(scaled), 1.0))


def _by_chance(
    typist: "_Typist", values: NDArray[np.float64], odd: NDArray[np.intp], off: NDArray[np.float64]
) -> float:
    """Part of the odd rows that one edit makes consistent if they deviate as other odd rows do."""
    tried = odd[:: -(-len(odd) // _TRIED)]
    matched = [
        typist.meant(float(values[row]), float(values[row] - deviation)) is not None
        for shift in range(1, min(_SHIFTS, len(tried) - 1) + 1)
        for row, deviation in zip(tried, np.roll(off, -shift), strict=True)
    ]
    return (sum(matched) + 0.5) / (len(matched) + 1.0)


def _typed_at_all(matched: int, odd: int, by_chance: float) -> float:
    """Log Bayes factor of some part of the odd rows being typed, any part as likely, against none."""
    typed = (np.arange(_PARTS) + 0.5) / _PARTS
    match, miss = typed + (1 - typed) * by_chance, (1 - typed) * (1 - by_chance)
    log = matched * np.log(match / by_chance) + (odd - matched) * np.log(miss / (1 - by_chance))
    return float(np.logaddexp.reduce(log) - np.log(_PARTS))


@dataclass(frozen=True)
class _Meant:
    """What may have been meant, and the log Bayes factor of a slip."""

    value: float
    slip: str
    log_bayes: float


@dataclass(frozen=True)
class _Typist:
    """Somebody who types readings with so many decimals, alone or all; corrected ones scatter so [m]."""

    scatter: float
    decimals: int
    alone: float
    own: Thresholds

    def meant(self, value: float, expected: float) -> _Meant | None:
        """The edit that fits best, if a slip is more likely than an echo from anywhere."""
        best, slips, weights = _Meant(np.nan, "", 0.0), 0.0, 0.0
        for text, slip, weight in edits(f"{round(value * 10.0**self.decimals):0{self.decimals + 1}d}"):
            right = int(text) * 10.0**-self.decimals
            off = (right - expected) / self.scatter
            density = weight * 0.3676 / (self.scatter * (1 + off**2 / 3) ** 2)  # Student's t, 3 degrees
            slips, weights = slips + density, weights + weight
            if density > best.log_bayes:
                best = _Meant(right, slip, density)
        anywhere = 1.0 / max(abs(expected), abs(value), 0.2)  # density of echoes [1/m]
        evidence = float(np.log(self.own.slip * slips / weights / anywhere)) + self.alone
        return _Meant(best.value, best.slip, evidence) if best.slip and evidence > 0.0 else None


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Type readings in mm, and swap the first two digits of some."""
    table["reading_m"] = np.round(table["reading_m"], 3)
    digits = [f"{round(1e3 * value):04d}" for value in table["reading_m"]]
    apart = [row for row, text in enumerate(digits) if abs(int(text[0]) - int(text[1])) > 2]
    for row in random.choice(apart, 3, replace=False):
        text = digits[row]
        table["reading_m"][row] = int(text[1] + text[0] + text[2:]) / 1e3


FAULT = Fault(FACTS, detect, spoil, Thresholds())
