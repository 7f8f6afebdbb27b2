"""Readings clipped at a largest range."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule

__all__ = ["FAULT"]


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    safe: float = threshold(
        4.0,
        "1",
        "robust standard deviations below the limit from which on nothing is clipped: 1 normal row in 30,000",
    )
    clipped: float = threshold(
        0.9, "1", "part of the rows that should be beyond the limit and are at it; judgement"
    )
    most: float = threshold(0.5, "1", "part of all rows that may be clipped; judgement")


FACTS = CauseFacts(
    id="censored_range",
    kind="row",
    sentence="Readings are clipped at a largest value, or rows beyond it were dropped.",
    signature="the largest reading repeats exactly, in rows whose reference is at least as far",
    source="CATALOGUE, bookkeeping",
    parameters=(Quantity("limit", "m", "largest reading"), Quantity("rows", "1", "rows at the limit")),
    check="look for a maximum range in the device's program; measure one distance beyond it",
    prior=0.005,
    formula="reading' = min(reading, limit)",
    needs=("reference_distance",),
    repair="leaves out every row at the limit or near it, so that clipping biases nothing",
)


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Ask whether the largest reading repeats and nothing that should be beyond it is."""
    if view.reference is None or not view.good.any():
        return None
    values = np.where(view.good, recorded(view), -np.inf)
    top = float(values.max())
    at_limit = values >= top * (1 - 1e-12)
    count, others = int(at_limit.sum()), values[view.good & ~at_limit]
    if count < 2 or not len(others):
        return None
    limit, margin = float(np.median(view.indication[at_limit])), own.safe * view.scatter
    beyond, should = (view.good & (view.expected > limit + off) for off in (margin, -margin))
    run = np.flatnonzero(at_limit)
    if run[-1] - run[0] == count - 1 and not (at_limit & beyond).any():
        return None  # one run of a value that could be measured: stuck, not clipped
    rows = at_limit | should
    reached = at_limit[beyond].mean() if beyond.any() else 1.0
    if min(reached, should[at_limit].mean()) < own.clipped or rows.sum() > own.most * view.good.sum():
        return None
    repeated = 1 - (len(np.unique(others)) - 0.5) / len(others)
    evidence = (count - 1) * -float(np.log(repeated)) - float(np.log(len(others)))
    because = (
        f"{count} rows read exactly {limit:.4f} m and none more, where the reference distance goes up to "
        f"{float(view.reference[view.good].max()):.3f} m; the {int(rows.sum())} rows from "
        f"{float(view.reference[rows].min()):.3f} m on are left out, so that clipping biases nothing"
    )
    quantity = "echo_time" if view.observations.reading is None else "reading"
    rules = (RowRule(reason=FACTS.id, kind="at least", quantity=quantity, value=top),)
    return Found(rows, evidence, because, (limit, count), rules=rules)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Clip the farthest readings."""
    limit = float(np.quantile(table["reading_m"], random.uniform(0.8, 0.95)))
    table["reading_m"] = np.minimum(table["reading_m"], limit)


FAULT = Fault(FACTS, detect, spoil, Thresholds())
