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
    near: float = threshold(
        2.0, "1", "robust standard deviations over which echoes from one place scatter; judgement"
    )
    beside: float = threshold(
        3.0, "1", "log Bayes factor against a slip beside another odd row: slips are single; judgement"
    )
    rows: float = threshold(
        500, "1", "rows that a person types: of n tables 1 in 1 + (n / rows)^2; judgement"
    )
    logged: float = threshold(
        1.0, "1", "log Bayes factor against typing, where times are evenly spaced as a logger's; judgement"
    )
    even: float = threshold(0.8, "1", "part of the time steps that are equal in a logger's table; judgement")
    sure: float = threshold(
        2.3, "1", "log Bayes factor against an echo from anywhere for a row to be a slip: 10 to 1; judgement"
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
    repair="corrects the rows to the value that one edit gives, if other echoes do not explain them",
)


def edits(text: str) -> Iterator[tuple[str, str, float]]:
    """What may have been meant: digits, the name of the slip, and how usual it is.

    One digit in place of another is none of them: nearly every deviation is near one of those, so such a row
    is left out as an outlier.
    """
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


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Try every single edit on every odd row that looks typed."""
    values = recorded(view) if view.observations.reading is not None else view.indication
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
    search = _Search.of(view, values, at, decimals, own)
    evidence, corrected, stories = search.table, values.copy(), []
    for row in at:
        found = search.meant(int(row), float(view.expected[row]))
        if found is None or (found.slip != _USUAL and not seldom[int(row)]):
            odd[row] = False
            continue
        evidence += found.log_bayes
        corrected[row] = found.value
        stories.append(
            f"row {row + 1} reads {values[row]:g} m, {found.value:g} m would be consistent ({found.slip})"
        )
    if stories and len(at) >= _ENOUGH:
        evidence = min(evidence, _typed_at_all(len(stories), len(at), _by_chance(search)))
    if evidence <= 0 or not stories:
        return None
    data = view.observations
    as_meant = (
        {"echo_time": data.echo_time * corrected / values} if data.reading is None else {"reading": corrected}
    )
    because = f"{'; '.join(stories[:3])}{'; ...' if len(stories) > 3 else ''}; corrected in {listed(odd)}"
    rules = (far_rule(view, FACTS.id, 0, settings, deviations=odds[decimals > 0]),)
    repaired = with_values(view, odd, FACTS.id, **as_meant)
    return Found(odd, evidence, because, (len(stories),), repaired, rules)


def _by_chance(search: "_Search") -> float:
    """Part of the odd rows that one edit makes consistent if they deviate as other odd rows do."""
    at, off = search.at, search.view.deviation
    tried = at[:: -(-len(at) // _TRIED)]
    others = [off[np.roll(tried, shift)] for shift in range(1, min(_SHIFTS, len(tried) - 1) + 1)]
    matched = [
        search.meant(int(row), float(search.values[row] - deviation)) is not None
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


@dataclass(frozen=True)
class _Meant:
    """What may have been meant, and the log Bayes factor of a slip, given the rows before."""

    value: float
    slip: str
    log_bayes: float


@dataclass(frozen=True)
class _Search:
    """Edits of odd rows against echoes of something else.

    Where every row is written in whole millimeters, a logger may have done so: its odd rows are echoes
    from another place or over a longer way, which come back to one distance and follow each other. Where
    only the odd rows are so written, no echo did it.

    Attributes
    ----------
    decimals : int
        Decimals of a typed reading in m.
    all_typed : bool
        Whether the other rows are so written too.
    table : float
        Log Bayes factor of a table that somebody typed.
    """

    view: View
    values: NDArray[np.float64]
    at: NDArray[np.intp]
    decimals: int
    all_typed: bool
    table: float
    own: Thresholds

    @classmethod
    def of(
        cls, view: View, values: NDArray[np.float64], at: NDArray[np.intp], decimals: int, own: Thresholds
    ) -> "_Search":
        table = -float(np.log1p((len(view) / own.rows) ** 2)) - own.logged * _logged(view, own)
        return cls(view, values, at, decimals or _DECIMALS[0], decimals > 0, table if decimals else 0.0, own)

    def meant(self, row: int, expected: float) -> _Meant | None:
        """The edit that fits best, if a slip is far more likely than another echo."""
        own, value, unit = self.own, float(self.values[row]), 10.0**-self.decimals
        scatter = max(self.view.scatter, 0.3 * unit)
        best: tuple[float, str, float] | None = None
        slips, weights = 0.0, 0.0
        for meant, slip, weight in edits(f"{round(value / unit):0{self.decimals + 1}d}"):
            off = (int(meant) * unit - expected) / scatter
            density = weight * 0.3676 / (scatter * (1 + off**2 / 3) ** 2)  # Student's t, 3 degrees
            slips, weights = slips + density, weights + weight
            if abs(off) < own.close and (best is None or density > best[2]):
                best = (int(meant) * unit, slip, density)
        if best is None:
            return None
        evidence = float(np.log(slips / weights) + np.log(own.slip)) + own.alone * (not self.all_typed)
        if evidence - float(np.log(_anywhere(value, expected))) < own.sure:
            return None
        evidence -= float(np.log(self._elsewhere(row, value, expected)))
        if self.all_typed:
            evidence -= own.beside * float(np.isin([row - 1, row + 1], self.at).sum())
        return _Meant(best[0], best[1], evidence)

    def _elsewhere(self, row: int, value: float, expected: float) -> float:
        """Density of this reading as an echo from another place, given the odd rows before [1/m]."""
        anywhere = _anywhere(value, expected)
        before = self.values[self.at[self.at < row]]
        if not self.all_typed or not len(before):
            return anywhere
        width = self.own.near * max(self.view.scatter, 10.0**-self.decimals)
        again = np.exp(-0.5 * ((before - value) / width) ** 2).mean() / (2.5066 * width)
        return float(0.5 * anywhere + 0.5 * again)


def _anywhere(value: float, expected: float) -> float:
    """Probability density of an echo from anywhere, nearer or farther than the target [1/m]."""
    return 1.0 / max(abs(expected), abs(value), 0.2)


def _logged(view: View, own: Thresholds) -> bool:
    """Whether times are evenly spaced, as a logger's are."""
    elapsed = view.observations.conditions.get("elapsed_time")
    if elapsed is None:
        return False
    steps = np.diff(elapsed[np.isfinite(elapsed)])
    if not len(steps):
        return False
    usual = float(np.median(steps))
    return usual > 0 and bool(np.mean(np.abs(steps - usual) < 0.02 * usual) > own.even)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Type readings in mm, and swap the first two digits of some."""
    table["reading_m"] = np.round(table["reading_m"], 3)
    digits = [f"{round(1e3 * value):04d}" for value in table["reading_m"]]
    apart = [row for row, text in enumerate(digits) if abs(int(text[0]) - int(text[1])) > 2]
    for row in random.choice(apart, 3, replace=False):
        text = digits[row]
        table["reading_m"][row] = int(text[1] + text[0] + text[2:]) / 1e3


FAULT = Fault(FACTS, detect, spoil, Thresholds())
