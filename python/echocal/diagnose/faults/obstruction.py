"""Something nearer in the beam."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import finest, log_choices, log_constant
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.one_value import one_value
from echocal.diagnose.faults.common.outliers import far_rule
from echocal.diagnose.faults.common.values import far
from echocal.diagnose.faults.timeout import FACTS as TIMEOUT
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["FAULT"]

_SAME_THING = ("beam_edge",)  # its echo begins before that of the target is over, and shifts it
_OWN = 4.0  # robust standard deviations, within which a row is the thing's: as in Eq. 2b
_LATE = 0.07  # m: a faint echo is heard late, by twice the eight periods of a burst (HC-SR04 data sheet)


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    most: float = threshold(0.5, "1", "part of all rows that the thing may answer; judgement")
    sure: float = threshold(3.0, "1", "log odds against wrong references, for these to be no rival: Eq. 23")


FACTS = CauseFacts(
    id="obstruction",
    kind="row",
    sentence="Something nearer stands in the beam and answers in place of targets beyond it.",
    signature="rows with targets beyond some distance read that distance, wherever the target is",
    source="geometry of a cone with a thing in it; CATALOGUE, beam_edge",
    parameters=(
        Quantity("distance", "m", "where the thing stands"),
        Quantity("rows", "1", "rows that read its distance"),
    ),
    check="look along the beam at this distance, cover what stands there with an absorber, or move sideways",
    prior=0.02,
    formula="reading' = distance, where the target is beyond it",
    repair="leaves the rows out",
)


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Compare echoes of one thing with wild rows, a constant, and late visits.

    docs/method/faults.md, Eq. 31c. Rows cannot tell a thing from a wrong reference of a whole place.
    """
    short = far(view, settings.far) & (view.deviation < 0) & (view.indication > 0)
    found = one_value(view, short, view.indication, settings, FACTS.id)
    if found is None or len(found.rows) > own.most * view.good.sum():
        return None
    readings, count = view.indication[found.rows], len(found.rows)
    place = float(np.median(readings))
    spread = MAD_TO_SD * float(np.median(np.abs(readings - place)))
    beyond = np.flatnonzero(view.good & ((view.expected > place) | np.isin(np.arange(len(view)), found.rows)))
    anywhere = float(np.log(settings.constant.range))
    thing = found.as_echoes - log_choices(count, len(beyond)) - anywhere
    constant = thing - found.as_echoes + found.as_constant
    constant += float(np.log(settings.constant.among * settings.prior(TIMEOUT)))
    off = np.isin(beyond, found.rows)
    reference = np.zeros(len(beyond)) if view.reference is None else view.reference[beyond]
    visits = np.cumsum((np.diff(reference, prepend=np.nan) != 0) | np.diff(off, prepend=off[0]))
    whole = not np.isin(reference[off], reference[~off]).any()  # no place is right in other rows
    groups = (reference, visits) if whole else (visits,)
    each = [_own_lengths(view, beyond, off, group, settings) for group in groups]
    wrong = float(np.logaddexp.reduce(each)) + np.log(settings.outliers.odd)
    early = place - _OWN * max(spread, view.scatter)
    rows = short & (early <= view.indication) & (view.indication <= place + _LATE)
    rows[found.rows] = True
    because = (
        f"{listed(rows)} read about {place:.3f} m, where {found.expected.min():.3f} to "
        f"{found.expected.max():.3f} m are expected: something stands there in the beam; left out"
    )
    alike, rivals = [thing], [found.as_wild, constant, found.as_frozen]
    (alike if whole else rivals).append(wrong)
    evidence = float(np.logaddexp.reduce(alike) - np.logaddexp.reduce(rivals))
    sizes = ((place, spread / count**0.5), int(rows.sum()))
    rules = (far_rule(view.after(view.without(rows, FACTS.id)), FACTS.id, -1, settings),)
    noted = ("reference_error",) if whole and wrong > thing - own.sure else ()
    return Found(rows, evidence, because, sizes, rules=rules, rivals=(*_SAME_THING, *noted))


def _own_lengths(
    view: View,
    rows: NDArray[np.int64],
    off: NDArray[np.bool_],
    group: NDArray[np.generic],
    own: FaultSettings,
) -> float:
    """Log density of readings, if each group of rows that is off has a length of its own."""
    wrong = np.unique(group[off])
    total = -log_choices(len(wrong), len(np.unique(group)))
    for one in wrong:
        values = view.indication[rows[off & (group == one)]]
        total += log_constant(values, finest(values, view.resolution), own.constant)
        total -= float(np.log(own.constant.range))
    return total


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Put a thing at the distance beyond which a third of the targets are."""
    place = float(np.quantile(table["distance_m"], 0.67))
    beyond = table["distance_m"] > place
    table["reading_m"][beyond] = place + random.normal(0.0, 1e-3, int(beyond.sum()))


FAULT = Fault(FACTS, detect, spoil, Thresholds())
