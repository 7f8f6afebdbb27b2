"""Echo time and reference distance exchanged."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_UNITS = (1e-3, 1e-2, 1e-1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6)
"""Unit of the distances [m] over that of the times [s]: 1e6 for m and us, 1e4 for cm and us, ..."""

_REACH = (0.02, 20.0)  # m, of any such sensor


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    near: float = threshold(
        0.1, "1", "of the log ratio: what laws, thermometers and mounts do to it; judgement"
    )
    most: float = threshold(0.8, "1", "part of the rows that must agree; judgement")
    each: float = threshold(
        3.0, "1", "log Bayes factor of a row that agrees to a tenth, where it could be anything; judgement"
    )
    fewest: float = threshold(5, "1", "rows; judgement")


FACTS = CauseFacts(
    id="swapped_time_distance",
    kind="gross",
    sentence="The columns of echo time and reference distance changed places.",
    signature="distances of thousands beside times of a few; exchanged, they agree by the speed of sound",
    source="range test; CATALOGUE, swapped_columns",
    parameters=(Quantity("rows", "1", "rows concerned: all"),),
    check="look at the header of the logger's file: 2 m are 11.6 ms",
    prior=0.005,
    formula="echo time' = distance, distance' = echo time, in the units of their columns",
    needs=("reference_distance",),
    repair="exchanges the columns back",
)


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Read each column as the other and ask whether they then agree."""
    observations = view.observations
    reference = view.reference
    if reference is None or observations.reading is not None or view.given is not None:
        return None
    low, high = view.ratios
    if low > 0.5 and high < 2.0 and view.good.mean() > 0.5:
        return None  # as they stand they agree
    with np.errstate(all="ignore"):
        half_speed = view.indication / observations.echo_time
        straight = np.log(view.indication / reference)
        if float(np.mean(np.abs(straight) < np.log(2))) > 0.5:
            return None  # as they stand they agree
    for unit in _UNITS:
        distance, time = observations.echo_time * unit, reference / unit
        with np.errstate(all="ignore"):
            off = np.abs(np.log(half_speed * time / distance))
        agree = (off < own.near) & (distance >= _REACH[0]) & (distance <= _REACH[1])
        known = np.isfinite(off)
        if known.sum() >= own.fewest and agree.sum() > own.most * known.sum():
            return _found(view, agree, distance, time, own.each * float(agree.sum()))
    return None


def _found(view: View, agree: NDArray[np.bool_], distance: Column, time: Column, evidence: float) -> Found:
    low, high = float(np.min(distance[agree])), float(np.max(distance[agree]))
    because = (
        f"read as each other, the columns of echo time and distance agree in {int(agree.sum())} rows: "
        f"{low:.3g} .. {high:.3g} m are {1e3 * time[agree].min():.3g} .. {1e3 * time[agree].max():.3g} ms; "
        "exchanged back"
    )
    every = np.ones(len(view), dtype=bool)
    repaired = with_values(view, every, FACTS.id, echo_time=time, reference_distance=distance)
    return Found(agree, evidence, because, (agree.sum(),), repaired)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Write echo times in us and distances in m under each other's header."""
    echo = 2e6 * table.pop("reading_m") / (331.4 + 0.6 * table["temperature_C"])
    table["echo_us"], table["distance_m"] = table["distance_m"], echo


FAULT = Fault(FACTS, detect, spoil, Thresholds())
