"""A reading that froze."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import log_choices
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.one_value import one_value
from echocal.diagnose.faults.common.outliers import far_rule
from echocal.diagnose.faults.common.values import expected_everywhere, far, recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule

__all__ = ["FAULT"]

_FINEST = 1e-6  # m; below it no two readings are equal by chance
_SHORTEST, _MOST = 4, 5  # rows of a run that is looked at, and frozen runs of a table: more take time
_INSIDE = 6.0  # robust standard deviations from row to row: the others are outliers
_LEAST = 0.1  # of half a step: rounding hides less noise


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    tail: float = threshold(
        10, "1", "other runs, at least, that tell how runs of some length go on; judgement"
    )


FACTS = CauseFacts(
    id="stuck_reading",
    kind="row",
    sentence="The reading froze and was logged again and again.",
    signature="one value in a run of rows, far longer than the readings' step and noise make runs",
    source="arendst/Tasmota #2763: stuck at 283 cm after five minutes",
    parameters=(
        Quantity("first_row", "1", "first row of the run"),
        Quantity("length", "1", "rows of the longest run"),
        Quantity("value", "m", "the frozen reading"),
    ),
    check="log an age or a counter beside the reading",
    prior=0.01,
    formula="reading' = value, in length rows from first_row on",
    repair="leaves out the rows of a run after its first, and the first where it is far off, too",
)


def runs(values: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows and lengths of runs of one value."""
    new = np.ones(len(values), dtype=bool)
    new[1:] = ~(values[1:] == values[:-1])
    starts = np.flatnonzero(new)
    return starts, np.diff(np.append(starts, len(values)))


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Compare the longest runs with how often neighbors would be equal by themselves.

    A run that goes on while the target moves is judged by that, as in calm air all runs are long.
    """
    found = [_long(view, own, settings), _after_a_move(view, settings)]
    return max((one for one in found if one is not None), key=lambda one: one.log_bayes, default=None)


def _long(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Runs far longer than the others."""
    values = np.where(view.good, recorded(view), np.nan)
    starts, lengths = runs(values)
    if lengths.max() < _SHORTEST or len(lengths) < 2:
        return None
    surprise = _surprise(view, starts, lengths)
    long, evidence, usual = _longest(lengths, surprise, own)
    if evidence <= 0.0:
        return None
    frozen = np.zeros(len(values), dtype=bool)
    for start, length in zip(starts[long], lengths[long], strict=True):
        frozen[start : start + length] = True
    live = view.after(view.without(frozen, FACTS.id))
    off = np.abs(view.indication[starts[long]] - expected_everywhere(live)[starts[long]])
    measured = off <= settings.far.deviations * live.scatter
    frozen[starts[long][measured]] = False
    first, length = int(starts[long[0]]), int(lengths[long[0]])
    because = (
        f"rows {first + 1} to {first + length} all read {view.indication[first]:.4f} m; by the step of "
        f"the readings, their noise and the other runs {usual:.2g} such runs are expected; repeated rows are "
        "left out"
    )
    quantity = "echo_time" if view.observations.reading is None else "reading"
    shortest = int(lengths[long].min())
    whole = not measured.all()  # a value that was never measured may come again
    rule = RowRule(reason=FACTS.id, kind="run", quantity=quantity, length=shortest, whole=whole)
    return _found(view, frozen, evidence, because, (first, length), [rule])


def _after_a_move(view: View, settings: FaultSettings) -> Found | None:
    """Rows that repeat the reading from before the target moved: docs/method/faults.md, Eq. 31d."""
    values = recorded(view)
    found = one_value(view, far(view, settings.far) & (values > 0), values, settings, FACTS.id)
    if found is None or not np.isfinite(found.as_frozen):
        return None
    level = float(np.log(0.5 * settings.constant.among / settings.constant.range))  # as for a time-out
    constant = found.as_constant + level - log_choices(len(found.rows), len(found.rows) + found.others)
    evidence = found.as_frozen - float(np.logaddexp(found.as_wild, constant))
    starts, lengths = runs(np.where(view.good, values, np.nan))
    off = np.abs(view.deviation) > settings.far.deviations * view.scatter
    frozen = off & np.isin(np.repeat(starts, lengths), np.repeat(starts, lengths)[found.rows])
    first, length = int(found.rows[0]), int(frozen.sum())
    because = (
        f"{listed(frozen)} read {float(view.indication[first]):.4f} m as the row before them, where "
        f"{found.expected[0]:.4f} m is expected; left out"
    )
    rest = view.after(view.without(frozen, FACTS.id))
    sides = np.unique(np.sign(view.deviation[frozen])).astype(int).tolist()
    rules = [far_rule(rest, FACTS.id, side, settings) for side in sides]
    return _found(view, frozen, evidence, because, (first, length), rules)


