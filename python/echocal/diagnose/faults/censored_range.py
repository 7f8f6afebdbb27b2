"""Readings clipped at a largest range."""

import numpy as np

from echocal.diagnose.faults.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View

__all__ = ["FACTS", "detect"]

_FEWEST = 3  # rows at the limit
_SAFE = 4.0  # robust standard deviations below the limit from which on nothing is clipped
_ALL = 0.9  # part of the rows that should be beyond the limit and stand at it

FACTS = CauseFacts(
    id="censored_range",
    kind="row",
    sentence="Readings are clipped at a largest value, or rows beyond it were dropped.",
    signature="the largest reading repeats exactly, in rows whose reference is at least as far",
    source="CATALOGUE, bookkeeping",
    parameters=(Quantity("limit", "m", "largest reading"), Quantity("rows", "1", "rows at the limit")),
    check="look for a maximum range in the device's program; measure one distance beyond it",
    prior=0.005,
)


def detect(view: View) -> Finding | None:
    """Ask whether the largest reading repeats and nothing that should be beyond it is."""
    reference = view.reference
    if reference is None or not view.good.any():
        return None
    values = np.where(view.good, recorded(view), -np.inf)
    top = float(values.max())
    at_limit = values >= top * (1 - 1e-12)
    count = int(at_limit.sum())
    if count < _FEWEST:
        return None
    limit = float(np.median(view.indication[at_limit]))
    error = (view.indication - reference)[view.good & ~at_limit]
    if len(error) < 8:
        return None
    scatter = 1.4826 * float(np.median(np.abs(error - np.median(error)))) + 1e-5
    center = float(np.median(error))
    beyond = view.good & (reference + center > limit + _SAFE * scatter)
    should = view.good & (reference + center > limit - _SAFE * scatter)
    others = values[view.good & ~at_limit]
    _, counts = np.unique(others, return_counts=True)
    doubled = (float((counts - 1).sum()) + 0.5) / len(others)
    clipped = float(at_limit[beyond].mean()) if beyond.any() else 1.0
    far_short = reference[at_limit] + center - limit > -_SAFE * scatter
    run = np.flatnonzero(at_limit)
    if run[-1] - run[0] == count - 1 and not (reference[at_limit] + center > limit + _SAFE * scatter).any():
        return None  # one run of a value that could be measured: stuck, not clipped
    if clipped < _ALL or far_short.mean() < _ALL or doubled > 0.3:
        return None
    evidence = (count - 1) * -np.log(max(doubled, 1 / len(others))) - np.log(len(others))
    rows = at_limit | should
    if rows.sum() > 0.5 * view.good.sum():
        return None
    because = (
        f"{count} rows read exactly {limit:.4f} m and none more, where the reference distance goes up to "
        f"{float(reference[view.good].max()):.3f} m; the {int(rows.sum())} rows from "
        f"{float(reference[rows].min()):.3f} m on are left out, so that clipping biases nothing"
    )
    parameters = (Parameter("limit", limit, 0.0, "m"), Parameter("rows", float(count), 0.0, "1"))
    return Finding(FACTS, float(min(evidence, 60.0)), because, parameters, rows, view.without(rows, FACTS.id))