def _found(
    view: View,
    frozen: NDArray[np.bool_],
    evidence: float,
    because: str,
    run: tuple[int, int],
    rules: Sequence[RowRule],
) -> Found:
    first, length = run
    value = float(view.indication[first])
    return Found(frozen, evidence, because, (first + 1, length, value), rules=tuple(rules))


def _longest(
    lengths: NDArray[np.int64], surprise: NDArray[np.float64], own: Thresholds
) -> tuple[NDArray[np.int64], float, float]:
    """Runs that are frozen, the evidence for that, and how many so long are expected.

    The runs of a sensor in calm air are longer than its usual noise makes them. So the other runs of the
    table have a say: evidence is what both leave, the noise of a row and the lengths of the other runs.
    """
    candidates = np.flatnonzero(surprise > 0.0)
    candidates = candidates[np.argsort(-lengths[candidates], kind="stable")]
    best: tuple[NDArray[np.int64], float, float] = (candidates[:0], 0.0, 1.0)
    for count in range(1, min(_MOST, len(candidates)) + 1):
        chosen = candidates[:count]
        others = np.delete(lengths, chosen)
        log_expected = _log_expected(others, count, int(lengths[chosen[-1]]), own)
        by_others = -count * log_expected + float(np.log(np.arange(1, count + 1)).sum())
        evidence = min(by_others, float(surprise[chosen].max())) + _log_prior(lengths, chosen)
        if evidence > best[1]:
            best = chosen, evidence, float(np.exp(-evidence))
    return best


def _log_prior(lengths: NDArray[np.int64], frozen: NDArray[np.int64]) -> float:
    """Log probability of lengths: half of the frozen runs do not end, half have any order of magnitude."""
    ended = 0.5 / (lengths[frozen] * np.log(lengths.sum()))
    return float(np.log(ended + 0.5 * (frozen == len(lengths) - 1)).sum())


def _log_expected(others: NDArray[np.int64], longer: int, length: int, own: Thresholds) -> float:
    """Log of the number of runs of some length or more that the other runs let expect.

    Above each length that enough of them reach, runs are taken to go on with some probability at each
    row (Jeffreys's prior); the largest of these numbers counts, as calm air has a tail of its own. The
    `longer` runs that are judged reach the longest of the others at least.
    """
    from scipy.special import betaln  # takes long to import

    sorted_ = np.sort(others)[::-1]
    expected = -np.inf
    for least in range(1, length + 1):
        ended = int(np.searchsorted(-sorted_, -least, side="right"))
        if ended < own.tail and least > 1:
            break
        went_on = float((sorted_[:ended] - least).sum()) + longer * float(sorted_[0] - least) + 0.5
        goes_on = betaln(went_on + length - least, ended + 0.5) - betaln(went_on, ended + 0.5)
        expected = max(expected, float(np.log(ended + longer) + goes_on))
    return expected if np.isfinite(expected) else 0.0


def _surprise(view: View, starts: NDArray[np.int64], lengths: NDArray[np.int64]) -> NDArray[np.float64]:
    """Log improbability that all rows of a run fall into one step of the readings, somewhere in the table.

    Noise carries each row's expectation into the run's step, or not. The noise is that of the other rows,
    from row to row and less what rounding makes. As often as neighbors are equal there, they are equal here.
    """
    from scipy.special import ndtr  # takes long to import

    half, rows = 0.5 * max(view.resolution, _FINEST), len(view)
    jump = np.nan_to_num(np.diff(view.deviation, prepend=np.nan))
    total = np.cumsum(np.minimum(jump**2, (_INSIDE * view.scatter) ** 2))
    surprise = np.zeros(len(lengths))
    for run in np.flatnonzero(lengths >= _SHORTEST):
        first, last = starts[run], starts[run] + lengths[run] - 1
        elsewhere = max(rows - int(lengths[run]), 1)
        square = (total[-1] - total[last] + total[first]) / elsewhere
        noise = np.sqrt(max(0.5 * square - half**2 / 3, (_LEAST * half) ** 2))
        equal = (elsewhere - len(lengths) + 1.5) / elsewhere
        off = view.expected[first : last + 1]
        off = off - np.median(off)  # the run's own level is its business
        inside = ndtr((half - off) / noise) - ndtr((-half - off) / noise)
        surprise[run] = -np.log(np.clip(inside, max(equal, 1e-12), 1.0))[1:].sum() - np.log(rows)
    return surprise


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Freeze the reading for some rows."""
    first, length = int(random.integers(0, len(table["reading_m"]) - 40)), int(random.integers(10, 40))
    table["reading_m"][first : first + length] = table["reading_m"][first]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
